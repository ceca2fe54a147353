"""The tasks that come with the package: PDDL, questions and world beside each other."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path

from tpvqa.errors import UnknownNameError


@dataclass(frozen=True, slots=True)
class TaskFiles:
    """Where the files of a shipped task lie.

    Attributes:
        name: The task's name.
        domain: The PDDL domain.
        problem: The PDDL problem.
        questions: How facts and actions are put into questions.
        world: How facts come undone in a simulated world.
    """

    name: str
    domain: Path
    problem: Path
    questions: Path
    world: Path


@cache
def shipped_tasks() -> tuple[TaskFiles, ...]:
    """All shipped tasks, by name."""
    found = []
    for domain in sorted(Path(__file__).parent.glob("*/domain.pddl")):
        folder = domain.parent
        for problem in sorted(folder.glob("*.pddl")):
            if problem != domain:
                files = TaskFiles(
                    name=problem.stem,
                    domain=domain,
                    problem=problem,
                    questions=folder / "questions.yaml",
                    world=folder / "world.yaml",
                )
                found.append(files)
    return tuple(sorted(found, key=lambda files: files.name))


def find_task(name: str) -> TaskFiles:
    """The files of a shipped task.

    Raises:
        UnknownNameError: There is none of that name.
    """
    for files in shipped_tasks():
        if files.name == name:
            return files
    raise UnknownNameError("task", name, [files.name for files in shipped_tasks()])
