"""Where the goal is probable enough to say that it is reached."""

from tpvqa.belief.calibrating.risk import RiskBound

EVEN = 0.5
"""A goal that is more probable than this is reached more probably than not, as is believed."""


def says_done(goal: float, risk: RiskBound | None) -> bool:
    """Whether "done" is said where a trial ends.

    Args:
        goal: How probable the goal is, as is believed.
        risk: Where it may be said at most; None where no risk is stated.
    """
    return goal >= EVEN and (risk is None or risk.allows(goal))
