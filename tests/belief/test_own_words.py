"""Readings and reports as evidence: at their word, as learnt, repeated, against the model."""

from math import exp, isclose
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from tests.pddl.feature_domains import DERIVED
from tpvqa.belief import Calibration
from tpvqa.belief.answers.bounds import BOUND
from tpvqa.belief.calibrating.own_words import (
    LabelledReading,
    LabelledReport,
    OwnWords,
    SensorWorth,
    SkillWorth,
    at_its_word,
    fit_sensors,
    fit_skills,
)
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.belief.weighing.readings import AGAIN
from tpvqa.pddl import Atom, load_task, task_from_text

WARD = Path(__file__).parents[1] / "fixtures" / "drawers"
TASK = load_task(WARD / "domain.pddl", WARD / "problem.pddl")
MODEL = FaultModel(TASK)
DIRTY, OPEN = Atom("contaminated", ("upper",)), Atom("open", ("upper",))
RATES = Rates(0.25, 0.0, 0.0, 0.0)


def after_opening(calibration: Calibration | None = None) -> tuple[Belief, Evidence]:
    """The drawer is open with .75."""
    belief = Belief(MODEL)
    belief.act(TASK.action("open_drawer", ["upper"]), RATES)
    return belief, Evidence(belief, calibration or Calibration.default(), None, unexplained=0.0)


def odds(belief: Belief, atom: Atom = OPEN) -> float:
    p = belief.probability(atom)
    return p / (1 - p)


@given(st.floats(0.01, 0.99))
def test_a_reading_counts_as_what_it_says(p: float) -> None:
    belief, evidence = after_opening()
    evidence.take_sensed(OPEN, p)
    assert isclose(odds(belief), 3 * p / (1 - p), rel_tol=1e-6)


@pytest.mark.parametrize(("p", "ratio"), [(1.0, BOUND), (0.0, -BOUND), (0.5, 0.0)])
def test_however_sure_it_is_it_may_be_wrong(p: float, ratio: float) -> None:
    belief, evidence = after_opening()
    evidence.take_sensed(OPEN, p)
    assert isclose(odds(belief), 3 * exp(ratio), rel_tol=1e-6)


@given(st.lists(st.floats(0.02, 0.98).filter(lambda p: p != 0.5), min_size=1, max_size=6))
def test_until_something_is_done_a_fact_has_one_reading(read: list[float]) -> None:
    """Else a sensor that stands still would be a thousand witnesses."""
    belief, evidence = after_opening()
    for p in (*read, 0.5):
        evidence.take_sensed(OPEN, p)
    assert isclose(odds(belief), 3 * read[-1] / (1 - read[-1]), rel_tol=1e-6)


@given(st.floats(0.55, 0.98))
def test_after_an_action_a_reading_may_only_be_the_last_one_again(p: float) -> None:
    belief, evidence = after_opening()
    evidence.take_sensed(OPEN, p)
    before = odds(belief)
    evidence.acted()  # nothing that this fact hangs on
    evidence.take_sensed(OPEN, p)
    less = (AGAIN + (1 - AGAIN) * p) / (AGAIN + (1 - AGAIN) * (1 - p))
    assert isclose(odds(belief), before * less, rel_tol=1e-6)
    evidence.take_sensed(OPEN, p)
    assert isclose(odds(belief), before * less, rel_tol=1e-6)
    evidence.take_sensed(OPEN, 1 - p)  # another one cannot be a repetition
    assert isclose(odds(belief), before * (1 - p) / p, rel_tol=1e-6)


def test_a_reading_of_what_an_action_has_changed_is_no_repetition() -> None:
    """It was shut, and was read to be; now it is read to be open: no shut one that stood still."""
    belief = Belief(MODEL)
    evidence = Evidence(belief, Calibration.default(), None, unexplained=0.0)
    evidence.take_sensed(OPEN, 0.1)
    belief.act(TASK.action("open_drawer", ["upper"]), RATES)
    evidence.acted("open_drawer", failed=False)
    evidence.take_sensed(OPEN, 0.9)
    assert isclose(odds(belief), 3 * 0.9 / ((1 - AGAIN) * 0.1), rel_tol=1e-6)
    evidence.take_sensed(OPEN, 0.1)  # shut still: the sensor may have stood still
    shut = (AGAIN + (1 - AGAIN) * 0.9) / 0.1
    assert isclose(odds(belief), 3 / shut, rel_tol=1e-6)


def test_what_no_action_explains_is_opened_by_a_reading_too() -> None:
    belief = Belief(MODEL)
    evidence = Evidence(belief, Calibration.default(), None)
    clean = 1 - belief.probability(DIRTY)
    assert clean == 0
    likely = []
    for _ in range(4):
        evidence.take_sensed(DIRTY, 0.0)
        evidence.acted()
        likely.append(belief.probability(DIRTY))
    assert likely == sorted(likely, reverse=True)
    assert likely[0] > 0.5 > 0.1 > likely[-1]


def test_derived_facts_weigh_what_they_follow_from() -> None:
    task = task_from_text(DERIVED.domain, DERIVED.problem)
    model = FaultModel(task)
    belief = Belief(model)
    action = next(a for a in task.ground_actions() if task.applicable(task.init, a))
    belief.act(action, RATES)
    changed = task.extend(task.init) ^ task.extend(task.apply(task.init, action))
    atom = min(a for a in changed if a.predicate in task.derived)
    evidence = Evidence(belief, Calibration.default(), None)

    def likely() -> float:
        return belief.where(lambda state: atom in task.extend(state))

    before = likely()
    assert 0.2 < before < 0.8
    evidence.take_sensed(atom, 0.9)
    assert isclose(likely() / (1 - likely()), before / (1 - before) * 9, rel_tol=1e-6)


def test_what_was_learnt_of_a_sensor_goes_before_its_word() -> None:
    worth = SensorWorth(
        predicate="open", rows=200, says_if_true=0.8, says_if_false=0.2, surely=at_its_word(0.95)
    )
    belief, evidence = after_opening(Calibration.default().model_copy(update={"sensors": (worth,)}))
    evidence.take_sensed(OPEN, 0.95)
    assert isclose(odds(belief), 12, rel_tol=1e-5)
    evidence.take_sensed(OPEN, 0.05)
    assert isclose(odds(belief), 3 / 4, rel_tol=1e-5)
    evidence.take_sensed(DIRTY, 0.0)
    assert isclose(worth.log_ratio(0.6) / worth.log_ratio(0.95), at_its_word(0.6) / worth.surely)


def test_no_sensor_is_so_unsure_of_itself_that_a_reading_is_no_number() -> None:
    with pytest.raises(ValidationError, match="surely"):
        SensorWorth(predicate="open", rows=9, says_if_true=0.5, says_if_false=0.5, surely=5e-324)


def readings(said: float, true: int, false: int, *, right: float) -> list[LabelledReading]:
    """So many readings of what is true and of what is not, a share of them right."""
    found = []
    for truth, count in ((True, true), (False, false)):
        hits = round(right * count)
        says = [truth] * hits + [not truth] * (count - hits)
        found += [LabelledReading("open", said if each else 1 - said, truth) for each in says]
    return found


@pytest.mark.parametrize("right", [0.99, 0.8, 0.6])
def test_much_that_is_seen_of_a_sensor_is_believed_and_little_is_not(right: float) -> None:
    (much,) = fit_sensors(readings(0.95, 2000, 2000, right=right))
    assert 1 / (1 + exp(-much.log_ratio(0.95))) == pytest.approx(right, abs=0.01)
    (little,) = fit_sensors(readings(0.95, 2, 2, right=right))
    assert 1 / (1 + exp(-little.log_ratio(0.95))) == pytest.approx(0.95, abs=0.09)


def test_a_sensor_that_is_mostly_wrong_counts_for_nothing() -> None:
    (worth,) = fit_sensors(readings(0.9, 500, 500, right=0.2))
    assert worth.log_ratio(0.9) == worth.log_ratio(0.1) == 0


def test_a_sensor_that_misses_much_and_never_invents_is_known_as_such() -> None:
    missing = [LabelledReading("open", p, truth=True) for p in (0.9, 0.1) * 400]
    right = [LabelledReading("open", 0.1, truth=False)] * 800
    (worth,) = fit_sensors([*missing, *right, LabelledReading("open", 0.5, truth=True)])
    assert worth.rows == 1600
    assert worth.log_ratio(0.9) > 4
    assert -0.75 < worth.log_ratio(0.1) < -0.6  # a half of what is not there


def reports(failures: int, noticed: int, worked: int, alarms: int) -> list[LabelledReport]:
    failed = [LabelledReport("open_drawer", n < noticed, failed=True) for n in range(failures)]
    return failed + [LabelledReport("open_drawer", n < alarms, failed=False) for n in range(worked)]


def test_what_a_report_is_worth_is_counted() -> None:
    whole, own = fit_skills(reports(100, 90, 300, 15))
    assert (whole.action, own.action) == (None, "open_drawer")
    assert own.notices == pytest.approx(0.9, abs=0.02)
    assert own.false_alarms == pytest.approx(0.05, abs=0.01)


def test_skills_that_never_report_a_failure_teach_nothing() -> None:
    assert fit_skills(reports(100, 0, 300, 0)) == ()


def test_a_report_never_speaks_for_the_opposite() -> None:
    _, own = fit_skills(reports(300, 0, 300, 200))
    assert own.notices == own.false_alarms


def test_a_failure_that_is_reported_counts_and_no_report_only_where_more_is_known() -> None:
    belief, evidence = after_opening()
    evidence.acted("open_drawer", failed=False)
    assert isclose(odds(belief), 3)
    evidence.acted("open_drawer", failed=None)
    assert isclose(odds(belief), 3)
    belief, evidence = after_opening()
    evidence.acted("open_drawer", failed=True)
    assert isclose(odds(belief), 3 / 9)
    skills = (SkillWorth(action="open_drawer", rows=9, notices=0.8, false_alarms=0.04),)
    known = Calibration.default().model_copy(update={"skills": skills})
    for failed, ratio in ((True, 0.04 / 0.8), (False, 0.96 / 0.2)):
        belief, evidence = after_opening(known)
        evidence.acted("open_drawer", failed=failed)
        assert isclose(odds(belief), 3 * ratio)
    belief, evidence = after_opening(known)
    evidence.acted("close_drawer", failed=False)
    assert isclose(odds(belief), 3)


def test_a_skill_that_found_nothing_to_do_may_call_that_a_failure() -> None:
    """The drawer may be open already: that it is refused then is no sign that it is shut."""
    belief, evidence = after_opening()
    evidence.take_sensed(OPEN, 0.9)
    belief.act(TASK.action("open_drawer", ["upper"]), RATES)
    evidence.acted("open_drawer", failed=True)
    idle, worked, failed = 27 / 28 * 0.5, 1 / 28 * 0.75 * 0.1, 1 / 28 * 0.25 * 0.9
    assert isclose(odds(belief), (idle + worked) / failed, rel_tol=1e-6)
    assert belief.probability(OPEN) > 0.96


def test_a_calibration_keeps_it_and_is_the_same_one_without(tmp_path: Path) -> None:
    before = Calibration.default("mine")
    assert before.hearing(OwnWords()).fingerprint == before.fingerprint
    own = OwnWords(readings(0.9, 9, 9, right=0.8), reports(9, 8, 9, 1))
    known = before.hearing(own)
    assert known.fingerprint != before.fingerprint
    known.save(tmp_path / "c.json")
    assert Calibration.load(tmp_path / "c.json") == known


def test_what_was_never_seen_in_many_actions_is_still_possible() -> None:
    whole, own = fit_skills(reports(1000, 1, 30_000, 0))
    assert 0 < own.false_alarms <= whole.false_alarms < own.notices
