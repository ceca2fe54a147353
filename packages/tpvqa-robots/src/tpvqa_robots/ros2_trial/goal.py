"""What a goal of `RunTask` asks for, as the configuration of a trial."""

from pathlib import Path
from typing import Any

from tpvqa import TrialConfig
from tpvqa.errors import TpvqaError
from tpvqa.tasks import find_task

LONGEST = 1_000_000
"""Letters of a problem that are read."""


def config_of(goal: Any, base: TrialConfig, folder: Path) -> TrialConfig:
    """The trial that a goal asks for.

    A goal names a task and what holds; files, servers and programs are those of whoever started the
    server.

    Args:
        goal: Of `RunTask`.
        base: What the server was started with.
        folder: Where a problem that is given as text may be written.

    Raises:
        TpvqaError: The task is not known, or the problem cannot be taken.
    """
    change: dict[str, Any] = {} if goal.seed < 0 else {"seed": int(goal.seed)}
    task = base.task
    if goal.task and goal.task != task.name:
        find_task(goal.task)
        task = task.model_copy(update=dict.fromkeys(type(task).model_fields) | {"name": goal.task})
    if goal.problem:
        if len(goal.problem) > LONGEST:
            raise TpvqaError(f"A problem has {LONGEST:,} letters at most.")
        problem = folder / "problem.pddl"
        problem.write_text(goal.problem)
        task = task.model_copy(update=_files(task) | {"name": None, "problem": str(problem)})
    return base.model_copy(update={**change, "task": task})


def _files(task: Any) -> dict[str, Any]:
    """The files of a shipped task that another problem of its domain needs, too."""
    if task.name is None:
        return {}
    files = find_task(task.name)
    named = {"questions": files.questions, "world_file": files.world}
    found = {"domain": str(files.domain)}
    for name, path in named.items():
        if getattr(task, name) is None and path is not None:
            found[name] = str(path)
    return found


def new_folder(out: Path, task: str, seed: int) -> Path:
    """A folder of which there is none yet."""
    folder, number = out / f"{task}-seed{seed}", 2
    while folder.exists():
        folder, number = out / f"{task}-seed{seed}-run{number}", number + 1
    return folder
