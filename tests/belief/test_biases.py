"""Predicates of which yes is said too readily, or too rarely."""

from dataclasses import replace
from math import exp, log
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tpvqa.belief.answers.biases import FIRST, KEPT, Biases, Row
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import AnswerRates, Calibration, Group
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Literal, load_task
from tpvqa.questions import FactQuestion, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds.world_file import load_world_file

TASK = load_task("clean_dishes")
FILES = find_task("clean_dishes")
BOOK = QuestionBook.load(FILES.questions, TASK)
SAID = 0.8, 0.2
CALIBRATION = Calibration(
    vlm="",
    rows=1000,
    whole=Group(rates=AnswerRates(*SAID, 0, 0), rows=1000),
    repeat_same_view=0.0,
    repeat_other_view=0.0,
)


def about(predicate: str) -> list[FactQuestion]:
    atoms = [atom for atom in sorted(TASK.atoms()) if atom.predicate == predicate]
    return [BOOK.fact(Literal(atom), way=Way.EFFECT) for atom in atoms]


def taught(true: float, false: float, scenes: int, said: tuple[float, float] = SAID) -> Biases:
    """After a trial of scenes in which it is known, one fact with another, what was right."""
    biases, draw = Biases(), Random(0)
    for _ in range(scenes):
        right = {question.text: draw.random() < 0.5 for question in about("on")[:2]}
        for question in about("on")[:2]:
            rate = true if right[question.text] else false
            biases.hear(question, said, yes=draw.random() < rate)
        biases.leave(lambda each, right=right: float(right[each.text]))  # type: ignore[misc]
    assert biases.rates(about("on")[0], said) == said  # not in the trial that taught it
    return Biases(biases.told)


def odds(rate: float) -> float:
    return log(rate / (1 - rate))


def test_yes_that_is_said_too_readily_of_one_predicate_is_worth_less_there_alone() -> None:
    on, near = about("on")[0], about("near")[0]
    biases = taught(0.94, 0.5, scenes=150)
    assert biases.rates(on, SAID) == pytest.approx((0.94, 0.5), abs=0.08)
    said = odds(0.8)
    assert 0 < biases.worth(on, SAID, said, yes=True) < said - 0.4  # a yes says less
    assert biases.worth(on, SAID, -said, yes=False) < -said - 0.4  # a no says more
    assert biases.rates(near, SAID) == SAID
    assert biases.worth(near, SAID, said, yes=True) == said


@pytest.mark.parametrize("prior", [0.3, 0.75, 0.9])
def test_who_stops_asking_once_it_is_sure_finds_no_bias_where_there_is_none(prior: float) -> None:
    """Who counted all answers of a scene by its share would hear what is believed too often."""
    biases, draw, said = Biases(), Random(1), odds(0.8)
    for _ in range(400):
        true, believed = draw.random() < prior, odds(prior)
        while abs(believed) < 3:
            yes = draw.random() < (0.8 if true else 0.2)
            believed += said if yes else -said
            biases.hear(about("on")[0], SAID, yes=yes)
        biases.leave(lambda _, now=believed: 1 / (1 + exp(-now)))  # type: ignore[misc]
    assert Biases(biases.told).rates(about("on")[0], SAID) == pytest.approx(SAID, abs=0.04)


@given(st.floats(0.55, 0.999), st.floats(0.001, 0.45), st.integers(0, 40), st.integers(0, 5))
def test_that_answers_agree_makes_them_worth_no_more(
    true: float, false: float, scenes: int, seed: int
) -> None:
    """Who judges answers by a belief that rests on them would find them right for ever."""
    said = true, false
    biases, draw = Biases(), Random(seed)
    for _ in range(scenes):
        right = draw.random() < 0.5
        for question in about("on"):
            biases.hear(question, said, yes=right)
        biases.leave(lambda _, right=right: float(right))  # type: ignore[misc]
    moved = Biases(biases.told).rates(about("on")[0], said)
    assert odds(moved[0]) - odds(moved[1]) == pytest.approx(odds(true) - odds(false), abs=1e-6)


def test_what_chance_brings_about_is_no_bias() -> None:
    draw = Random(3)
    found = []
    for _ in range(200):
        biases = Biases()
        for _ in range(12):
            right = draw.random() < 0.5
            biases.hear(about("on")[0], SAID, yes=draw.random() < SAID[not right])
            biases.leave(lambda _, right=right: float(right))  # type: ignore[misc]
        found.append(Biases(biases.told).rates(about("on")[0], SAID) != SAID)
    assert sum(found) / len(found) < 0.05


def test_ways_that_are_calibrated_apart_do_not_bias_each_other() -> None:
    biases = taught(0.95, 0.4, scenes=150, said=(0.95, 0.4))
    other = 0.7, 0.05
    assert biases.rates(about("on")[0], other) == pytest.approx(other, abs=0.05)


def test_one_fact_asked_often_in_one_scene_counts_little() -> None:
    question = about("on")[0]
    biases = Biases()
    for _ in range(500):
        biases.hear(question, SAID, yes=True)
    biases.leave(lambda _: 0.0)
    assert biases.told["on"] == ((*SAID, FIRST, 0.0, FIRST),)


def test_a_yes_never_speaks_for_no_by_it() -> None:
    biases = taught(0.99, 0.9, scenes=150)
    question = about("on")[0]
    assert biases.worth(question, SAID, 0.2, yes=True) == 0.0
    assert biases.worth(question, SAID, -0.2, yes=True) == -0.2  # it did before


def test_what_a_picture_may_show_anyway_says_nothing_of_the_vlm() -> None:
    question = replace(about("on")[0], still_shown=True)
    belief = Belief(FaultModel(TASK, load_world_file(FILES.world, TASK)))
    evidence = Evidence(belief, CALIBRATION, Trust.after(1000))
    for look in range(3):
        evidence.take(question, Answer(question, Reply.NO), look, None)
    evidence.leave()
    assert evidence.biases.told == {}
    assert taught(0.94, 0.5, scenes=50).rates(question, SAID) == SAID


def test_what_was_learned_is_bounded_and_goes_from_trial_to_trial() -> None:
    biases = taught(0.94, 0.5, scenes=400)
    ((*_, yeses, holding, other),) = biases.told["on"]
    assert holding + other == pytest.approx(KEPT)
    assert 0 < yeses < KEPT
    kept = Experience.of(Chances(), Trust(), 1, biases)
    again = Experience.model_validate_json(kept.model_dump_json())
    assert Biases(again.biases).told["on"][0] == pytest.approx(biases.told["on"][0])
    for trust in (kept.trust, None):
        known = kept.model_copy(update={"vlm": "a", "trust": trust})
        assert known.with_vlm("b", CALIBRATION).biases == {}
    question, yes = about("near")[1], []  # of the bread, which can be found
    for told in (Biases({"near": biases.told["on"]}), Biases()):
        belief = Belief(FaultModel(TASK, load_world_file(FILES.world, TASK)))
        belief.act(TASK.action("find", (question.atom.arguments[0], "tv")), Rates(0.25, 0.25, 0))
        before = belief.probability(question.atom)
        evidence = Evidence(belief, CALIBRATION, Trust.after(1000), told)
        evidence.take(question, Answer(question, Reply.YES), 0, None)
        yes.append(belief.probability(question.atom))
        assert evidence.carried().told["near"]  # the last scene's, too
    assert before < yes[0] < yes[1]


@pytest.mark.parametrize(
    "row", [(0.8, 0.2, 3.0, 1.0, 1.0), (1.0, 0.2, 1.0, 1.0, 1.0), (0.8, 0.2, -1.0, 1.0, 1.0)]
)
def test_a_strangers_counts_that_cannot_be_are_refused(row: Row) -> None:
    kept = Experience.of(Chances(), Trust(), 1).model_dump()
    with pytest.raises(ValidationError):
        Experience.model_validate({**kept, "biases": {"on": [row]}})


def test_taken_at_its_word_a_calibration_learns_nothing() -> None:
    model = FaultModel(TASK, load_world_file(FILES.world, TASK))
    evidence = Evidence(Belief(model), Calibration.default(), None)
    question = about("near")[0]
    evidence.take(question, Answer(question, Reply.YES), 0, None)
    evidence.leave()
    assert evidence.biases.told == {}
