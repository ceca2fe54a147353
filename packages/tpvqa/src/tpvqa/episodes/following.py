"""Reading a log while it grows, at no cost to whoever writes it."""

import os
import time
from collections.abc import Iterator
from pathlib import Path

from tpvqa.episodes.log import LOG, LogReader, episode_folder
from tpvqa.errors import EpisodeError
from tpvqa.events import Ended, Event
from tpvqa.files import opened_plain
from tpvqa.told.strict_json import LONGEST

POLL = 0.1
"""Seconds between two looks at the file."""


def follow(
    folder: Path | str, *, start: int = 0, poll: float = POLL, timeout: float | None = None
) -> Iterator[Event]:
    """The events of an episode as they are written, up to its end.

    Any number of readers can follow one log, each from where it likes. An episode that was ended
    by Ctrl-C and is gone on with is followed again from its event of that number.

    Args:
        folder: The episode's folder, or its `episode.jsonl`. It may not be there yet.
        start: Number of the first event that is wanted.
        poll: Seconds between two looks at the file.
        timeout: Seconds without an event after which to give up; None for never.

    Raises:
        EpisodeError: A line is damaged or does not fit, or nothing came in time.
    """
    path = episode_folder(folder) / LOG
    position, number, quiet = 0, 0, time.monotonic()
    reader = LogReader(path)
    while True:
        lines, position, cut = _lines_after(path, position)
        if cut:  # it was gone on with: what ended it before is cut off
            number, reader = 0, LogReader(path)
        for line in lines:
            event = reader.event(line)
            number += 1
            if number > start:
                start = number
                yield event
            if isinstance(event, Ended):
                return
            quiet = time.monotonic()
        if not lines:
            if timeout is not None and time.monotonic() - quiet > timeout:
                raise EpisodeError(f"{path}: no further event within {timeout:g} s")
            time.sleep(poll)


def _lines_after(path: Path, position: int) -> tuple[list[bytes], int, bool]:
    """The whole lines after a position, and the position after them; from the beginning, where the
    file is shorter by now."""
    try:
        with opened_plain(path) as descriptor:
            cut = os.fstat(descriptor).st_size < position
            position = 0 if cut else position
            data = os.pread(descriptor, LONGEST + 1, position)
    except FileNotFoundError:
        return [], position, False
    except OSError as error:
        raise EpisodeError(f"{path}: cannot be read ({error.strerror})") from error
    whole, newline, rest = data.rpartition(b"\n")
    if not newline and len(rest) > LONGEST:
        raise EpisodeError(f"{path}: a line is longer than {LONGEST:,} bytes; it is no episode")
    lines = whole.split(b"\n") if newline else []
    return lines, position + len(whole) + len(newline), cut
