"""The paper's three tasks, and the trial of its appendix."""

from functools import cache
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """Their files.

    The three tasks are run on the shipped pictures unless another world is named. `collect_toys`
    has no pictures: it is told by its script.
    """
    here = Path(__file__).parent
    return (
        *tasks_in(here, default_world="images", pictures=here.parent / "images" / "data"),
        *tasks_in(here / "toys", default_world="scripted"),
    )
