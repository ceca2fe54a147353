"""Where the goal is probable enough to say that it is reached."""

from tpvqa.belief.calibrating.risk import RiskBound

EVEN = 0.5
"""A goal that is more probable than this is reached more probably than not, as is believed."""
REACHED = 0.3
"""The same, as it came out: what is believed allows for faults that few worlds have, and goals that
answers had something to say of are reached more often than they are believed to be: of 112 trials
of recorded VLMs on four shipped tasks that believed less than `EVEN`, 79 (docs/belief-measured.md).
"""


def says_done(goal: float, risk: RiskBound | None, *, told: bool) -> bool:
    """Whether "done" is said where a trial ends.

    Args:
        goal: How probable the goal is, as is believed.
        risk: Where it may be said at most; None where no risk is stated.
        told: Whether answers told anything, and no skill seems dead; otherwise goals are reached no
            more often than they are believed to be.
    """
    if risk is not None:
        return goal >= EVEN and risk.allows(goal)
    return goal >= (REACHED if told else EVEN)
