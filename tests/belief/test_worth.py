"""How far answers can be trusted, and how their errors last, learned from the answers alone."""

from dataclasses import replace
from math import exp, isclose, log
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.information import TIMES, settled
from tpvqa.belief.answers.kinds import FRESH, KINDS, RECORDED
from tpvqa.belief.answers.trust import GRID, Trust
from tpvqa.belief.answers.worth import Cases, Said, Worth, by_truth

RIGHT = 0.8
NONE = np.zeros(0, bool)
RATES = RIGHT, 1 - RIGHT
RATIO = log(RIGHT / (1 - RIGHT))


def listen(worth: Worth, answers: list[bool], believed: float = 0.5) -> tuple[float, Cases]:
    """What is believed of a fact after some answers in one scene."""
    drawn = Heard().drawn((), NONE, len(worth.weights))
    cases = by_truth(worth.weights, believed, drawn)
    for yes in answers:
        taken = worth.take(Said(yes, RATIO if yes else -RATIO), cases, RATES)
        mass = cases.mass * taken.likely
        cases = replace(cases, mass=mass / mass.sum(), drawn=taken.drawn)
    worth.believe(cases.mass.sum(axis=0))
    return float(cases.mass[0].sum()), cases


@given(st.lists(st.booleans(), max_size=30), st.sampled_from([FRESH, RECORDED]))
def test_what_is_learned_stays_a_distribution(answers: list[bool], lasting: tuple[float]) -> None:
    trust = Trust()
    worth = Worth(trust, lasting)
    believed, cases = listen(worth, answers)
    assert isclose(sum(worth.lasting), 1)
    assert isclose(sum(trust.weights), 1, abs_tol=1e-6)
    assert 0 <= believed <= 1
    expected = worth.expect(RATES, cases)
    for mixture in (expected.if_true, expected.if_false):
        assert isclose(sum(weight for weight, _ in mixture), 1)
        assert all(0 <= yes <= 1 + 1e-9 for _, yes in mixture)
    assert 0 <= settled(expected) <= 1


def test_answers_that_are_drawn_anew_multiply() -> None:
    believed, _ = listen(Worth(None, FRESH), [True, True, False, True])
    assert believed == pytest.approx(16 / 17)


@given(st.integers(2, 40))
def test_lasting_errors_bound_what_one_scene_can_say(answers: int) -> None:
    only = [1.0 if kind.share == 0.97 and not kind.stays else 0.0 for kind in KINDS]
    believed, cases = listen(Worth(None, only), [True] * answers)
    assert RIGHT - 1e-9 <= believed < RIGHT + 0.13  # one answer's worth, and what 3% fresh ones add
    assert settled(Worth(None, only).expect(RATES, cases)) < 0.6


def test_coins_are_found_out_and_honest_answers_believed() -> None:
    chance = Random(3)
    coins, honest = Trust(), Trust()
    for trust, right in ((coins, 0.5), (honest, 0.8)):
        worth = Worth(trust, FRESH)
        for _ in range(12):
            listen(worth, [chance.random() < right for _ in range(20)])
    assert coins.mean < 0.4
    assert 0.7 < honest.mean < 1.4


def test_how_errors_last_is_learned_from_how_answers_go_together() -> None:
    chance = Random(5)
    fresh, constant = Worth(Trust(), RECORDED), Worth(Trust(), RECORDED)
    for _ in range(30):
        listen(fresh, [chance.random() < RIGHT for _ in range(6)])
        listen(constant, [chance.random() < RIGHT] * 6)
    assert fresh.share < 0.2
    assert constant.share > 0.85


def test_further_answers_are_expected_as_they_come() -> None:
    """The mixture says how many of several answers are yes; so do draws of the same noise."""
    share, chance = 0.6, Random(1)
    only = [1.0 if kind[:2] == (share, 0.0) else 0.0 for kind in KINDS]
    expected = Worth(None, only).expect(RATES).if_true
    times = TIMES[2]
    mean = sum(weight * yes for weight, yes in expected)
    variance = sum(
        weight * (times * yes * (1 - yes) + (times * (yes - mean)) ** 2) for weight, yes in expected
    )
    drawn = []
    for _ in range(4000):
        own = chance.random() < RIGHT
        drawn.append(
            sum(own if chance.random() < share else chance.random() < RIGHT for _ in range(times))
        )
    assert mean * times == pytest.approx(np.mean(drawn), abs=0.1)
    assert variance == pytest.approx(np.var(drawn), rel=0.1)


@settings(max_examples=20)
@given(right=st.floats(0.7, 0.95), said=st.floats(0.55, 0.95), trust=st.floats(0.3, 2.2))
def test_as_much_is_expected_of_answers_as_they_have_said(
    right: float, said: float, trust: float
) -> None:
    """A VLM whose P(yes) is less sure than its words were in the calibration: what it says and how
    far it is trusted count once each. More than it or its calibration says is not expected."""
    worth, ratio = Worth(Trust(), FRESH), log(said / (1 - said))
    nearest = int(np.argmin(abs(np.array(GRID) - trust)))
    only = np.zeros((len(GRID), len(KINDS)))
    only[nearest, 0] = 1.0
    worth.believe(only.ravel())
    for _ in range(3000):
        worth.compare(Said(True, ratio), (right, 1 - right))
    expected = worth.expect((right, 1 - right)).yes_if_true
    trusted = 1 / (1 + exp(-GRID[nearest] * ratio))
    assert isclose(expected, min(trusted, max(right, said)), abs_tol=0.02)


@given(st.lists(st.booleans(), min_size=5, max_size=30), st.floats(-1e-9, 1e-9))
def test_what_is_all_but_impossible_does_not_grow(answers: list[bool], beyond: float) -> None:
    """Sums of probabilities are above 1 by their last bits."""
    worth = Worth(Trust(), RECORDED)
    cases = by_truth(worth.weights, 0.5, Heard().drawn((), NONE, len(worth.weights)))
    whole = np.ones_like(cases.drawn.yes)
    drawn = cases.drawn._replace(yes=whole + beyond, new=0 * whole)
    for yes in answers:
        taken = worth.take(Said(yes, RATIO if yes else -RATIO), replace(cases, drawn=drawn), RATES)
        assert taken.likely.min() >= 0
        assert taken.likely.max() <= 1
        drawn = taken.drawn
