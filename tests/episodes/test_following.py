"""A log read while it grows."""

import threading
import time
from pathlib import Path

import pytest

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.episodes import EpisodeWriter, follow, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import EpisodeError
from tpvqa.events import Event

CONFIG = configured(task="build_tower", world="symbolic", vlm="oracle:0.9", monitor="tpvqa")


def test_many_readers_follow_one_log_each_from_where_it_likes(tmp_path: Path) -> None:
    read: dict[int, list[Event]] = {}

    def reader(start: int) -> None:
        read[start] = list(follow(tmp_path / "e", start=start, poll=0.002, timeout=20))

    readers = [threading.Thread(target=reader, args=(start,)) for start in (0, 1, 5, 17)]
    for each in readers:
        each.start()
    with Trial(CONFIG) as trial:
        writer = EpisodeWriter(tmp_path / "e", durable=False)
        trial.run(writer, listeners=[lambda event: time.sleep(0.002)])
        writer.close()
    for each in readers:
        each.join()
    whole = read_episode(tmp_path / "e")
    assert {start: events for start, events in read.items() if events != whole[start:]} == {}


def test_a_line_that_is_not_whole_yet_is_waited_for(tmp_path: Path) -> None:
    with Trial(CONFIG) as trial:
        writer = EpisodeWriter(tmp_path, durable=False)
        trial.run(writer)
        writer.close()
    data = (tmp_path / LOG).read_bytes()
    (tmp_path / LOG).write_bytes(data[:1000])
    following = follow(tmp_path / LOG, poll=0.001, timeout=0.05)
    told: list[Event] = []
    with pytest.raises(EpisodeError, match="no further event"):
        told += following
    assert data[:1000].count(b"\n") <= 1
    (tmp_path / LOG).write_bytes(data)
    assert list(follow(tmp_path, timeout=1)) == read_episode(tmp_path)


def test_a_damaged_line_is_named(tmp_path: Path) -> None:
    (tmp_path / LOG).write_bytes(b'{"kind": "nonsense"}\n')
    with pytest.raises(EpisodeError, match=r"episode\.jsonl:1"):
        list(follow(tmp_path, timeout=1))


def test_a_log_of_another_version_is_refused_with_the_version_that_reads_it(
    tmp_path: Path,
) -> None:
    (tmp_path / LOG).write_text('{"kind": "started", "version": "0.1.0", "task": "x"}\n')
    with pytest.raises(EpisodeError, match=r"written by tpvqa 0\.1\.0.*tpvqa 0\.1\.0 reads it"):
        read_episode(tmp_path)


def test_what_was_ended_by_ctrl_c_and_is_gone_on_with_is_followed_on(tmp_path: Path) -> None:
    with Trial(CONFIG) as trial:
        writer = EpisodeWriter(tmp_path, durable=False)
        trial.run(writer)
        writer.close()
    whole = (tmp_path / LOG).read_bytes()
    lines = whole.splitlines(keepends=True)
    (tmp_path / LOG).write_bytes(b"".join(lines[:8]))
    following = follow(tmp_path, poll=0.001, timeout=5)
    told = [next(following) for _ in range(8)]
    (tmp_path / LOG).write_bytes(b"".join(lines[:5]))
    shorter = threading.Timer(0.05, lambda: (tmp_path / LOG).write_bytes(whole))
    shorter.start()
    told += list(following)
    assert told == read_episode(tmp_path)
