"""The episode on disk: one writer, whole lines."""

import json
import os
import resource
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.doubles import configured
from tests.episodes.believing import started
from tpvqa.assembly import Trial
from tpvqa.belief.learning.experience import Experience
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.episodes.report import render_report, write_report
from tpvqa.episodes.shape import FRAMES
from tpvqa.errors import EpisodeError, WriteError
from tpvqa.events import Resumed
from tpvqa.observation import Frame
from tpvqa.pddl.processes import WORKERS
from tpvqa.resuming import resume


def numbers(folder: Path) -> list[int]:
    lines = (folder / LOG).read_text(encoding="utf-8").splitlines()
    return [json.loads(line)["number"] for line in lines]


def test_two_writers_never_write_one_episode(tmp_path: Path) -> None:
    first = EpisodeWriter(tmp_path)
    first.append(Resumed())
    with pytest.raises(EpisodeError, match="still being written"):
        EpisodeWriter(tmp_path, resume=1)
    first.append(Resumed())
    first.close()
    second = EpisodeWriter(tmp_path, resume=2)
    second.append(Resumed())
    second.close()
    assert numbers(tmp_path) == [0, 1, 2]


def test_an_empty_log_is_no_episode(tmp_path: Path) -> None:
    (tmp_path / LOG).touch()
    writer = EpisodeWriter(tmp_path)
    writer.append(Resumed())
    writer.close()
    assert numbers(tmp_path) == [0]


def test_a_torn_line_is_cut_off_when_the_episode_goes_on(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path)
    writer.append(Resumed())
    writer.close()
    with (tmp_path / LOG).open("ab") as log:
        log.write(b'{"kind": "resu')
    writer = EpisodeWriter(tmp_path, resume=1)
    writer.append(Resumed())
    writer.close()
    assert numbers(tmp_path) == [0, 1]


def test_pictures_that_a_kill_left_half_written_go_when_the_episode_goes_on(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path)
    writer.append(started())
    writer.close()
    half, mine = tmp_path / FRAMES / f".{'0a' * 8}.part", tmp_path / FRAMES / ".mine.part"
    half.touch()
    mine.touch()
    writer, _ = EpisodeWriter.going_on(tmp_path)
    assert half.exists()  # nothing has been gone on with
    writer.append(Resumed())
    writer.close()
    assert (half.exists(), mine.exists()) == (False, True)


def test_a_log_that_was_torn_in_its_first_event_is_begun_anew(tmp_path: Path) -> None:
    for torn in (b"{", b'{"number":0,"time":0.1,"kind":"star'):
        (tmp_path / LOG).write_bytes(torn)
        with pytest.raises(EpisodeError, match=r"nothing is lost. Begin it anew .*--out"):
            EpisodeWriter.going_on(tmp_path)
        writer = EpisodeWriter(tmp_path)
        writer.append(Resumed())
        writer.close()
        assert (writer.begun_anew, numbers(tmp_path)) == (True, [0])


@pytest.mark.parametrize("there", [b"my notes", b'{"number":0}\n', b"\n"])
def test_what_is_not_torn_is_not_overwritten(tmp_path: Path, there: bytes) -> None:
    (tmp_path / LOG).write_bytes(there)
    with pytest.raises(EpisodeError, match="holds an episode already"):
        EpisodeWriter(tmp_path)
    assert (tmp_path / LOG).read_bytes() == there


def test_who_comes_too_late_to_an_empty_folder_does_not_write_into_it(tmp_path: Path) -> None:
    first = EpisodeWriter(tmp_path)
    with pytest.raises(EpisodeError, match="still being written"):
        EpisodeWriter(tmp_path)
    first.append(Resumed())
    first.close()
    with pytest.raises(EpisodeError, match="holds an episode already"):
        EpisodeWriter(tmp_path)
    assert numbers(tmp_path) == [0]


@contextmanager
def file_size(most: int) -> Iterator[None]:
    """No file may grow beyond this, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "dont_write_bytecode", True)  # it would be kept torn
        patch.setenv("PYTHONDONTWRITEBYTECODE", "1")
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, before[1]))
        try:
            yield
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, before)
            WORKERS.close()  # one that was started meanwhile is held to it, too


def test_where_the_disk_is_full_the_log_stays_whole_and_is_gone_on_with(tmp_path: Path) -> None:
    config = configured(task="build_tower", world="symbolic", vlm="oracle:0.9", monitor="tpvqa")
    with Trial(config) as trial:
        writer = EpisodeWriter(tmp_path / "whole", durable=False)
        trial.run(writer)
        writer.close()
    whole = (tmp_path / "whole" / LOG).read_bytes()
    size = len(whole)
    for most in (size // 2, size * 9 // 10, whole.index(b"\n") + 5):
        folder = tmp_path / f"full{most}"
        writer = EpisodeWriter(folder, durable=False)
        with Trial(config) as trial, file_size(most), pytest.raises(WriteError, match="resume"):
            trial.run(writer)
        writer.close()
        assert (folder / LOG).read_bytes().endswith(b"\n")
        assert len(read_episode(folder)) < len(read_episode(tmp_path / "whole"))
        resume(folder)
        kinds = [event.kind for event in read_episode(folder)]
        assert kinds == [event.kind for event in read_episode(tmp_path / "whole")]


def test_a_picture_a_report_or_experience_that_cannot_be_written_leaves_nothing(
    tmp_path: Path,
) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    writer.append(started())
    known = tmp_path / "known.json"
    experience = Experience(failure=(1, 2), disturbance=(1, 2))
    experience.save(known)
    render_report(read_episode(tmp_path), tmp_path)  # now the task is known and needs no room
    before = sorted(tmp_path.rglob("*"))
    for do in (
        lambda: writer.save_frame(Frame("0000-front", "front", bytes(5000))),
        lambda: write_report(tmp_path),
        lambda: experience.save(known),
    ):
        with file_size(50), pytest.raises(WriteError, match="cannot be written"):
            do()
        assert sorted(tmp_path.rglob("*")) == before
    assert Experience.load(known) == experience
    writer.close()


def test_what_ctrl_c_interrupts_is_not_in_the_log(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = EpisodeWriter(tmp_path)
    writer.append(started())

    def press(_: int) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr(os, "fsync", press)
        with pytest.raises(KeyboardInterrupt):
            writer.append(Resumed())
    writer.append(Resumed())
    writer.close()
    assert numbers(tmp_path) == [0, 1]
