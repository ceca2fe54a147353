"""Plans that keep to what a world will do at all."""

from collections.abc import Callable
from dataclasses import replace

from tpvqa.pddl import Action, State, Task
from tpvqa.planning.protocol import Plan, Planner, PlanningResult, Unsolvable
from tpvqa.planning.without import plan_without


class BoundedPlanner:
    """A planner for a world that says of some actions that it will refuse them.

    Where a plan holds such an action another one is sought without any; where there is none, there
    is no plan, and why is said before anything is done.

    Args:
        planner: Finds the plans.
        refuses: Why an action is refused, the same of each always; empty where it is not.
    """

    def __init__(self, planner: Planner, refuses: Callable[[Action], str]):
        self._planner, self._refuses = planner, refuses

    @property
    def name(self) -> str:
        """Whoever finds the plans."""
        return self._planner.name

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan of actions that are not refused.

        Args:
            task: The task.
            state: The atoms that hold; None for the task's initial state.
            timeout: Seconds for each of two searches; None for the planner's default.

        Raises:
            PlannerError: The planner could not be run.
        """
        first = self._planner.plan(task, state, timeout=timeout)
        if not isinstance(first, Plan):
            return first
        whys = list(filter(None, map(self._refuses, first.actions)))
        if not whys:
            return first
        none = Unsolvable(
            f"no plan avoids what is refused: {'; '.join(dict.fromkeys(whys))}",
            first.planner,
            first.seconds,
        )
        if task.lasting is not None:  # of actions that last none can be barred
            return none
        barred = {each for each in (*first.actions, *task.ground_actions()) if self._refuses(each)}
        begin = task.init if state is None else state
        found = plan_without(self._planner, task, begin, barred, timeout=timeout)
        if not isinstance(found, PlanningResult):
            return found
        took = first.seconds + found.seconds
        if isinstance(found, Plan) and not any(map(self._refuses, found.actions)):
            return replace(found, seconds=took)
        return replace(none if isinstance(found, Plan | Unsolvable) else found, seconds=took)

    def close(self) -> None:
        """End the processes behind the planner."""
        self._planner.close()
