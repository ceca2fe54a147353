"""The tasks of these robots: their domains, problems and questions."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """The files of `sort_groceries`, `open_door`, `collect_teddy` and the like; and of
    `collect_toys`, unless the household is installed, which brings the same."""
    here = Path(__file__).parent
    brought = set() if find_spec("tpvqa_household") is None else {"collect_toys"}
    return (
        *(f for f in tasks_in(here, default_world="toys") if f.name not in brought),
        *tasks_in(here.parent / "bins" / "task", default_world="bins"),
        *tasks_in(here.parent / "door" / "task", default_world="door"),
    )
