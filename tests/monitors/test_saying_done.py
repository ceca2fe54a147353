"""Where a trial says that it is done."""

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.monitors.saying_done import says_done

GOALS = st.floats(0, 1)


@given(GOALS)
def test_a_goal_has_to_be_more_probable_than_not(goal: float) -> None:
    assert says_done(goal, None) == (goal >= 0.5)


@given(GOALS, GOALS)
def test_a_stated_risk_is_kept_besides(goal: float, above: float) -> None:
    bound = RiskBound(risk=0.05, above=above, trials=100)
    assert says_done(goal, bound) == (goal >= 0.5 and bound.allows(goal))
