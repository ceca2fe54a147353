"""The tasks of these robots: their domains, problems and questions."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """The files of `collect_toys`, unless the household is installed, which brings the same; and
    of `sort_groceries` and `open_door`."""
    here = Path(__file__).parent
    others = (
        *tasks_in(here.parent / "bins" / "task", default_world="bins"),
        *tasks_in(here.parent / "door" / "task", default_world="door"),
    )
    if find_spec("tpvqa_household") is not None:
        return others
    return (*tasks_in(here, default_world="toys"), *others)
