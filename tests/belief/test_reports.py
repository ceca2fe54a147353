"""What skills' reports are worth: nothing, until the robot has reported a failure."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.own_words import FAILED, SkillWorth
from tpvqa.belief.reports import Reports

SKILLS = st.sampled_from(["pick_up", "place", "find"])


@given(st.lists(st.tuples(SKILLS, st.floats(0, 1)), max_size=12))
def test_that_no_failure_is_reported_says_nothing_while_none_ever_was(
    tried: list[tuple[str, float]],
) -> None:
    reports = Reports()
    for action, failure in tried:
        assert reports.take(action, failed=False) is None
        reports.learn({"failure": failure, "success": 1 - failure})
    assert reports.take("pick_up", failed=True) == FAILED


def worth_of_silence(action: str, *outcomes: tuple[str, bool, float]) -> float:
    """How much likelier it is of a success than of a failure that none is reported."""
    reports = Reports()
    for tried, reported, failure in outcomes:
        reports.take(tried, failed=reported)
        reports.learn({"failure": failure, "success": 1 - failure})
    likely = reports.take(action, failed=False)
    assert likely is not None
    return likely[0] / likely[1]


def test_once_one_was_reported_it_says_something_and_most_of_that_very_skill() -> None:
    seen = ("place", True, 0.9)
    assert 1.5 < worth_of_silence("find", seen) < worth_of_silence("place", seen)
    assert worth_of_silence("place", seen) < worth_of_silence("place", *[seen] * 5)


def test_failures_that_it_did_not_report_take_that_back() -> None:
    seen, silent = ("place", True, 0.9), ("place", False, 0.9)
    assert worth_of_silence("place", seen, *[silent] * 5) < worth_of_silence("place", seen)
    assert worth_of_silence("place", seen, *[silent] * 50) == pytest.approx(1.0, abs=0.1)


@given(st.lists(st.tuples(SKILLS, st.booleans(), st.floats(0, 1)), max_size=20), SKILLS)
def test_silence_never_speaks_for_a_failure(
    tried: list[tuple[str, bool, float]], action: str
) -> None:
    assert worth_of_silence(action, ("find", True, 1.0), *tried) >= 1


def test_what_is_known_beforehand_stays() -> None:
    known = SkillWorth(notices=0.8, false_alarms=0.1)
    reports = Reports((known,))
    for _ in range(9):
        reports.take("place", failed=False)
        reports.learn({"failure": 1.0, "success": 0.0})
    assert reports.take("place", failed=False) == pytest.approx((0.9, 0.2))
