"""What a trial needs where actions change numbers: who plans with them, and who follows them."""

from tpvqa.errors import TpvqaError
from tpvqa.monitors import Monitor
from tpvqa.monitors.capabilities import Believing, LooksFirst
from tpvqa.pddl import Task
from tpvqa.pddl.outside.engines import taken
from tpvqa.planning import Planner
from tpvqa.planning.protocol import Numberless


def see_numbers(task: Task, planner: Planner, monitor: Monitor) -> None:
    """See that planner and monitor fit a task in which actions change numbers.

    Raises:
        TpvqaError: They do not.
    """
    if task.numeric is None:
        return
    names = ", ".join(sorted(task.numeric.changed))
    if isinstance(planner, Numberless):
        raise TpvqaError(
            f"In this domain actions change numbers ({names}), which the planner {planner.name!r} "
            f"does not know. As --planner {taken('numbers')}."
        )
    if isinstance(monitor, Believing | LooksFirst):
        raise TpvqaError(
            f"In this domain actions change numbers ({names}), of which the monitor "
            f"{monitor.name!r} keeps no belief. Write --monitor tpvqa."
        )
