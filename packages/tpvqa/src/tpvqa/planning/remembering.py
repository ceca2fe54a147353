"""A planner that plans from no state twice."""

from collections.abc import Callable, Hashable, Sequence

from tpvqa.pddl import State, Task
from tpvqa.pddl.lasting import Running
from tpvqa.planning.protocol import Plan, Planner, PlanningResult, TemporalPlanner, Unsolvable


class Remembering:
    """Remembers plans, for experiments in which states come again and again.

    Time-outs and crashes are not remembered. What knows time is wrapped by `RememberingTime`; see
    `remembering`.

    Args:
        planner: Plans where nothing is remembered; closed with this one.
    """

    def __init__(self, planner: Planner):
        self._planner = planner
        self._results: dict[Hashable, PlanningResult] = {}

    @property
    def name(self) -> str:
        """The name of the planner behind it."""
        return self._planner.name

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state, as the planner behind it made it the first time."""
        state = task.init if state is None else state
        return self._known(
            (task.key, state), lambda: self._planner.plan(task, state, timeout=timeout)
        )

    def _known(self, key: Hashable, plan: Callable[[], PlanningResult]) -> PlanningResult:
        known = self._results.get(key)
        if known is not None:
            return known
        result = plan()
        if isinstance(result, Plan | Unsolvable):
            self._results[key] = result
        return result

    def close(self) -> None:
        """End the planner behind it."""
        self._planner.close()


class RememberingTime(Remembering):
    """The same for a planner that knows how long actions last."""

    _planner: TemporalPlanner

    def plan_meanwhile(
        self,
        task: Task,
        state: State,
        running: Sequence[Running],
        *,
        timeout: float | None = None,
    ) -> PlanningResult:
        """A plan from a state in which actions are running; see `TemporalPlanner`."""
        return self._known(
            (task.key, state, tuple(running)),
            lambda: self._planner.plan_meanwhile(task, state, running, timeout=timeout),
        )


def remembering(planner: Planner) -> Remembering:
    """A planner that plans from no state twice, and knows time where the one behind it does."""
    knows_time = isinstance(planner, TemporalPlanner)
    return (RememberingTime if knows_time else Remembering)(planner)
