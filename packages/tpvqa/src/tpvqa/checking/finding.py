"""What is found wrong with a domain and its files."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from tpvqa.errors import PlacedError


class Severity(StrEnum):
    """How bad it is."""

    ERROR = "error"  # nothing can be run, or no trial can succeed
    WARNING = "warning"  # runs, and will be worse for it
    NOTE = "note"  # could be better


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is wrong, where, and what to do.

    Attributes:
        kind: A short name for what it is, the same for all findings of the kind.
        severity: How bad it is.
        says: What is wrong, a sentence.
        remedy: What to do, a sentence.
        file: The file it stands in, where there is one.
        line: The line, counted from 1, where known.
        paste: Lines for a file, as they are to stand there; empty for none.
        into: The file that these lines are for.
    """

    kind: str
    severity: Severity
    says: str
    remedy: str = ""
    file: str | None = None
    line: int | None = None
    paste: tuple[str, ...] = ()
    into: str | None = None

    @property
    def place(self) -> str:
        """File and line, as editors read them; empty where there is no file."""
        if self.file is None:
            return ""
        return self.file if self.line is None else f"{self.file}:{self.line}"


def of_error(kind: str, error: PlacedError) -> Finding:
    """What cannot be read, as a finding."""
    file = None if error.file is None else str(error.file)
    return Finding(kind, Severity.ERROR, error.message, "", file, error.line)


def named(path: Path | None) -> str | None:
    """A path as findings name it."""
    return None if path is None else str(path)
