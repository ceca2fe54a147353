"""Standard output and standard error: what is done where they are closed, full, or read no more.

A result that cannot be printed is an error, as what was asked for is lost. A note is not: a trial
goes on without it.
"""

import os
import sys
from collections.abc import Sequence
from io import TextIOWrapper
from typing import Any, TextIO

from tpvqa.errors import WriteError


def print_anything() -> None:
    """Let letters that a terminal or a pipe has no code for be escaped, instead of an error."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def take_no_size_of_nothing() -> None:
    """Let a terminal that is said to have no columns, or no lines, count as one that says nothing.

    Some shells and runners of jobs set them to 0, and Rich would print none of a trial.
    """
    for name in ("COLUMNS", "LINES"):
        if os.environ.get(name, "").strip("0") == "":
            os.environ.pop(name, None)


def check_output(arguments: Sequence[str]) -> None:
    """See, before anything is done, that a result that a program is to read can be printed.

    Raises:
        WriteError: Standard output was closed before the program began.
    """
    if sys.stdout is None and "--json" in arguments:
        raise WriteError("Standard output is closed. Leave out --json, which prints there.")


def all_printed() -> None:
    """Hand on what was printed.

    Raises:
        OSError: It cannot be.
    """
    if sys.stdout is not None:  # None where it was closed before the program began
        sys.stdout.flush()


def give_up(stream: TextIO | Any) -> None:
    """Let go of what a stream still holds, which Python would try to write at its end."""
    try:
        place = stream.fileno()
    except (AttributeError, OSError, ValueError):  # None, or one that writes to no file
        return
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, place)
    os.close(nowhere)


def end_notes() -> None:
    """Hand on the notes, and let go of those that nobody takes."""
    try:
        if sys.stderr is not None:
            sys.stderr.flush()
    except OSError:
        give_up(sys.stderr)
