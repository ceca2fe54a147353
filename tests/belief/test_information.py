"""What an answer is worth, against plain enumeration."""

from itertools import product
from math import isclose

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.answers.information import (
    Floats,
    Reliability,
    answers_to_be_sure,
    answers_to_know,
    gains,
    joint_gains,
    known_gain,
)


def gain(if_true: Floats, if_false: Floats, reliability: Reliability, times: int) -> float:
    # Among other questions and numbers of answers, which must not matter.
    others = Reliability(0.7, 0.4)
    both = gains(
        np.stack([if_false, if_true]),
        np.stack([if_true, if_false]),
        np.ones((1, 2, len(if_true))),
        np.ones((1, 2, len(if_true))),
        [others, reliability],
        (2, times, 1),
    )
    return float(both[1, 1])


def joint_gain(weighted: Floats, truths: Floats, each: list[Reliability], times: int) -> float:
    open_all = np.ones((1, *weighted.shape))
    return float(joint_gains(weighted, open_all, truths, each, (3, times))[1])


costs = st.lists(st.floats(0, 50), min_size=2, max_size=4)
rates = st.floats(0.02, 0.98)


def pairs(draw_true: list[float], draw_false: list[float], share: float) -> tuple[Floats, Floats]:
    n = min(len(draw_true), len(draw_false))
    return share * np.array(draw_true[:n]), (1 - share) * np.array(draw_false[:n])


@given(costs, costs, st.floats(0.01, 0.99), rates, rates, st.integers(1, 6))
def test_it_lies_between_nothing_and_the_truth(
    a: list[float], b: list[float], share: float, yes: float, no: float, times: int
) -> None:
    if_true, if_false = pairs(a, b, share)
    worth = gain(if_true, if_false, Reliability(yes, no), times)
    truth = float((if_true + if_false).min() - if_true.min() - if_false.min())
    assert -1e-9 <= worth <= truth + 1e-6


@given(costs, costs, st.floats(0.01, 0.99), rates, rates)
def test_one_answer_is_worth_what_enumeration_says(
    a: list[float], b: list[float], share: float, yes: float, no: float
) -> None:
    yes, no = round(yes, 3), round(no, 3)
    if_true, if_false = pairs(a, b, share)
    after_yes = (yes * if_true + no * if_false).min()
    after_no = ((1 - yes) * if_true + (1 - no) * if_false).min()
    plain = float((if_true + if_false).min() - after_yes - after_no)
    worth = gain(if_true, if_false, Reliability(yes, no), 1)
    assert isclose(worth, max(0.0, plain), abs_tol=1e-9)


@given(costs, costs, st.floats(0.01, 0.99), st.floats(0.55, 0.95), st.integers(1, 5))
def test_more_answers_are_never_worth_less(
    a: list[float], b: list[float], share: float, right: float, times: int
) -> None:
    if_true, if_false = pairs(a, b, share)
    reliability = Reliability(right, 1 - right)
    fewer = gain(if_true, if_false, reliability, times)
    assert gain(if_true, if_false, reliability, times + 1) >= fewer - 1e-9


def test_answers_that_say_nothing_are_worth_nothing() -> None:
    if_true, if_false = np.array([0.0, 5.0]), np.array([5.0, 0.0])
    assert gain(if_true, if_false, Reliability(0.4, 0.4), 20) == pytest.approx(0, abs=1e-9)
    assert gain(if_true, if_false, Reliability(0.9, 0.1, abstains=1.0), 3) == 0
    assert gain(if_true, if_false, Reliability(0.1, 0.9), 1) == pytest.approx(4)


@given(st.lists(st.lists(st.floats(0, 20), min_size=3, max_size=3), min_size=4, max_size=4))
def test_two_questions_together_are_worth_what_enumeration_says(table: list[list[float]]) -> None:
    weights = np.array([0.4, 0.3, 0.2, 0.1])[:, None] * np.array(table)
    truths = np.array([[1.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0]])
    one, other = Reliability(0.9, 0.2), Reliability(0.7, 0.1)
    plain = float(weights.sum(axis=0).min())
    for first, second in product((True, False), repeat=2):
        total = np.zeros(3)
        for state in range(4):
            p = one.yes_if_true if truths[0, state] else one.yes_if_false
            q = other.yes_if_true if truths[1, state] else other.yes_if_false
            total += weights[state] * (p if first else 1 - p) * (q if second else 1 - q)
        plain -= float(total.min())
    assert isclose(joint_gain(weights, truths, [one, other], 1), max(0.0, plain), abs_tol=1e-9)


def test_two_answers_can_change_what_neither_changes_alone() -> None:
    """Done only where both facts hold: each alone leaves too much doubt."""
    weights = np.array([[0.0, 0.5], [8.0, 0.1], [8.0, 0.1], [8.0, 0.1]]) * 0.25
    truths = np.array([[1.0, 1.0, 0.0, 0.0], [1.0, 0.0, 1.0, 0.0]])
    sure = Reliability(1.0, 0.0)
    alone = [gain(t @ weights, (1 - t) @ weights, sure, 1) for t in truths]
    assert alone == [0.0, 0.0]
    assert joint_gain(weights, truths, [sure, sure], 1) > 0.1


def test_an_answer_is_worth_something_where_it_opens_what_is_closed_now() -> None:
    """Seven facts of a goal, each .98: to do the first again changes too little to be a choice."""
    probable, right = np.array([0.86, 0.02, 0.12]), 0.8
    weighted = probable[:, None] * np.array([[0.0, 1.0], [50.0, 1.0], [50.0, 51.0]])
    work = (probable * (np.array([0.0, 1.0, 0.0]) - 0.03))[None, :, None] * np.array([0.0, 1.0])
    truths = np.array([[1.0, 0.0, 1.0]])
    answer = [Reliability(right, 1 - right)]
    assert joint_gains(weighted, work, truths, answer, (1,)) > 0.1
    never = work - np.array([0.0, 1.0])
    assert joint_gains(weighted, never, truths, answer, (1,)) == 0
    if_true, if_false = truths @ weighted, (1 - truths) @ weighted
    opens = gains(if_true, if_false, truths @ work, (1 - truths) @ work, answer, (1,))
    assert opens[0, 0] == pytest.approx(joint_gains(weighted, work, truths, answer, (1,))[0])


@given(st.lists(st.lists(st.floats(0, 20), min_size=3, max_size=3), min_size=4, max_size=4))
def test_to_know_facts_is_worth_what_perfect_answers_are(table: list[list[float]]) -> None:
    weights = np.array([0.4, 0.3, 0.2, 0.1])[:, None] * np.array(table)
    truths = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    sure = Reliability(1.0, 0.0)
    known = known_gain(weights, np.ones((2, 4, 3)), truths)
    assert isclose(known, joint_gain(weights, truths, [sure, sure], 1), abs_tol=1e-9)


def test_answers_to_know() -> None:
    """From 9 to 1 to 999 to 1 is thrice as far as from 9 to 1 to some 44 to 1."""
    each = Reliability(0.8, 0.2)
    far = answers_to_know(0.1, 1e-3, each)
    assert far == pytest.approx(3 * answers_to_know(0.9, 0.0228, each), rel=0.03)
    assert answers_to_know(0.9, 1e-3, Reliability(0.8, 0.2, abstains=0.5)) == pytest.approx(2 * far)
    assert answers_to_know(0.99, 0.05, each) == 1


def test_answers_to_be_sure() -> None:
    assert answers_to_be_sure(0.95) == pytest.approx(1.06, abs=0.01)
    assert answers_to_be_sure(0.6) == pytest.approx(34.7, abs=0.1)
    assert answers_to_be_sure(0.8, repeat=0.5) == 2 * answers_to_be_sure(0.8)
    assert answers_to_be_sure(0.3) == answers_to_be_sure(0.51)
