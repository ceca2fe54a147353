"""Folders of episodes and benches: which are taken, what is left in them, how they are named."""

import re
import shlex
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.episodes.test_log import file_size
from tpvqa.episodes.own_files import BENCH as BENCH_FILES

TRIAL = ("run", "build_tower", "--world", "symbolic", "--vlm", "oracle")
BENCH = ("bench", "run", "build_tower", "--vlm", "oracle", "--episodes", 1, "--workers", 1)


@pytest.mark.parametrize("command", ["resume", "show", "report"])
def test_a_file_is_no_episode(command: str, tpvqa: Run) -> None:
    Path("d.pddl").write_text("(define (domain d))")
    code, _, err = tpvqa(command, "d.pddl")
    assert (code, "no episode: a folder" in err) == (2, True), err


@pytest.mark.parametrize("folder", ["new", "new/er/e", "old"])
def test_where_nothing_could_be_written_nothing_is_left(folder: str, tpvqa: Run) -> None:
    Path("old").mkdir()
    with file_size(0):
        code, _, err = tpvqa(*TRIAL, "--out", folder)
    assert (code, "resume" in err) == (6, False)
    assert "Nothing was begun: make room, or name another folder" in " ".join(err.split())
    assert [path.name for path in Path().rglob("*")] == ["old"]
    assert tpvqa(*TRIAL, "--out", folder)[0] == 0


def test_a_bench_does_not_lie_where_an_episode_does(tpvqa: Run) -> None:
    assert tpvqa(*TRIAL, "--out", "e")[0] == 0
    before = sorted(Path("e").rglob("*"))
    code, _, err = tpvqa(*BENCH, "--out", "e")
    assert (code, "e holds an episode; name another folder" in err) == (2, True), err
    assert sorted(Path("e").rglob("*")) == before


@pytest.mark.parametrize("file", ["e", "e/known.json", "./e/frames/known.json"])
def test_what_is_learned_does_not_lie_in_an_episode(tpvqa: Run, file: str) -> None:
    code, _, err = tpvqa(*TRIAL, "--monitor", "belief", "--out", "e", "--experience", file)
    assert (code, "is to lie in the folder of this episode, e," in err) == (2, True), err
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("left", [None, *BENCH_FILES])
def test_an_episode_does_not_lie_where_a_bench_does(tpvqa: Run, left: str | None) -> None:
    if left is None:
        assert tpvqa(*BENCH, "--out", "b")[0] == 0
    else:
        Path("b").mkdir()
        Path("b", left).touch()
    before = sorted(Path("b").rglob("*"))
    code, _, err = tpvqa(*TRIAL, "--out", "b")
    assert (code, "b holds a bench; name another folder" in err) == (2, True), err
    assert sorted(Path("b").rglob("*")) == before


@pytest.mark.parametrize("out", [["--out="], ["--out", ""]])
@pytest.mark.parametrize("command", [TRIAL, BENCH], ids=["run", "bench"])
def test_an_empty_name_is_no_folder(
    command: tuple[object, ...], out: list[str], tpvqa: Run
) -> None:
    code, _, err = tpvqa(*command, *out)
    assert (code, "--out is empty" in err, "Name a folder" in err) == (2, True, True)
    assert list(Path().iterdir()) == []


def test_what_is_said_can_be_pasted_though_the_folder_begins_with_a_dash(tpvqa: Run) -> None:
    _, out, _ = tpvqa(*TRIAL, "--out=-x")
    for command in re.findall(r"tpvqa (show [^·)]+|report [^·)]+)", out):
        assert tpvqa(*shlex.split(command))[0] == 0, command
    code, _, err = tpvqa(*TRIAL, "--out=-x")
    assert (code, "tpvqa resume ./-x" in err) == (2, True)
