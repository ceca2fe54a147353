"""What a trial needs where actions last: an engine that knows time, a world with a clock."""

from tpvqa.errors import TpvqaError
from tpvqa.monitors import Monitor
from tpvqa.monitors.capabilities import Believing, LooksFirst
from tpvqa.pddl import Task
from tpvqa.pddl.outside.engines import taken
from tpvqa.planning import Planner
from tpvqa.planning.protocol import TemporalPlanner
from tpvqa.planning.watching import Watching
from tpvqa.worlds import World
from tpvqa.worlds.capabilities import Timed


def watching(task: Task, planner: Planner, *, every: float | None) -> Planner:
    """The planner of a trial: where actions last, one that puts looks into its plans.

    Args:
        task: The task.
        planner: The planner that was asked for.
        every: The time between two looks; None for a quarter of each action's time.

    Raises:
        TpvqaError: Actions last, and it knows no time.
    """
    if task.lasting is None:
        return planner
    if not isinstance(planner, TemporalPlanner):
        raise TpvqaError(
            f"In this domain actions last ({_names(task)}), which the planner {planner.name!r} "
            f"does not know. As --planner {taken('time')}."
        )
    return Watching(planner, every=every)


def see_lasting(task: Task, world: World, monitor: Monitor) -> None:
    """See that world and monitor fit a task whose actions last.

    Raises:
        TpvqaError: They do not.
    """
    if task.lasting is None:
        return
    if not isinstance(world, Timed):
        raise TpvqaError(
            f"In this domain actions last ({_names(task)}), and the world {type(world).__name__} "
            "has no clock by which they do. Take --world symbolic, or give yours a method "
            "wait(until, *, cancel) as worlds.capabilities.Timed says."
        )
    if isinstance(monitor, Believing | LooksFirst):
        raise TpvqaError(
            f"In this domain actions last ({_names(task)}), and the monitor {monitor.name!r} goes "
            "through a plan in an order of its own, which keeps to no times. Write --monitor tpvqa."
        )


def _names(task: Task) -> str:
    assert task.lasting is not None
    return ", ".join(sorted(task.lasting.variables))
