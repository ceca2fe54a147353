"""`Task` + `State` → `Plan`. Unsolvable, timed out and crashed are results of their own."""

from tpvqa.planning.protocol import (
    Crashed,
    Plan,
    Planner,
    PlanningResult,
    TimedOut,
    Unfit,
    Unsolvable,
)

__all__ = ["Crashed", "Plan", "Planner", "PlanningResult", "TimedOut", "Unfit", "Unsolvable"]
