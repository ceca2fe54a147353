"""A planner that plans from no state twice."""

from tpvqa.pddl import State, Task
from tpvqa.planning.protocol import Plan, Planner, PlanningResult, Unsolvable


class Remembering:
    """Remembers the plans of one task, for experiments in which states come again and again.

    Time-outs and crashes are not remembered.

    Args:
        planner: Plans where nothing is remembered; closed with this one.
    """

    def __init__(self, planner: Planner):
        self._planner = planner
        self._results: dict[tuple[int, State], PlanningResult] = {}
        self._tasks: dict[int, Task] = {}

    @property
    def name(self) -> str:
        """The name of the planner behind it."""
        return self._planner.name

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state, as the planner behind it made it the first time."""
        state = task.init if state is None else state
        self._tasks[id(task)] = task  # kept alive, so that its number stays its own
        key = (id(task), state)
        known = self._results.get(key)
        if known is not None:
            return known
        result = self._planner.plan(task, state, timeout=timeout)
        if isinstance(result, Plan | Unsolvable):
            self._results[key] = result
        return result

    def close(self) -> None:
        """End the planner behind it."""
        self._planner.close()
