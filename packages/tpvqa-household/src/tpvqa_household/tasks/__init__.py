"""The paper's three tasks: clean_dishes, serve_breakfast, eat_apple."""

from functools import cache
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """Their files; they are run on the shipped pictures unless another world is named."""
    here = Path(__file__).parent
    return tasks_in(here, default_world="images", pictures=here.parent / "images" / "data")
