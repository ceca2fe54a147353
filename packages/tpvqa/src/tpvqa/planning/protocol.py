"""What a planner returns, and the seam behind which every planner stands."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from tpvqa.pddl import Action, State, Task


@dataclass(frozen=True, slots=True)
class Plan:
    """A sequence of ground actions that leads from a state to the goal.

    Attributes:
        actions: The actions, in order; empty where the goal already holds.
        cost: Their total cost, where the problem minimises it; else their number.
        planner: Which planner and search found it.
        seconds: Wall time of the call.
    """

    actions: tuple[Action, ...]
    cost: int
    planner: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Unsolvable:
    """No plan exists from this state (proved by the search, not given up)."""

    reason: str
    planner: str
    seconds: float


@dataclass(frozen=True, slots=True)
class TimedOut:
    """The time limit passed before the search ended."""

    limit: float
    planner: str
    seconds: float


@dataclass(frozen=True, slots=True)
class Crashed:
    """The planner ended abnormally, also after being restarted once."""

    reason: str
    planner: str
    seconds: float


PlanningResult = Plan | Unsolvable | TimedOut | Crashed


@runtime_checkable
class Planner(Protocol):
    """Finds plans. Safe to call from several threads."""

    @property
    def name(self) -> str:
        """What the log calls it: the specification it can be made from again."""

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state (the task's initial state by default) to the task's goal.

        Args:
            task: The task.
            state: The atoms that hold; all others do not.
            timeout: Seconds; None for the planner's default.
        """

    def close(self) -> None:
        """End the processes behind it. Can be called twice."""
