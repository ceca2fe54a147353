"""The episode on disk: one writer, whole lines."""

import json
from pathlib import Path

import pytest

from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError
from tpvqa.events import Resumed


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
