"""A planner in a page: breadth-first search over the states of a task."""

from collections import deque
from time import monotonic

from tpvqa.pddl import Action, State, Task
from tpvqa.planning import Plan, PlanningResult, TimedOut, Unsolvable


class BreadthFirst:
    """Finds a plan with the fewest actions. For small tasks: it visits every state on the way."""

    name = "breadth"

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A shortest plan, or that there is none, or that the time was too short."""
        began = monotonic()
        limit = 60.0 if timeout is None else timeout
        first = task.init if state is None else state
        came: dict[State, tuple[State, Action] | None] = {first: None}
        waiting = deque([first])
        while waiting:
            here = waiting.popleft()
            if task.goal_holds(here):
                actions = _actions(came, here)
                cost = sum(action.cost for action in actions)
                return Plan(actions, cost, self.name, monotonic() - began)
            if monotonic() - began > limit:
                return TimedOut(limit, self.name, monotonic() - began)
            for action in task.ground_actions():
                if task.applicable(here, action):
                    then = task.apply(here, action)
                    if then not in came:
                        came[then] = (here, action)
                        waiting.append(then)
        return Unsolvable("no state in reach meets the goal", self.name, monotonic() - began)

    def close(self) -> None:
        """There is no process behind it."""


def _actions(came: dict[State, tuple[State, Action] | None], state: State) -> tuple[Action, ...]:
    actions = []
    while (step := came[state]) is not None:
        state, action = step
        actions.append(action)
    return tuple(reversed(actions))
