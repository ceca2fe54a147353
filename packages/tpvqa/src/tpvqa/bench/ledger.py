"""The episodes of a bench on disk: what is finished is never run again or lost."""

import fcntl
import json
import os
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from itertools import chain
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from tpvqa.bench.agreeing import Agreement, Place, Placed
from tpvqa.bench.cell import Cell
from tpvqa.bench.published import differences, placed_rows
from tpvqa.bench.row import EpisodeRow, row_fault
from tpvqa.bench.told_object import read_object
from tpvqa.episodes.log import LOG
from tpvqa.episodes.own_files import BENCH
from tpvqa.errors import BenchError, WriteError
from tpvqa.files import make_folder, open_plain, write_all, write_whole

ROWS, SETTINGS = BENCH
REMEDY = "Make room, and give the same command again: it goes on with what is finished"


class Ledger:
    """Appends rows of finished episodes, and knows those of earlier runs.

    Args:
        folder: Where a bench lies. It is made; a bench with other settings must not lie there.
        settings: What decides the figures: seed, rates of faults, limits, version.
        published: Rows of the same bench that count as finished, see `published`.

    Raises:
        BenchError: Another bench, or an episode, lies there, it is being written by another
            process, or it is damaged; rows contradict each other.
        WriteError: The folder cannot be written to.
    """

    def __init__(self, folder: Path, settings: Mapping[str, Any], published: Path | None = None):
        agreement = Agreement(settings.get("seed"))
        told = () if published is None else placed_rows(published, settings)
        others = list(agreement.checked(told))  # before anything is made
        self.folder = Path(folder)
        if (self.folder / LOG).exists():
            raise BenchError(f"{folder} holds an episode; name another folder with --out")
        try:
            make_folder(self.folder)
            flags = os.O_RDWR | os.O_APPEND | os.O_CREAT
            self._file = os.fdopen(open_plain(self.folder / ROWS, flags), "a+b", buffering=0)
        except OSError as error:
            raise WriteError.of(folder, error, "Name another folder with --out") from error
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self._file.close()
            raise BenchError(f"{folder}: another bench is at work there; wait for it") from None
        self._agree(dict(settings))
        self.rows = merged(chain(others, agreement.checked(self._read())))

    def _agree(self, settings: dict[str, Any]) -> None:
        path = self.folder / SETTINGS
        there = read_object(path)
        if there is not None:
            changed = differences(there, settings)
            if changed:
                raise BenchError(
                    f"{self.folder} holds a bench with other settings ({changed}). "
                    "Name another folder with --out"
                )
            return
        if os.fstat(self._file.fileno()).st_size:
            raise BenchError(
                f"{self.folder}: {ROWS} has rows, and {SETTINGS} is missing, which says how they "
                "came about. Put it back, or name another folder with --out"
            )
        write_whole(path, f"{json.dumps(settings, indent=1)}\n".encode(), remedy=REMEDY)

    def _read(self) -> Iterator[Placed]:
        self._file.seek(0)
        data = self._file.read()
        whole, _, torn = data.rpartition(b"\n")
        if torn:  # a kill in the middle of a line
            self._file.truncate(len(data) - len(torn))
        for number, line in enumerate(whole.split(b"\n") if whole else [], 1):
            place = Place(self.folder / ROWS, number)
            try:
                yield place, EpisodeRow.model_validate_json(line)
            except ValidationError as error:
                raise BenchError(
                    f"{place}: not a row of this version ({row_fault(error)}). "
                    "Remove the folder, or name another"
                ) from None

    def missing(self, cell: Cell, episodes: int) -> list[int]:
        """The numbers of a cell's episodes that are not finished; failed ones are tried again."""
        return [
            number
            for number in range(episodes)
            if (cell, number) not in self.rows or self.rows[cell, number].error
        ]

    def add(self, rows: Iterable[EpisodeRow]) -> None:
        """Write rows; they are on disk before this returns.

        Raises:
            WriteError: They cannot be written. What was written before is whole.
        """
        rows = list(rows)
        size = os.fstat(self._file.fileno()).st_size
        try:
            lines = (row.model_dump_json().encode() + b"\n" for row in rows)
            write_all(self._file.fileno(), b"".join(lines))
            os.fsync(self._file.fileno())
        except OSError as error:
            with suppress(OSError):
                self._file.truncate(size)
            raise WriteError.of(self.folder / ROWS, error, REMEDY) from error
        for row in rows:
            self.rows[row.cell, row.episode] = row

    def of(self, cell: Cell, episodes: int) -> list[EpisodeRow]:
        """The first so many episodes of a cell, in order."""
        found = (self.rows.get((cell, number)) for number in range(episodes))
        return [row for row in found if row is not None]

    def close(self) -> None:
        """Close the file. Can be called twice."""
        self._file.close()


def merged(rows: Iterable[EpisodeRow]) -> dict[tuple[Cell, int], EpisodeRow]:
    """Rows by cell and episode; the latest counts, but a failure never hides a finished episode."""
    found: dict[tuple[Cell, int], EpisodeRow] = {}
    for row in rows:
        key = row.cell, row.episode
        if not row.error or key not in found or found[key].error:
            found[key] = row
    return found
