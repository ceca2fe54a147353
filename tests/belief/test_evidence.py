"""Answers as evidence: repeats, abstentions, surprises, trust."""

from dataclasses import replace
from math import isclose

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief import AnswerRates, Calibration, Group
from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.information import LATE, answers_to_be_sure
from tpvqa.belief.answers.kinds import FRESH, KINDS
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.answers.worth import Said, Worth, by_truth
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.weighing.evidence import ANYWAY, Evidence
from tpvqa.pddl import Literal, load_task
from tpvqa.questions import QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import Answer, Reply
from tpvqa.worlds.world_file import load_world_file

TASK = load_task("clean_dishes")
FILES = find_task("clean_dishes")
BOOK = QuestionBook.load(FILES.questions, TASK)
MODEL = FaultModel(TASK, load_world_file(FILES.world, TASK))
FIND = TASK.action("find", ["plate", "tv"])
NEAR = next(atom for atom in TASK.atoms() if str(atom) == "near(plate)")
QUESTION = BOOK.fact(Literal(NEAR), way=Way.EFFECT)


def told(reply: Reply) -> Answer:
    return Answer(QUESTION, reply)


LASTING = tuple(float(kind[:2] == (0.97, 0.0)) for kind in KINDS)


def found(
    repeat: float, *, unexplained: float = 0.0, lasting: tuple[float, ...] = FRESH
) -> tuple[Belief, Evidence]:
    """After `find plate`, with a VLM that is right in .8 of its answers."""
    belief = Belief(MODEL)
    belief.act(FIND, Rates(0.25, 0.25, 0.0))
    calibration = Calibration(
        vlm="",
        rows=10**9,
        whole=Group(rates=AnswerRates(0.8, 0.2, 0, 0), rows=10**9),
        repeat_same_view=repeat,
        repeat_other_view=repeat / 2,
        lasting=lasting,
    )
    return belief, Evidence(belief, calibration, None, unexplained=unexplained)


def odds(belief: Belief) -> float:
    p = belief.probability(NEAR)
    return p / (1 - p)


def test_independent_answers_multiply_their_ratios() -> None:
    belief, evidence = found(0.0)
    assert isclose(odds(belief), 3)
    evidence.take(QUESTION, told(Reply.YES), 0, None)
    assert isclose(odds(belief), 12)
    evidence.take(QUESTION, told(Reply.YES), 1, None)
    assert isclose(odds(belief), 48, rel_tol=1e-6)
    evidence.take(QUESTION, told(Reply.NO), 2, None)
    assert isclose(odds(belief), 12, rel_tol=1e-6)


def test_the_same_picture_says_nothing_new() -> None:
    belief, evidence = found(0.0)
    evidence.take(QUESTION, told(Reply.YES), "a.jpg", None)
    before = belief.probability(NEAR)
    evidence.take(QUESTION, told(Reply.NO), "b.jpg", None)
    evidence.take(QUESTION, told(Reply.YES), "a.jpg", None)
    assert evidence.asked_of(QUESTION.text, "a.jpg")
    assert isclose(odds(belief), 3)
    assert before > belief.probability(NEAR)


@given(st.floats(0, 1))
def test_a_repeated_answer_is_worth_less_and_a_different_one_all(rho: float) -> None:
    belief, evidence = found(rho)
    evidence.take(QUESTION, told(Reply.YES), 0, None)
    evidence.take(QUESTION, told(Reply.YES), 1, None)
    expected = 12 * (rho + (1 - rho) * 0.8) / (rho + (1 - rho) * 0.2)
    assert isclose(odds(belief), expected, rel_tol=1e-6)
    if rho < 0.99:
        evidence.take(QUESTION, told(Reply.NO), 2, None)
        assert isclose(odds(belief), expected / 4, rel_tol=1e-6)


def test_where_errors_last_the_same_answer_again_and_again_does_not_convince_without_end() -> None:
    """Yes after yes: perhaps the fact, perhaps a misreading that stays."""
    gained = []
    belief, evidence = found(0.0, lasting=LASTING)
    for look in range(20):
        before = odds(belief)
        evidence.take(QUESTION, told(Reply.YES), look, None)
        gained.append(odds(belief) / before)
    assert gained[0] == pytest.approx(4)
    assert max(gained[1:]) < 1.05
    assert odds(belief) < 3 * 8


def test_where_nothing_has_changed_the_same_answer_says_no_more_but_elsewhere_it_does() -> None:
    belief, evidence = found(0.0, lasting=LASTING)
    for look in range(10):
        evidence.take(QUESTION, told(Reply.YES), look, None)
    belief.act(FIND, Rates(0.25, 0.0, 0.0))
    evidence.acted()
    before = odds(belief)
    evidence.take(QUESTION, told(Reply.YES), 10, None)
    assert odds(belief) / before < 1.1
    before = odds(belief)
    evidence.take(QUESTION, told(Reply.YES), 11, "side")
    assert odds(belief) / before > 1.2


def test_another_view_repeats_less() -> None:
    same, other = found(0.6), found(0.6)
    for belief_and_evidence, view in ((same, "front"), (other, "left")):
        belief_and_evidence[1].take(QUESTION, told(Reply.YES), 0, "front")
        belief_and_evidence[1].take(QUESTION, told(Reply.YES), 1, view)
    assert odds(other[0]) > odds(same[0]) > 12


def test_after_an_action_an_answer_is_worth_all_where_the_fact_has_changed() -> None:
    """A no before, certain: then it was false. A yes after another try is no repetition."""
    belief, evidence = found(0.9)
    for look in range(60):
        evidence.take(QUESTION, told(Reply.NO), look, None)
    assert belief.probability(NEAR) < 0.02
    belief.act(FIND, Rates(0.25, 0.25, 0.0))
    evidence.acted()
    before = odds(belief)
    evidence.take(QUESTION, told(Reply.YES), 61, None)
    assert odds(belief) / before > 3.9


@pytest.mark.parametrize("reply", [Reply.UNKNOWN, Reply.CANNOT_SEE])
def test_unknown_answers_change_nothing(reply: Reply) -> None:
    belief, evidence = found(0.0, unexplained=0.1)
    before = dict(belief.weights)
    assert evidence.take(QUESTION, told(reply), 0, None) == 1.0
    assert belief.weights == before
    assert evidence.silent(QUESTION.text, None)
    assert evidence.unanswered == {QUESTION.text}
    evidence.acted()
    assert not evidence.unanswered


def test_a_surprising_answer_opens_what_the_model_does_not_explain() -> None:
    belief = Belief(MODEL)
    calibration = Calibration(
        vlm="",
        whole=Group(rates=AnswerRates(0.9, 0.1, 0, 0), rows=1000),
        repeat_same_view=0,
        repeat_other_view=0,
    )
    evidence = Evidence(belief, calibration, None)
    assert belief.probability(NEAR) == 0
    for look in range(5):
        evidence.take(QUESTION, told(Reply.YES), look, None)
    assert belief.probability(NEAR) > 0.9


def test_a_skill_that_reports_trouble_is_believed() -> None:
    belief, evidence = found(0.0)
    evidence.acted("find", failed=True)
    assert belief.probability(NEAR) == pytest.approx(0.75 * 0.1 / (0.75 * 0.1 + 0.25 * 0.9))


@given(st.floats(0.02, 0.98), st.floats(0.02, 0.98), st.integers(0, 40))
def test_what_is_expected_of_an_answer_is_a_probability(
    if_true: float, if_false: float, agreeing: int
) -> None:
    """However good the VLM turns out, and however lopsided its calibration is."""
    trust = Trust()
    worth = Worth(trust)
    drawn = Heard().drawn((), np.zeros(0, bool), len(worth.weights))
    for _ in range(agreeing):
        cases = by_truth(worth.weights, 0.99, drawn)
        likely = worth.take(Said(True, 3.0), cases, (0.9, 0.1)).likely
        mass = (cases.mass * likely).sum(axis=0)
        worth.believe(mass / mass.sum())
    calibration = Calibration(
        vlm="",
        whole=Group(rates=AnswerRates(if_true, if_false, 0, 0)),
        repeat_same_view=0.3,
        repeat_other_view=0.1,
    )
    evidence = Evidence(Belief(MODEL), calibration, trust)
    expected = evidence.expect(QUESTION, None)
    assert 0 <= expected.yes_if_true <= 1
    assert 0 <= expected.yes_if_false <= 1


def test_what_is_still_shown_is_believed_a_little_once_and_says_nothing_of_the_vlm() -> None:
    belief = Belief(MODEL)
    belief.act(FIND, Rates(0.25, 0.25, 0.0))
    calibration = Calibration.default()
    evidence = Evidence(belief, calibration, Trust.after(calibration.rows), unexplained=0.0)
    question = replace(QUESTION, still_shown=True)
    before, nothing = odds(belief), evidence.worth.nothing
    evidence.take(question, told(Reply.YES), 0, None)
    once = odds(belief)
    assert before < once < before / ANYWAY
    evidence.take(question, told(Reply.YES), 1, None)
    assert odds(belief) == once
    other = replace(question, text="Are you near the plate?", wording=1, first=question.text)
    assert evidence.affirmed(other)
    assert evidence.take(other, Answer(other, Reply.YES), 1, None) == 1.0
    assert odds(belief) == once
    assert isclose(evidence.worth.nothing, nothing)
    evidence.acted("find")
    assert not evidence.affirmed(question)
    evidence.take(question, told(Reply.NO), 2, None)
    assert odds(belief) < once


def test_a_vlm_is_not_asked_the_more_the_less_is_known_of_it() -> None:
    unknown = Evidence(Belief(MODEL), Calibration.default(), Trust.after(0))
    assert 1 < unknown.late <= LATE * answers_to_be_sure(unknown.right)
    assert unknown.answers_to_be_sure() > 1.5 * unknown.late
    for repeat in (0.0, 0.5, 0.8):
        _, known = found(repeat)
        assert known.late == known.answers_to_be_sure()
