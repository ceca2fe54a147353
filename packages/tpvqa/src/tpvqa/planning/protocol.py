"""What a planner returns, and the seam behind which every planner stands."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from tpvqa.pddl import Action, State, Task
from tpvqa.pddl.lasting import Running


@dataclass(frozen=True, slots=True)
class Plan:
    """A sequence of ground actions that leads from a state to the goal.

    Attributes:
        actions: The actions, in order; empty where the goal already holds.
        cost: Their total cost, where the problem minimises it; else their number.
        planner: Which planner and search found it.
        seconds: Wall time of the call.
        times: When each action comes, from the plan's beginning, in the domain's units of time;
            empty where actions take no time.
    """

    actions: tuple[Action, ...]
    cost: int
    planner: str
    seconds: float
    times: tuple[float, ...] = ()


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


@dataclass(frozen=True, slots=True)
class Unfit(Crashed):
    """Nothing broke: the planner does not know tasks of this kind."""


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


class Numberless:
    """What a planner inherits that plans no task in which actions change numbers: a trial of one
    is refused before it begins."""


@runtime_checkable
class TemporalPlanner(Planner, Protocol):
    """A planner that also knows how long actions last, and that they may overlap."""

    def plan_meanwhile(
        self,
        task: Task,
        state: State,
        running: Sequence[Running],
        *,
        timeout: float | None = None,
    ) -> PlanningResult:
        """A plan from a state in which actions are running, whose ends are in the plan.

        Args:
            task: The task.
            state: The atoms that hold.
            running: What is running, and how much longer.
            timeout: Seconds; None for the planner's default.
        """
