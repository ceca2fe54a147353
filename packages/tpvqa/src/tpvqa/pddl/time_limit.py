"""Time limits as callers give them."""

from tpvqa.errors import PlannerError

LONGEST = 2_000_000.0  # seconds; the system's clocks take little more than 24 days in milliseconds


def limit_of(seconds: float | None) -> float | None:
    """The limit, or None for none: also for infinity, and whatever is longer than `LONGEST`.

    Raises:
        PlannerError: It is negative or not a number.
    """
    if seconds is None or seconds > LONGEST:
        return None
    if not seconds >= 0:
        raise PlannerError(f"{seconds:g} s is no time limit; give 0 or more, or infinity for none")
    return seconds
