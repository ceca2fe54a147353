"""Runs a trial as a user does, by the command line, and gives what counts of it."""

import io
import os
import shutil
import sys
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest import mock

from tests.proof.projection import Entry, projection
from tests.proof.specs import GIVEN, Spec


def outcome(spec: Spec, folder: Path) -> list[Entry]:
    """Run a trial in a folder that has the given files; its projection, and its exit code last.

    Args:
        spec: Which.
        folder: Where to run it; is made. The episode is written there, too.

    Raises:
        RuntimeError: It was refused.
    """
    shutil.copytree(GIVEN, folder)
    code, said = _tpvqa(["run", *spec.arguments, "--json", "--out", "episode"], folder)
    if code not in (0, 1):
        raise RuntimeError(f"{spec.name}: exit code {code}\n{said}")
    return [*projection(folder / "episode"), ["exit", code]]


def _tpvqa(arguments: list[str], folder: Path) -> tuple[int, str]:
    """The exit code of a command, and what it wrote to standard error."""
    from tpvqa.cli import main

    said = io.StringIO()
    words = mock.patch.object(sys, "argv", ["tpvqa", *arguments])
    at_once = mock.patch.object(os, "fsync")  # to wait for the disk takes most of the time
    with words, at_once, chdir(folder), redirect_stdout(io.StringIO()), redirect_stderr(said):
        try:
            main()
            code = 0
        except SystemExit as end:
            code = int(end.code or 0)
    return code, said.getvalue()
