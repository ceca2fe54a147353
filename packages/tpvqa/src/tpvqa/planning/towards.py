"""Planning to other facts than the task's goal, for any planner."""

import re
from dataclasses import replace
from functools import lru_cache

from tpvqa.pddl import Atom, State, Task, task_from_text
from tpvqa.planning.protocol import Plan, Planner, PlanningResult
from tpvqa.planning.text import end_of, uncommented


def plan_towards(
    planner: Planner,
    task: Task,
    state: State,
    goal: frozenset[Atom],
    *,
    timeout: float | None = None,
) -> PlanningResult:
    """A plan from a state to where some facts hold.

    Args:
        planner: Any planner.
        task: The task; what it says of its goal does not count.
        state: The atoms that hold.
        goal: The facts.
        timeout: Seconds; None for the planner's default.

    Raises:
        PlannerError: The task could not be grounded.
    """
    result = planner.plan(_with_goal(task, goal), state, timeout=timeout)
    if not isinstance(result, Plan):
        return result
    own = (task.action(action.name, action.arguments) for action in result.actions)
    return replace(result, actions=tuple(own))


@lru_cache(maxsize=16)
def _with_goal(task: Task, goal: frozenset[Atom]) -> Task:
    problem = uncommented(task.problem_text)
    old = re.search(r"\(\s*:goal\b", problem, re.I)
    assert old is not None  # a problem without one is refused
    said = " ".join(atom.pddl() for atom in sorted(goal))
    new = f"(:goal (and {said}))"
    text = problem[: old.start()] + new + problem[end_of(problem, old.start()) :]
    return task_from_text(uncommented(task.domain_text), text)
