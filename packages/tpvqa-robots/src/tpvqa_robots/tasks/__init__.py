"""The tasks of these robots: their domains, problems and questions."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in

ORACLE = "oracle"
"""No network was taught these pictures that could be shipped: physics tells what is true."""


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """The files of `sort_groceries`, `open_door`, `collect_teddy` and the like; and of
    `collect_toys`, unless the household is installed, which brings the same."""
    here = Path(__file__).parent
    brought = set() if find_spec("tpvqa_household") is None else {"collect_toys"}
    folders = {"toys": here, "bins": here.parent / "bins/task", "door": here.parent / "door/task"}
    return tuple(
        files
        for world, folder in folders.items()
        for files in tasks_in(folder, default_world=world, default_vlm=ORACLE)
        if files.name not in brought
    )
