"""The episode on disk: `episode.jsonl`, one event a line, and the pictures in `frames/`."""

import fcntl
import json
import os
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

from pydantic import ValidationError

from tpvqa import __version__
from tpvqa.errors import EpisodeError
from tpvqa.events import EVENT, Event, Started
from tpvqa.events.events import SCHEMA
from tpvqa.events.records import depth_file
from tpvqa.observation import Frame

LOG = "episode.jsonl"
FRAMES = "frames"


class EpisodeWriter:
    """Appends events, each on disk before `append` returns.

    Args:
        folder: The episode's folder. It is made; it must not hold an episode already, unless
            `resume` is given.
        resume: Number of whole events that the folder's log holds; what follows them (a line
            torn by a kill) is cut off.
        time: Seconds that the episode had taken by then.
        durable: Whether to wait for the disk. Off only for experiments of many episodes.

    Raises:
        EpisodeError: The folder holds another episode, or cannot be written.
    """

    resumable = True

    def __init__(self, folder: Path, *, resume: int = 0, time: float = 0.0, durable: bool = True):
        self.folder, self._durable, self._count = Path(folder), durable, resume
        self._began = monotonic() - time
        path = self.folder / LOG
        try:
            if path.exists() and path.stat().st_size and not resume:
                raise EpisodeError(
                    f"{self.folder} holds an episode already; name another folder with --out, "
                    f"or go on with it: tpvqa resume {self.folder}"
                )
            (self.folder / FRAMES).mkdir(parents=True, exist_ok=True)
            self._file = path.open("ab")
            self._lock()
            if resume:
                lines = path.read_bytes().split(b"\n")
                whole = lines[:resume]
                self._nothing_new(lines[resume:-1])
                with path.open("r+b") as file:
                    file.truncate(sum(len(line) + 1 for line in whole))
        except OSError as error:
            raise EpisodeError(
                f"{self.folder}: cannot be written ({error.strerror}); name another folder "
                "with --out"
            ) from error

    def _lock(self) -> None:
        """Let no other writer at the log; the lock ends with this process, however it ends."""
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.close()
            raise EpisodeError(
                f"{self.folder} is still being written by another process, or by a writer that was "
                "not closed; wait for it or end it"
            ) from None

    def _nothing_new(self, more: list[bytes]) -> None:
        """Cut nothing off but an end by Ctrl-C; what else follows was written since."""
        if more and not (len(more) == 1 and b'"because":"cancelled"' in more[0]):
            self._file.close()
            raise EpisodeError(
                f"{self.folder} was written to by another process since it was read; try again"
            )

    def append(self, event: Event) -> Event:
        """Write an event; it is given its number and its time since the beginning."""
        event.stamp(self._count, monotonic() - self._began)
        self._file.write(EVENT.dump_json(event, exclude_none=True, by_alias=True) + b"\n")
        self._file.flush()
        if self._durable:
            os.fsync(self._file.fileno())
        self._count += 1
        return event

    def save_frame(self, frame: Frame) -> str:
        """Save a camera image, and its depth image; its path within the episode's folder."""
        name = f"{FRAMES}/{frame.id}{frame.suffix}"
        self._save(name, frame.data)
        if frame.depth is not None:
            self._save(depth_file(name, frame.depth), frame.depth.data)
        return name

    def _save(self, name: str, data: bytes) -> None:
        path = self.folder / name
        temporary = path.with_suffix(".part")
        with temporary.open("wb") as file:
            file.write(data)
            if self._durable:
                file.flush()
                os.fsync(file.fileno())
        temporary.replace(path)

    def close(self) -> None:
        """Close the log. Can be called twice."""
        self._file.close()


class MemoryWriter:
    """Keeps the events in memory: for experiments of many episodes, and for tests.

    Args:
        resumable: Whether the events hold the states of world and VLM.
        keep: Whether to keep them at all; listeners are told of them anyway.
    """

    def __init__(self, *, resumable: bool = True, keep: bool = True) -> None:
        self.resumable, self._keep = resumable, keep
        self.events: list[Event] = []
        self._began, self._count = monotonic(), 0

    def append(self, event: Event) -> Event:
        """Keep an event."""
        event.stamp(self._count, monotonic() - self._began)
        self._count += 1
        if self._keep:
            self.events.append(event)
        return event

    def save_frame(self, frame: Frame) -> str:
        """Keep nothing of the picture but its name."""
        return f"{FRAMES}/{frame.id}{frame.suffix}"

    def close(self) -> None:
        """Nothing to close."""


def _lines(path: Path) -> Iterator[tuple[int, bytes]]:
    try:
        data = path.read_bytes()
    except OSError as error:
        raise EpisodeError(
            f"{path.parent} holds no episode: {LOG} cannot be read ({error.strerror})"
        ) from error
    whole, _, _torn = data.rpartition(b"\n")
    return enumerate(whole.split(b"\n") if whole else [], 1)


def episode_folder(path: Path | str) -> Path:
    """The folder of an episode that is named by its folder, or by the `episode.jsonl` in it."""
    path = Path(path)
    return path.parent if path.name == LOG else path


def event_of(path: Path, number: int, line: bytes) -> Event:
    """The event that stands in a line of a log.

    Args:
        path: The log, as messages name it.
        number: Of the line, from 1.
        line: What stands there.

    Raises:
        EpisodeError: It is no event, or one of another version's.
    """
    try:
        return EVENT.validate_json(line)
    except ValidationError as error:
        if number == 1:
            _check_schema(path, line)
        problem = error.errors()[0]
        place = ".".join(map(str, problem["loc"]))
        raise EpisodeError(
            f"{path}:{number}: not an event of this version ({place}: {problem['msg']})"
        ) from error


def _check_schema(path: Path, line: bytes) -> None:
    """Say which version reads a log that this one does not.

    Raises:
        EpisodeError: It is a log of another version.
    """
    try:
        first = json.loads(line)
        if first.get("kind") != "started" or first.get("schema", 1) == SCHEMA:
            return
    except (ValueError, AttributeError):
        return
    version = first.get("version", "another version")
    raise EpisodeError(
        f"{path}: written by tpvqa {version} in another format (schema {first.get('schema', 1)}; "
        f"this is tpvqa {__version__}, which reads schema {SCHEMA}). tpvqa {version} reads it"
    )


def read_episode(folder: Path | str) -> list[Event]:
    """All whole events of an episode, also of one that was killed.

    Args:
        folder: The episode's folder, or its `episode.jsonl`.

    Raises:
        EpisodeError: There is no episode, or a line in its middle is damaged.
    """
    path = episode_folder(folder) / LOG
    events: list[Event] = []
    for number, line in _lines(path):
        events.append(event_of(path, number, line))
    if not events or not isinstance(events[0], Started):
        raise EpisodeError(f"{path}: the episode has no beginning; it was killed before it started")
    return events
