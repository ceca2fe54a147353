"""What a trial needs where actions change numbers: a monitor that follows them."""

from tpvqa.errors import TpvqaError
from tpvqa.monitors import Monitor
from tpvqa.monitors.capabilities import Believing, LooksFirst
from tpvqa.pddl import Task


def see_numbers(task: Task, monitor: Monitor) -> None:
    """See that the monitor fits a task in which actions change numbers.

    Raises:
        TpvqaError: It does not.
    """
    if task.numeric is not None and isinstance(monitor, Believing | LooksFirst):
        names = ", ".join(sorted(task.numeric.changed))
        raise TpvqaError(
            f"In this domain actions change numbers ({names}), of which the monitor "
            f"{monitor.name!r} keeps no belief. Write --monitor tpvqa."
        )
