"""The log of an episode, `episode.jsonl`, read back: one event a line."""

import errno
import json
import os
from collections.abc import Iterator
from pathlib import Path

from pydantic import ValidationError

from tpvqa import __version__
from tpvqa.episodes.shape import LogShape
from tpvqa.errors import EpisodeError, pasted
from tpvqa.events import EVENT, Event
from tpvqa.events.events import SCHEMA
from tpvqa.files import opened_plain
from tpvqa.told import check_json, first_fault
from tpvqa.told.strict_json import LONGEST

LOG = "episode.jsonl"
LARGEST = 2**28
"""Bytes of a log at most."""


class LogReader:
    """Reads one line after the other, and sees that the events hang together.

    Args:
        path: The log, as messages name it.
    """

    def __init__(self, path: Path):
        self._path, self._shape, self._number = path, LogShape(), 0

    def event(self, line: bytes) -> Event:
        """The event that stands in the next line.

        Raises:
            EpisodeError: It is no event, one of another version's, or one that cannot stand here.
        """
        self._number += 1
        place = f"{self._path}:{self._number}"
        try:
            check_json(line)
            event = EVENT.validate_json(line, strict=True)
        except ValidationError as error:
            if self._number == 1:
                _check_schema(self._path, line)
            problem = first_fault(error)
            where = ".".join(map(str, problem["loc"]))[:200]
            raise EpisodeError(
                f"{place}: not an event of this version ({where}: {problem['msg'][:300]}). "
                f"{self._remedy}"
            ) from error
        except ValueError as error:
            raise EpisodeError(f"{place}: damaged: {error}. {self._remedy}") from error
        try:
            self._shape.take(event)
        except EpisodeError as error:
            raise EpisodeError(
                f"{place}: event {event.number} does not fit: {error}. {self._remedy}"
            ) from None
        return event

    @property
    def _remedy(self) -> str:
        if self._number == 1:
            return "Where that cannot be mended, leave it out, or run it anew"
        return (
            f"Leave the episode out, or keep only the {self._number - 1} lines before this one in "
            "a copy of its folder: of them it can be shown, and gone on with"
        )


def whole_lines(descriptor: int) -> Iterator[bytes]:
    """The lines of a log that are whole, without their ends; a torn last one is left out.

    Raises:
        OSError: It cannot be read, or is too large.
    """
    if os.fstat(descriptor).st_size > LARGEST:
        raise OSError(errno.EFBIG, f"it has more than {LARGEST:,} bytes")
    os.lseek(descriptor, 0, os.SEEK_SET)
    with open(descriptor, "rb", closefd=False) as file:
        while line := file.readline(LONGEST + 2):
            if line.endswith(b"\n"):
                yield line[:-1]
            elif len(line) > LONGEST:
                yield line  # too long; whoever reads it says so
                return


def episode_folder(path: Path | str) -> Path:
    """The folder of an episode that is named by its folder, or by the `episode.jsonl` in it."""
    path = Path(path)
    return path.parent if path.name == LOG else path


def read_episode(folder: Path | str) -> list[Event]:
    """All whole events of an episode, also of one that was killed.

    Args:
        folder: The episode's folder, or its `episode.jsonl`.

    Raises:
        EpisodeError: There is no episode, a line is damaged, or its events do not hang together.
    """
    path = episode_folder(folder) / LOG
    try:
        with opened_plain(path) as descriptor:
            return events_in(path, descriptor)
    except OSError as error:
        raise no_episode(path.parent, error) from error


def no_episode(folder: Path, error: OSError) -> EpisodeError:
    """The error of a folder without a log, or of what is no folder."""
    if folder.exists() and not folder.is_dir():
        return EpisodeError(f"{folder} is no episode: a folder with {LOG} in it is expected")
    return EpisodeError(f"{folder} holds no episode: {LOG} cannot be read ({error.strerror})")


def events_in(path: Path, descriptor: int) -> list[Event]:
    """All whole events of an open log.

    Args:
        path: The log, as messages name it.
        descriptor: Of the log.

    Raises:
        EpisodeError: As for `read_episode`.
        OSError: It cannot be read.
    """
    reader = LogReader(path)
    events = [reader.event(line) for line in whole_lines(descriptor)]
    if not events:
        raise EpisodeError(
            f"{path}: the episode has no beginning; it was killed before it started, and nothing "
            f"is lost. Begin it anew in the same folder: tpvqa run … --out {pasted(path.parent)}"
        )
    return events


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
    version = str(first.get("version", "another version"))[:40]
    schema = str(first.get("schema", 1))[:40]
    remedy = f"tpvqa {version} reads it"
    if version == __version__:
        remedy = "It was edited, or written by a version under development"
    raise EpisodeError(
        f"{path}: written by tpvqa {version} in another format (schema {schema}; "
        f"this is tpvqa {__version__}, which reads schema {SCHEMA}). {remedy}"
    )
