"""A folder that holds a task of one's own: its domain, and problems beside it."""

from collections.abc import Collection
from os.path import realpath
from pathlib import Path

from tpvqa.errors import TpvqaError
from tpvqa.tasks import PROGRAM, is_program

DOMAIN = "domain.pddl"


def problems_in(
    folder: Path, domains: Collection[Path] = (), *, programs: bool = True
) -> list[Path]:
    """The problems that lie in a folder, by name: all PDDL files that are no domain, and programs.

    Args:
        folder: Where they lie.
        domains: Domains besides its `domain.pddl`.
        programs: Whether logic programs count.
    """
    known = {realpath(each) for each in (folder / DOMAIN, *domains)}
    found = [*folder.glob("*.pddl"), *(folder.glob(f"*{PROGRAM}") if programs else ())]
    return [each for each in sorted(found) if each.is_file() and realpath(each) not in known]


def only_task(folder: Path) -> tuple[Path, Path]:
    """Domain and problem of a folder that holds one task; of a logic program both are the same.

    Raises:
        TpvqaError: It holds none, several, or a problem without its domain.
    """
    problems = problems_in(folder)
    if not problems:
        inside = ", ".join(sorted(each.parent.name for each in folder.glob(f"*/{DOMAIN}")))
        remedy = f"Name one of its folders: {inside}" if inside else "Name domain and problem"
        raise TpvqaError(
            f"{folder} holds no problem: *.pddl besides {DOMAIN}, nor *{PROGRAM} alone. {remedy}"
        )
    if len(problems) > 1:
        names = ", ".join(each.name for each in problems)
        raise TpvqaError(f"{folder} holds several problems ({names}). Name domain and problem")
    (problem,) = problems
    domain = problem if is_program(problem) else folder / DOMAIN
    if not domain.is_file():
        raise TpvqaError(f"{folder} holds no {DOMAIN}. Name domain and problem")
    return domain, problem
