"""Links, pipes and devices in an episode's folder: not followed, waited for or overwritten."""

import base64
import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.episodes.believing import started
from tpvqa.episodes import EpisodeWriter, follow, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.episodes.report import write_report
from tpvqa.errors import EpisodeError, PluginError, WriteError
from tpvqa.events.events import FrameRecord, Observed
from tpvqa.events.records import observation_from
from tpvqa.files import write_whole
from tpvqa.observation import Frame

SECRET = b"a secret that is nobody else's"
PNG = base64.b64decode(
    "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mNk+M9QDwADhgGAWjR9awAAAABJRU5ErkJggg=="
)
FRAME = "frames/0000-front.png"
Put = Callable[[Path, Path], None]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """An episode with one look, and a secret beside it."""
    writer = EpisodeWriter(tmp_path / "e", durable=False)
    writer.append(started())
    file = writer.save_frame(Frame("0000-front", "front", PNG, "image/png"))
    frame = FrameRecord(view="front", file=file, media_type="image/png")
    writer.append(Observed(look=0, world_time=0.0, frames=(frame,)))
    writer.close()
    (tmp_path / "secret").write_bytes(SECRET)
    (tmp_path / "picture").write_bytes(PNG)
    return tmp_path / "e"


def link(place: Path, outside: Path) -> None:
    place.symlink_to(outside / "picture")


def pipe(place: Path, outside: Path) -> None:
    os.mkfifo(place)


def zeros(place: Path, outside: Path) -> None:
    place.symlink_to("/dev/zero")


def linked_folder(place: Path, outside: Path) -> None:
    place.parent.rmdir()
    (outside / place.name).write_bytes(PNG)
    place.parent.symlink_to(outside)


def large(place: Path, outside: Path) -> None:
    with place.open("wb") as file:
        file.truncate(10**12)


def no_picture(place: Path, outside: Path) -> None:
    place.write_bytes(SECRET)


PUT = [link, pipe, zeros, linked_folder, large]


@pytest.mark.parametrize("put", [*PUT, no_picture])
def test_a_report_shows_no_picture_but_the_episodes_own(folder: Path, put: Put) -> None:
    assert b"data:image/png" in write_report(folder).read_bytes()
    (folder / FRAME).unlink()
    put(folder / FRAME, folder.parent)
    page = write_report(folder).read_bytes()
    assert b"no picture: " in page
    for data in (PNG, SECRET):
        assert base64.b64encode(data) not in page


@pytest.mark.parametrize("put", PUT)
def test_a_look_is_played_back_from_the_episodes_own_pictures(folder: Path, put: Put) -> None:
    look = read_episode(folder)[1]
    assert isinstance(look, Observed)
    assert observation_from(look, folder).frames["front"].data == PNG
    (folder / FRAME).unlink()
    put(folder / FRAME, folder.parent)
    with pytest.raises(EpisodeError, match="picture of a look"):
        observation_from(look, folder)


@pytest.mark.parametrize(
    "name",
    ["/etc/passwd", "../secret", "frames/../../secret", "frames/a/b", "frames/..", "frames", "x"],
)
@pytest.mark.parametrize("key", ["file", "depth"])
def test_a_log_cannot_name_a_picture_elsewhere(folder: Path, name: str, key: str) -> None:
    log = folder / LOG
    lines = log.read_bytes().splitlines()
    look = json.loads(lines[1])
    look["frames"][0][key] = name
    log.write_bytes(lines[0] + b"\n" + json.dumps(look).encode() + b"\n")
    with pytest.raises(EpisodeError, match=r"episode\.jsonl:2: event 1 .*does not lie in frames/"):
        read_episode(folder)


@pytest.mark.parametrize("put", [link, pipe, zeros])
def test_a_log_is_a_plain_file(folder: Path, put: Put) -> None:
    (folder / LOG).unlink()
    put(folder / LOG, folder.parent)
    with pytest.raises(EpisodeError, match="is a link, a pipe or a device"):
        read_episode(folder)
    with pytest.raises(EpisodeError, match="is a link, a pipe or a device"):
        next(follow(folder, timeout=0.1))
    with pytest.raises(WriteError, match="is a link, a pipe or a device"):
        EpisodeWriter(folder)
    with pytest.raises(EpisodeError, match="is a link, a pipe or a device"):
        EpisodeWriter.going_on(folder)
    assert (folder.parent / "picture").read_bytes() == PNG


def test_a_planted_link_is_replaced_and_not_followed(folder: Path) -> None:
    secret = folder.parent / "secret"
    for name in ("report.html", "report.html.part", "frames/0001-front.part"):
        (folder / name).symlink_to(secret)
    (folder / "frames/0001-front.png").symlink_to(secret)
    write_report(folder)
    writer, _ = EpisodeWriter.going_on(folder)
    writer.save_frame(Frame("0001-front", "front", PNG, "image/png"))
    writer.close()
    assert secret.read_bytes() == SECRET
    for name in ("report.html", "frames/0001-front.png"):
        assert not (folder / name).is_symlink()


def test_pictures_are_not_written_into_a_linked_folder(folder: Path) -> None:
    (folder / FRAME).unlink()
    (folder / "frames").rmdir()
    (folder / "frames").symlink_to(folder.parent)
    before = sorted(folder.parent.iterdir())
    with pytest.raises(WriteError, match="frames/ is a link"):
        EpisodeWriter.going_on(folder)
    assert sorted(folder.parent.iterdir()) == before


def test_a_view_that_leads_elsewhere_is_no_file(folder: Path) -> None:
    writer, _ = EpisodeWriter.going_on(folder)
    for view in ("../x", "a/b", "/x"):
        with pytest.raises(ValueError, match="names a file"):
            writer.save_frame(Frame(f"0001-{view}", view, PNG, "image/png"))
    writer.close()


def test_a_device_or_a_pipe_is_not_replaced_by_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(WriteError, match="a pipe or a device"):
        write_whole(tmp_path / "pipe", b"", remedy="Name another")
    assert [path.name for path in tmp_path.iterdir()] == ["pipe"]


def test_an_event_that_no_reader_takes_is_not_written(folder: Path) -> None:
    writer, _ = EpisodeWriter.going_on(folder)
    before = (folder / LOG).read_bytes()
    detail = {"scan": "y" * 17_000_000}
    with pytest.raises(PluginError, match="an event has 16,777,216 at most"):
        writer.append(Observed(look=1, world_time=0.0, detail=detail))
    writer.append(Observed(look=1, world_time=0.0))
    writer.close()
    assert (folder / LOG).read_bytes().startswith(before)
    assert len(read_episode(folder)) == 3
