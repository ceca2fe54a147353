"""The door for unified-planning: a user's `Problem` becomes a `Task` through its PDDL."""

from typing import TYPE_CHECKING, Any

from tpvqa.errors import MissingExtraError, PDDLError
from tpvqa.pddl import Task, task_from_text

if TYPE_CHECKING:
    from unified_planning.model import Problem


def task_from_problem(problem: "Problem", *, timeout: float | None = 300.0) -> Task:
    """A `Task` from a problem of the unified-planning library.

    The problem is written as PDDL by that library and read as any other task, so names come out as
    its writer writes them: in lower case, and changed where PDDL would not allow them.

    Args:
        problem: A classical problem.
        timeout: Seconds that reading and grounding may take; None for no limit.

    Raises:
        MissingExtraError: unified-planning is not installed.
        PDDLError: The problem cannot be said in the PDDL that Fast Downward reads (numeric fluents
            other than action costs, time, …).
    """
    try:
        from unified_planning.exceptions import UPException
        from unified_planning.io import PDDLWriter
    except ImportError as error:
        raise MissingExtraError("unified-planning", "up", "Reading its problems") from error
    try:
        writer: Any = PDDLWriter(problem)
        domain, text = writer.get_domain(), writer.get_problem()
    except (UPException, NotImplementedError) as error:
        raise PDDLError(
            f"the problem {problem.name!r} cannot be written as PDDL: {error}"
        ) from error
    return task_from_text(domain, text, timeout=timeout)
