"""Standard output and standard error that are closed, full, or read by nobody any more."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from tpvqa.episodes import read_episode
from tpvqa.events import Ended
from tpvqa.events.events import ListenerDropped

Shell = Callable[[str], tuple[int, str, str]]
TRIAL = "run build_tower --world symbolic --vlm oracle:0.9 --seed 1 --out e"


@pytest.fixture(params=["", "1"], ids=["buffered", "unbuffered"])
def shell(request: pytest.FixtureRequest, tmp_path: Path) -> Shell:
    """Run the command, written with redirections, in an empty folder: its code, stdout, stderr."""

    def run(words: str) -> tuple[int, str, str]:
        command = f'"$0" -m tpvqa {words}; echo "${{PIPESTATUS[0]}}" >code'
        environment = {**os.environ, "PYTHONUNBUFFERED": request.param}
        done = subprocess.run(
            ["bash", "-c", command, sys.executable],
            cwd=tmp_path, env=environment, capture_output=True, text=True, check=False,
        )  # fmt: skip
        return int((tmp_path / "code").read_text()), done.stdout, done.stderr

    return run


@pytest.mark.parametrize("words", [f"{TRIAL} --json", "plan build_tower", "prompt"])
def test_a_result_that_nobody_reads_is_one_that_could_not_be_written(
    shell: Shell, words: str
) -> None:
    code, _, err = shell(f"{words} | true")
    assert (code, "Traceback" in err) == (6, False)
    assert "standard output or a file cannot be written (Broken pipe)" in err


def test_a_result_for_a_program_is_not_begun_where_there_is_no_output(
    shell: Shell, tmp_path: Path
) -> None:
    code, _, err = shell(f"{TRIAL} --json >&-")
    assert (code, "Leave out --json" in err) == (6, True)
    assert not (tmp_path / "e").exists()


def test_a_trial_goes_on_in_silence_where_nobody_looks_on(shell: Shell, tmp_path: Path) -> None:
    code, out, err = shell(f"{TRIAL} | head -1")
    events = read_episode(tmp_path / "e")
    ended = events[-1]
    assert isinstance(ended, Ended)
    assert code == (0 if ended.completed else 1)
    assert len(out.splitlines()) == 1
    assert all(line.startswith("note: ") for line in err.splitlines())
    assert not any(isinstance(event, ListenerDropped) for event in events)
    code, _, err = shell("show e | true")
    assert (code, "Broken pipe" in err) == (6, True)


@pytest.mark.parametrize("nowhere", ["2>/dev/full", "2>&-"])
def test_a_note_that_cannot_be_written_stops_no_trial(shell: Shell, nowhere: str) -> None:
    code, out, _ = shell(f"{TRIAL} --json {nowhere}")
    result = json.loads(out)  # no note is in it
    assert code == (0 if result["completed"] else 1)


@pytest.mark.parametrize("words", ["show e", "run --help"])
def test_a_terminal_of_no_columns_is_one_of_unknown_size(
    shell: Shell, monkeypatch: pytest.MonkeyPatch, words: str
) -> None:
    shell(TRIAL)
    monkeypatch.delenv("COLUMNS", raising=False)
    usual = shell(words)
    monkeypatch.setenv("COLUMNS", "0")
    monkeypatch.setenv("LINES", "0")
    assert shell(words) == usual
