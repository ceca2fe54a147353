"""A logic program's text → the PDDL of its task."""

import re
from pathlib import Path

from tpvqa.errors import PDDLError
from tpvqa.pddl.programs.lifting import PATTERNS, IrregularError
from tpvqa.pddl.programs.reading import read_program
from tpvqa.pddl.programs.writing import as_pddl


def pddl_of(
    text: str, *, path: Path | None = None, timeout: float | None = 60.0, memory: int | None = None
) -> tuple[str, str]:
    """Domain and problem that a logic program describes.

    Args:
        text: The program.
        path: What errors name; the task is called as it is.
        timeout: Seconds that grounding it may take.
        memory: What grounding it may hold in MiB.

    Raises:
        MissingExtraError: clingo is not installed.
        PDDLError: It is no such program.
        GroundingTimedOut: It took too long.
        PlannerError: clingo failed, or took too much memory.
    """
    program = read_program(text, path=path, timeout=timeout, memory=memory)
    try:
        return as_pddl(program, task_name(path) if path else "program")
    except IrregularError:
        raise PDDLError(
            f"the instances of an action have more than {PATTERNS} conditions or effects that are "
            "not of one shape; let what they speak of be their arguments",
            file=path or "(program)",
        ) from None


def task_name(path: Path) -> str:
    """What the task of a logic program is called: its file's name, as PDDL can say it."""
    stem = re.sub(r"[^a-z0-9_-]", "_", path.stem.lower())
    return stem if stem[:1].isalpha() else f"p{stem}"
