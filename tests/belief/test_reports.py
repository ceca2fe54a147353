"""What skills' reports are worth: nothing, until the robot has reported a failure."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief import Calibration
from tpvqa.belief.calibrating.own_words import FAILED, SkillWorth
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.learning.reports import Reports
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.pddl import Atom, load_task

WARD = Path(__file__).parents[1] / "fixtures" / "drawers"
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
    several = [seen] * 5
    assert 1.5 < worth_of_silence("find", seen) <= worth_of_silence("place", seen)
    assert worth_of_silence("find", *several) < worth_of_silence("place", *several)
    assert worth_of_silence("place", seen) < worth_of_silence("place", *several)


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


def test_evidence_takes_silence_for_a_success_once_a_failure_was_reported() -> None:
    """At first it says nothing."""
    task = load_task(WARD / "domain.pddl", WARD / "problem.pddl")
    action, opened = task.action("open_drawer", ["upper"]), Atom("open", ("upper",))

    def likely_after(*reports: bool) -> float:
        belief = Belief(FaultModel(task))
        evidence = Evidence(belief, Calibration.default(), None, unexplained=0.0)
        for failed in reports:
            before = belief.probability(opened)
            belief.act(action, Rates(0.25, 0.0, 0.0))
            evidence.acted("open_drawer", failed=failed)
            evidence.reports.learn(belief.outcome_shares())
        return belief.probability(opened) / (1 - (1 - before) * 0.25)

    assert likely_after(False) == pytest.approx(1.0)
    assert likely_after(True, False) > 1.01
