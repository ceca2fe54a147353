"""Predicates of which yes is said too readily, or too rarely."""

from math import log
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.belief import Belief
from tpvqa.belief.biases import KEPT, Biases
from tpvqa.belief.calibration import AnswerRates, Calibration, Group
from tpvqa.belief.chances import Chances
from tpvqa.belief.evidence import Evidence
from tpvqa.belief.experience import Experience
from tpvqa.belief.faults import FaultModel, Rates
from tpvqa.belief.trust import Trust
from tpvqa.pddl import Literal, load_task
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds.world_file import load_world_file

TASK = load_task("clean_dishes")
FILES = find_task("clean_dishes")
BOOK = QuestionBook.load(FILES.questions, TASK)
SAID = 0.8, 0.2


def about(predicate: str) -> list[FactQuestion]:
    atoms = [atom for atom in TASK.atoms() if atom.predicate == predicate]
    return [BOOK.fact(Literal(atom), way=Way.EFFECT) for atom in atoms]


def taught(true: float, false: float, scenes: int, seed: int = 0) -> Biases:
    """After scenes in which it is known, one fact with another, what was right."""
    biases, draw = Biases(), Random(seed)
    for _ in range(scenes):
        right = {question.text: draw.random() < 0.5 for question in about("on")[:2]}
        for question in about("on")[:2]:
            rate = true if right[question.text] else false
            biases.hear(question, yes=draw.random() < rate)
        biases.leave(lambda each, right=right: float(right[each.text]))  # type: ignore[misc]
    return biases


def test_yes_that_is_said_too_readily_of_one_predicate_is_worth_less_there_alone() -> None:
    on, near = about("on")[0], about("near")[0]
    biases = taught(0.94, 0.5, scenes=150)
    true, false = biases.rates(on, SAID)
    assert (true, false) == pytest.approx((0.94, 0.5), abs=0.08)
    assert biases.shift(on, SAID, yes=True) < -0.4  # a yes says less
    assert biases.shift(on, SAID, yes=False) < -0.4  # a no says more
    assert biases.rates(near, SAID) == SAID
    assert biases.shift(near, SAID, yes=True) == 0.0


@given(st.floats(0.55, 0.95), st.integers(0, 40), st.integers(0, 5))
def test_that_answers_agree_makes_them_worth_no_more(right: float, scenes: int, seed: int) -> None:
    """Who judges answers by a belief that rests on them would find them right for ever."""
    said = right, 1 - right
    biases, draw = Biases(), Random(seed)
    for _ in range(scenes):
        true = draw.random() < 0.5
        for question in about("on"):
            biases.hear(question, yes=true)
        biases.leave(lambda _, true=true: float(true))  # type: ignore[misc]
    true_rate, false_rate = biases.rates(about("on")[0], said)

    def odds(rate: float) -> float:
        return log(rate / (1 - rate))

    apart = odds(right) - odds(1 - right)
    assert odds(true_rate) - odds(false_rate) <= apart + 0.3  # but for what is rounded


def test_one_question_asked_often_in_one_scene_counts_little() -> None:
    question = about("on")[0]
    biases = Biases()
    for _ in range(500):
        biases.hear(question, yes=True)
    biases.leave(lambda _: 0.0)
    assert biases.told["on"] == pytest.approx((0, 0, 2, 2))


def test_what_was_learned_is_bounded_and_goes_from_trial_to_trial() -> None:
    model = FaultModel(TASK, load_world_file(FILES.world, TASK))
    calibration = Calibration(
        vlm="",
        rows=1000,
        whole=Group(rates=AnswerRates(*SAID, 0, 0), rows=1000),
        repeat_same_view=0.0,
        repeat_other_view=0.0,
    )
    biases = taught(0.94, 0.5, scenes=400)
    yeses, answers, wrong, others = biases.told["on"]
    assert answers + others == pytest.approx(KEPT)
    assert 0 < yeses < answers
    assert 0 < wrong < others
    kept = Experience.of(Chances(), Trust(), 1, biases)
    again = Experience.model_validate_json(kept.model_dump_json())
    assert again.biases == dict(biases.told)
    assert kept.model_copy(update={"vlm": "a"}).with_vlm("b", calibration).biases == {}
    question, yes = about("near")[0], []
    other = {"near": biases.told["on"]}
    for told in (Biases(other), Biases()):
        belief = Belief(model)
        belief.act(TASK.action("find", (question.atom.arguments[0], "tv")), Rates(0.25, 0.25, 0))
        before = belief.probability(question.atom)
        evidence = Evidence(belief, calibration, Trust.after(1000), told)
        evidence.take(question, Answer(question, Reply.YES), 0, None)
        yes.append(belief.probability(question.atom))
    assert before < yes[0] < yes[1]


def test_taken_at_its_word_a_calibration_learns_nothing() -> None:
    model = FaultModel(TASK, load_world_file(FILES.world, TASK))
    evidence = Evidence(Belief(model), Calibration.default(), None)
    question = about("near")[0]
    evidence.take(question, Answer(question, Reply.YES), 0, None)
    evidence.leave()
    assert evidence.biases.told == {}
