"""Where a trial says that it is done."""

from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.monitors.saying_done import EVEN, REACHED, says_done

GOALS = st.floats(0, 1)


@given(GOALS, GOALS, st.booleans())
def test_a_stated_risk_is_kept_by_what_is_believed_alone(
    goal: float, above: float, told: bool
) -> None:
    bound = RiskBound(risk=0.05, above=above, trials=100)
    assert says_done(goal, bound, told=told) == (goal >= EVEN and bound.allows(goal))


@given(GOALS)
def test_what_answers_told_nothing_of_has_to_be_more_probable_than_not(goal: float) -> None:
    assert says_done(goal, None, told=False) == (goal >= EVEN)
    assert says_done(goal, None, told=True) == (goal >= REACHED)
