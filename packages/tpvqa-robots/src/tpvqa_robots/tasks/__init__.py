"""The task of the paper's appendix: its domain, problem and questions."""

from functools import cache
from importlib.util import find_spec
from pathlib import Path

from tpvqa.tasks import TaskFiles, tasks_in


@cache
def task_files() -> tuple[TaskFiles, ...]:
    """The files of `collect_toys`; none where the household is installed, which brings the same."""
    if find_spec("tpvqa_household") is not None:
        return ()
    return tasks_in(Path(__file__).parent, default_world="toys")
