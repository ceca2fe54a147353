"""The command line, as a user meets it."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tpvqa.cli import main

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def tpvqa(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> Run:
    """Run the command in an empty folder: its exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["tpvqa", *map(str, words)])
        try:
            main()
            code = 0
        except SystemExit as end:
            code = int(end.code or 0)
        return code, *capsys.readouterr()

    return run
