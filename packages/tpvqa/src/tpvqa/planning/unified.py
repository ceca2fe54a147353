"""The door for unified-planning: its `Problem` becomes a `Task`, our plan its `SequentialPlan`."""

from typing import TYPE_CHECKING, Any

from tpvqa.errors import MissingExtraError, PDDLError, PlannerError
from tpvqa.pddl import Task, task_from_text
from tpvqa.planning.protocol import Plan, PlanningResult, TimedOut

if TYPE_CHECKING:
    from unified_planning.model import Problem
    from unified_planning.plans import SequentialPlan


def task_from_problem(problem: "Problem", *, timeout: float | None = 300.0) -> Task:
    """A `Task` from a problem of the unified-planning library.

    The problem is written as PDDL by that library and read as any other task, so names come out as
    its writer writes them: in lower case, and changed where PDDL would not allow them.

    Args:
        problem: A classical problem.
        timeout: Seconds that reading and grounding may take; None for no limit.

    Raises:
        MissingExtraError: unified-planning is not installed.
        PDDLError: The problem cannot be said in the PDDL that is read here (functions whose values
            are objects, …).
    """
    writer = _written(problem)
    return task_from_text(writer.get_domain(), writer.get_problem(), timeout=timeout)


def sequential_plan(problem: "Problem", plan: PlanningResult) -> "SequentialPlan":
    """A plan in the terms of the problem of unified-planning that its task was made from.

    Args:
        problem: The problem.
        plan: A plan of `task_from_problem(problem)`.

    Raises:
        PlannerError: There is no plan: the planner came to something else.
        MissingExtraError: unified-planning is not installed.
        PDDLError: The problem cannot be said in PDDL, or the plan is of another one.
    """
    if not isinstance(plan, Plan):
        limit = f"it took more than {plan.limit:g} s" if isinstance(plan, TimedOut) else ""
        raise PlannerError(
            f"there is no plan to hand over, {plan.planner} ended otherwise "
            f"({type(plan).__name__}): {limit or getattr(plan, 'reason', '')}. Ask first whether "
            "isinstance(result, tpvqa.planning.Plan)"
        )
    writer = _written(problem)
    from unified_planning.exceptions import UPException
    from unified_planning.plans import ActionInstance, SequentialPlan

    try:
        steps = [
            ActionInstance(
                writer.get_item_named(action.name),
                tuple(
                    problem.environment.expression_manager.ObjectExp(writer.get_item_named(name))
                    for name in action.arguments
                ),
            )
            for action in plan.actions
        ]
        return SequentialPlan(steps, problem.environment)
    except (UPException, AssertionError) as error:
        raise PDDLError(f"the plan is not one of the problem {problem.name!r}: {error}") from error


def _written(problem: "Problem") -> Any:
    """What has written a problem as PDDL, and knows what it called everything."""
    try:
        from unified_planning.exceptions import UPException
        from unified_planning.io import PDDLWriter
    except ImportError as error:
        raise MissingExtraError("unified-planning", "up", "Reading its problems") from error
    if any(hasattr(action, "duration") for action in problem.actions):
        raise PDDLError(
            f"in the problem {problem.name!r} actions last, and a plan of such comes back as no "
            "sequence: write it as PDDL files (unified_planning.io.PDDLWriter) and name those"
        )
    try:
        writer: Any = PDDLWriter(problem)
        writer.get_domain()
        writer.get_problem()
    except (UPException, NotImplementedError) as error:
        raise PDDLError(
            f"the problem {problem.name!r} cannot be written as PDDL: {error}"
        ) from error
    return writer
