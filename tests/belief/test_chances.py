"""What is learned of how often actions fail."""

from math import isclose

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.beta import Beta
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience

cases = st.floats(0.5, 200)


@given(cases, cases)
def test_a_certain_case_counts_as_one(yes: float, no: float) -> None:
    beta = Beta(yes, no)
    beta.learn(1.0, 0.0)
    assert isclose(beta.yes, yes + 1, rel_tol=1e-6)
    assert isclose(beta.no, no, rel_tol=1e-6)


@given(cases, cases)
def test_a_case_of_which_nothing_was_seen_teaches_nothing(yes: float, no: float) -> None:
    beta = Beta(yes, no)
    for _ in range(20):
        beta.learn(beta.mean, 1 - beta.mean)
    assert isclose(beta.yes, yes, rel_tol=1e-4)
    assert isclose(beta.no, no, rel_tol=1e-4)


@given(cases, cases, st.floats(0, 1), st.floats(0, 1))
def test_the_mean_is_that_of_the_mixture(yes: float, no: float, p: float, share: float) -> None:
    beta = Beta(yes, no)
    for_it, against = share * p, share * (1 - p)
    n = yes + no
    mean = (1 - share) * yes / n + (for_it * (yes + 1) + against * yes) / (n + 1)
    beta.learn(for_it, against)
    assert isclose(beta.mean, mean, rel_tol=1e-4)


def test_the_rate_is_found_from_probable_cases() -> None:
    """Every outcome is seen nearly: the rate settles at the true one."""
    chances = Chances(Rates(0.25, 0.25, 0.0))
    for number in range(300):
        failed = number % 10 < 4
        sure = {"failure": 0.95, "success": 0.05} if failed else {"failure": 0.03, "success": 0.97}
        chances.learn(sure)
    assert 0.36 < chances.rates.failure < 0.44
    assert chances.rates.disturbance == 0.25


@pytest.mark.parametrize(
    ("rate", "how", "undone", "not_undone"),
    [
        ("spontaneous", "success", "fell", "stayed"),
        ("redone", "achieved", "slipped", "kept"),
    ],
)
def test_what_comes_undone_without_a_failure_is_learned_too(
    rate: str, how: str, undone: str, not_undone: str
) -> None:
    chances, before = Chances(), Chances().rates
    for number in range(60):
        lost = number % 5 == 0
        chances.learn({how: 1.0, undone: 0.9 if lost else 0.0, not_undone: 0.1 if lost else 1.0})
    found = getattr(chances.rates, rate)
    assert 0.1 < found < 0.2
    assert chances.rates.disturbance == before.disturbance
    assert getattr(Experience.of(chances, None, 1).chances().rates, rate) == found


@pytest.mark.parametrize("rate", [0.0, 1.0])
def test_a_rate_that_was_believed_for_certain_can_be_kept(rate: float) -> None:
    known = Experience.of(Chances(Rates(rate, rate, 0.0)), Trust(), 1)
    assert isclose(known.chances().rates.failure, rate, abs_tol=1e-3)


def test_how_far_a_vlm_is_trusted_is_not_taken_over_for_another() -> None:
    trust = Trust()
    trust.weights = tuple(range(len(trust.weights), 0, -1))
    calibration = Calibration.default("a")
    known = Experience.of(Chances(Rates()), trust, 3).with_vlm("a", calibration)
    again = Experience.of(Chances(Rates()), trust, 3).model_copy(
        update={"vlm": "a", "calibration": calibration.fingerprint}
    )
    assert known.trust is None  # learned of nobody in particular
    assert again.with_vlm("a", calibration).trust == trust.weights
    assert again.with_vlm("b", calibration).trust is None
    other = calibration.model_copy(update={"repeat_same_view": 0.1})
    assert again.with_vlm("a", other).trust is None
