"""Calls into planners, worlds and VLMs: what plug-ins raise or return may be anything."""

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar, cast

from pydantic import ValidationError

from tpvqa.errors import EpisodeError, PluginError, TpvqaError
from tpvqa.pddl import State, Task
from tpvqa.planning import Planner, PlanningResult
from tpvqa.protocols import called_at, short
from tpvqa.told import first_fault
from tpvqa.vlm.capabilities import kind_of
from tpvqa.worlds import Restorable, World

T = TypeVar("T")
THEN = "Mend it; the episode can be gone on with"
"""What to do where a part broke."""
_VIEWS = cast("type[Sequence[str]]", Sequence)


def called(part: object, method: str, wanted: type[T], /, *given: object, **named: object) -> T:
    """What a method of a planner, a world or a VLM returns.

    Args:
        part: The planner, world or VLM.
        method: Which of its methods.
        wanted: What it has to return.
        *given: Its arguments.
        **named: More of them.

    Raises:
        TpvqaError: What it raised itself.
        PluginError: It raised something else, or returned something else; says where.
    """
    where = _where(part, method)
    result = called_at(where, lambda: getattr(part, method)(*given, **named), then=THEN)
    if not isinstance(result, wanted):
        raise PluginError(f"{where} has to return {wanted.__name__}, not {short(result)}. {THEN}")
    return result


def planned(
    planner: Planner, task: Task, state: State | None = None, *, timeout: float | None = None
) -> PlanningResult:
    """What a planner comes to outside of trials; arguments as of `Planner.plan`.

    Raises:
        TpvqaError: What it raised itself.
        PluginError: It raised something else, or returned something else.
    """
    where = _where(planner, "plan")
    result = called_at(where, lambda: planner.plan(task, state, timeout=timeout))
    return planning_result(planner, result)


def planning_result(planner: Planner, result: object) -> PlanningResult:
    """What a planner returned.

    Raises:
        PluginError: It is no result.
    """
    if isinstance(result, PlanningResult):
        return result
    raise PluginError(
        f"{planner.name} has to return a Plan, Unsolvable, TimedOut or Crashed, not {short(result)}"
    )


def views_of(world: World) -> tuple[str, ...]:
    """The views of a world, the default one first.

    Raises:
        PluginError: It broke, or returned something else.
    """
    views = called(world, "views", _VIEWS)
    if isinstance(views, str) or not all(isinstance(each, str) and each for each in views):
        where = _where(world, "views")
        raise PluginError(f"{where} has to return a list of names, not {short(views)}")
    return tuple(views)


def put_back(part: Restorable, name: str, snapshot: Mapping[str, Any]) -> None:
    """Put a part where the log left it.

    Raises:
        EpisodeError: What the log says of it is not what the part once gave.
    """
    try:
        part.restore(snapshot)
    except TpvqaError:
        raise
    except Exception as error:
        raise EpisodeError(
            f"the {name} cannot go on from what the log keeps of it ({type(error).__name__}: "
            f"{error}): the log is damaged, or another version's. Show the episode instead"
        ) from error


def malformed(part: object, method: str, error: Exception) -> PluginError:
    """What a method returned has the right type, but its insides are not what they must be."""
    if isinstance(error, ValidationError):
        first = first_fault(error)
        said = f"{'.'.join(map(str, first['loc']))}: {first['msg']}"
    else:
        said = f"{type(error).__name__}: {error}"
    return PluginError(f"{_where(part, method)} returned what cannot be kept: {said}. {THEN}")


MALFORMED = (ValidationError, AttributeError, KeyError, TypeError, ValueError)
"""What is raised where something of a plug-in is put into the log that does not belong there."""


def _where(part: object, method: str) -> str:
    kind = kind_of(part)
    return f"{kind.__module__}.{kind.__qualname__}.{method}"
