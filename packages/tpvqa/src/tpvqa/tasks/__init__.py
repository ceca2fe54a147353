"""Tasks by name: those that come with the package, and those that other packages bring.

A package brings a *family* of tasks, one domain and its problems, by an entry point in the group
`tpvqa.tasks`: a function without arguments that gives their `TaskFiles`. `tasks_in` makes them of a
folder:

    def task_files():
        return tasks_in(Path(__file__).parent)
"""

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TypeVar

from tpvqa.distributions import remedy
from tpvqa.errors import PluginError, TpvqaError, UnknownNameError
from tpvqa.plugins import Kind, load, names

QUESTIONS, WORLD = "questions.yaml", "world.yaml"
"""What the files of a task are called that are found beside it."""
PROGRAM = ".lp"
"""How files of logic programs end."""
F = TypeVar("F", Path, str)

_LOG = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class TaskFiles:
    """Where the files of a shipped task lie.

    Attributes:
        name: The task's name.
        domain: The PDDL domain.
        problem: The PDDL problem.
        questions: How facts and actions are put into questions; None for fallbacks alone.
        world: How facts come undone in a simulated world; None where they do not.
        default_world: Specification of the world that it is run in where none is named.
        default_vlm: Specification of the VLM that is asked about its pictures where none is named;
            empty for the embedded network.
        pictures: The folder of labelled pictures of it; None where there are none.
        script: What goes wrong in it in the scripted world; None for nothing.
    """

    name: str
    domain: Path
    problem: Path
    questions: Path | None
    world: Path | None
    default_world: str = "symbolic"
    default_vlm: str = ""
    pictures: Path | None = None
    script: Path | None = None


def tasks_in(
    folder: Path,
    *,
    default_world: str = "symbolic",
    default_vlm: str = "",
    pictures: Path | None = None,
) -> tuple[TaskFiles, ...]:
    """The tasks of a folder.

    Args:
        folder: Holds `domain.pddl`, `questions.yaml`, `world.yaml` and `script.yaml` (each where
            there is one); every other PDDL file in it is a problem, and a task of that name.
        default_world: As in `TaskFiles`.
        default_vlm: As in `TaskFiles`.
        pictures: As in `TaskFiles`.
    """
    domain = folder / "domain.pddl"
    questions, world = folder / QUESTIONS, folder / WORLD
    script = folder / "script.yaml"
    return tuple(
        TaskFiles(
            name=problem.stem,
            domain=domain,
            problem=problem,
            questions=questions if questions.exists() else None,
            world=world if world.exists() else None,
            default_world=default_world,
            default_vlm=default_vlm,
            pictures=pictures,
            script=script if script.exists() else None,
        )
        for problem in sorted(folder.glob("*.pddl"))
        if problem != domain
    )


def is_program(path: Path | str) -> bool:
    """Whether a file is a logic program, which is domain and problem in one."""
    return Path(path).suffix.lower() == PROGRAM


def domain_and_problem(domain: F | None, problem: F | None) -> tuple[F | None, F | None]:
    """The files of a task of one's own: a logic program that is named once stands for both."""
    if problem is None and domain is not None and is_program(domain):
        return domain, domain
    if domain is None and problem is not None and is_program(problem):
        return problem, problem
    return domain, problem


def beside(name: str, problem: Path, domain: Path) -> Path | None:
    """A file that belongs to a task because it lies beside its problem, or else beside its domain.

    A link is not followed: nobody has named it.

    Args:
        name: QUESTIONS or WORLD.
        problem: The problem.
        domain: The domain.
    """
    found = (folder / name for folder in (problem.parent, domain.parent))
    return next((path for path in found if path.is_file() and not path.is_symlink()), None)


@cache
def blocksworld() -> tuple[TaskFiles, ...]:
    """The small family that comes with the package."""
    return tasks_in(Path(__file__).parent / "blocksworld")


def shipped_tasks() -> tuple[TaskFiles, ...]:
    """The tasks of all installed packages, by name; a family that is broken is warned of."""
    found: list[TaskFiles] = []
    for family in _families():
        if isinstance(family, TpvqaError):
            _LOG.warning("%s", family)
        else:
            found += family
    return tuple(sorted(found, key=lambda files: files.name))


def find_task(name: str) -> TaskFiles:
    """The files of a shipped task.

    Raises:
        UnknownNameError: There is none of that name.
        PluginError: Two packages bring one, or there is none and a family is broken.
    """
    families = list(_families())
    known = [files for family in families if isinstance(family, tuple) for files in family]
    found = list(dict.fromkeys(files for files in known if files.name == name))
    if len(found) > 1:
        folders = " and ".join(sorted(str(files.problem) for files in found))
        raise PluginError(f"There are several tasks {name!r}: {folders}. Uninstall one of them.")
    if found:
        return found[0]
    for family in families:
        if isinstance(family, TpvqaError):
            raise family
    listed = [files.name for files in known]
    raise UnknownNameError("task", name, listed, remedy=remedy("task", name))


def _families() -> Iterator[tuple[TaskFiles, ...] | TpvqaError]:
    """The tasks of each family, or why they cannot be had."""
    for name in names(Kind.FAMILY):
        try:
            found = tuple(load(Kind.FAMILY, name)())
        except TpvqaError as error:
            yield error
        except Exception as error:  # noqa: BLE001 — a family of another package's
            yield PluginError(f"The family of tasks {name!r} broke: {error!r}.")
        else:
            if all(isinstance(files, TaskFiles) for files in found):
                yield found
            else:
                yield PluginError(f"The family of tasks {name!r} has to give TaskFiles.")
