"""A risk that is stated: held by every set of trials, whatever they are."""

from pathlib import Path
from statistics import fmean

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.belief.calibrating.risk import RiskBound, RiskCalibration, least_trials
from tpvqa.errors import CalibrationError
from tpvqa.monitors.stated_risk import apart, as_stated, split_risk

Trial = tuple[float | None, bool]
"""What was believed of the goal at "done", None for none; and whether the goal held."""
goals = st.one_of(st.floats(0, 1), st.sampled_from([0.9, 0.95, 0.99, 1.0]))
trials = st.tuples(st.one_of(st.none(), goals), st.booleans())
RISKS = st.sampled_from([0.02, 0.05, 0.07, 0.1, 0.25, 0.5])


def learnt(known: list[Trial]) -> RiskCalibration:
    done = [(goal, true) for goal, true in known if goal is not None]
    return RiskCalibration(
        trials=len(known),
        wrong=tuple(goal for goal, true in done if not true),
        right=tuple(goal for goal, true in done if true),
    )


def loses(trial: Trial, bound: RiskBound) -> bool:
    goal, true = trial
    return goal is not None and not true and bound.allows(goal)


@given(known=st.lists(trials, min_size=50, max_size=60), risk=RISKS)
@settings(max_examples=50, deadline=None)
def test_whichever_trial_is_the_new_one_the_mean_risk_is_held(
    known: list[Trial], risk: float
) -> None:
    """Trials are exchangeable: each may as well be the one after all others. No luck is in it."""
    found = [
        loses(trial, learnt(known[:place] + known[place + 1 :]).bound(risk))
        for place, trial in enumerate(known)
    ]
    assert fmean(found) <= risk


@given(st.lists(goals, min_size=49, max_size=60, unique_by=lambda each: round(each, 12)))
@settings(max_examples=15, deadline=None)
def test_no_more_is_given_up_than_must_be(wrong: list[float]) -> None:
    """Where all that is said is wrong, one more would be too many."""
    known: list[Trial] = [(goal, False) for goal in wrong]
    found = [
        loses(trial, learnt(known[:place] + known[place + 1 :]).bound(0.05))
        for place, trial in enumerate(known)
    ]
    assert fmean(found) > 0.05 - 1 / len(known)


@given(st.lists(trials, min_size=99, max_size=110))
@settings(max_examples=20, deadline=None)
def test_a_larger_risk_asks_for_less(known: list[Trial]) -> None:
    above = [learnt(known).bound(risk).above for risk in (0.01, 0.02, 0.05, 0.5)]
    assert above == sorted(above, reverse=True)


def test_the_threshold_by_hand() -> None:
    wrong = (0.6, 0.99, 0.97, 0.8, 0.9)
    known = RiskCalibration(trials=99, wrong=wrong, right=(0.95,) * 50)
    assert known.bound(0.01).above == 0.99  # none may be wrong
    assert known.bound(0.02).above == 0.97  # ⌊.02 · 100 - 1⌋ = 1 may
    assert known.bound(0.05).above == 0.6  # 4 may
    assert known.bound(0.07).above == 0.0  # 6 may, and 5 are
    assert known.completed(known.bound(0.05)) == 50 / 99
    assert known.mistaken(known.bound(0.05)) == 4 / 99
    assert known.completed(known.bound(0.02)) == 0


@pytest.mark.parametrize(("risk", "least"), [(0.02, 49), (0.05, 19), (0.07, 14), (0.5, 1)])
def test_too_few_trials_are_told(risk: float, least: int) -> None:
    assert least_trials(risk) == least
    assert RiskCalibration(trials=least).bound(risk).above == 0
    assert RiskCalibration(trials=least, wrong=(0.7,)).bound(risk).above == 0.7
    if least > 1:
        with pytest.raises(CalibrationError, match=f"at least {least} trials.*tpvqa risk"):
            RiskCalibration(trials=least - 1).bound(risk)


def test_what_rounding_adds_makes_nothing_surer() -> None:
    bound = RiskCalibration(trials=19, wrong=(1.0,)).bound(0.05)
    assert not bound.allows(1.0000000000000002)
    assert not RiskBound(risk=0.05, above=0.9, trials=19).allows(0.9 + 1e-16)


def test_a_file_is_read_as_it_was_written(tmp_path: Path) -> None:
    known = RiskCalibration(made_with={"VLM": "oracle"}, trials=30, wrong=(0.9,), right=(0.99,))
    known.save(tmp_path / "risk.json")
    assert RiskCalibration.load(tmp_path / "risk.json") == known


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{}", "trials"),
        ('{"trials": 3, "wrong": [2]}', "wrong.0"),
        ('{"trials": 2, "wrong": [0.6], "right": [0.7, 0.9]}', "3 of 2 trials"),
        ("[", "damaged"),
    ],
)
def test_a_damaged_file_is_told(tmp_path: Path, text: str, said: str) -> None:
    path = tmp_path / "risk.json"
    path.write_text(text)
    with pytest.raises(CalibrationError, match=rf"risk\.json.*{said}.*tpvqa risk"):
        RiskCalibration.load(path)


def test_the_risk_of_a_specification() -> None:
    assert split_risk("belief:risk=.02") == ("belief", 0.02)
    assert split_risk("belief:a=1:risk=.05:b=2") == ("belief:a=1:b=2", 0.05)
    assert split_risk("belief:a=1") == ("belief:a=1", None)
    assert split_risk("tpvqa:risk=.02") == ("tpvqa:risk=.02", None)


@pytest.mark.parametrize(
    ("first", "second", "said"),
    [
        (0.93, 0.97, ("0.93", "0.97")),
        (0.9987, 0.9991, ("0.9987", "0.9991")),
        (0.999, 1.0, ("0.999", "1.000")),
        (0.97, 0.97, ("0.97", "0.97")),
    ],
)
def test_probabilities_are_told_apart(first: float, second: float, said: tuple[str, str]) -> None:
    assert apart(first, second) == said


def test_a_risk_in_words() -> None:
    bound = RiskBound(risk=0.02, above=0.97, trials=199, wrong=9)
    assert as_stated(0.93, bound) == (
        "the goal holds with 0.93, and done is reported above 0.97 "
        "(risk at most 0.02, by 199 trials)"
    )
    assert "0.99, above 0.97" in as_stated(0.99, bound)
    never = bound.model_copy(update={"above": 1.0})
    assert "done is never reported" in as_stated(1.0, never)
    assert "no threshold is needed" in as_stated(0.6, bound.model_copy(update={"above": 0.0}))
