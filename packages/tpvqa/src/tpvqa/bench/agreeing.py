"""Rows of one bench from several files: none is of another seed, and none contradicts another."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.errors import BenchError


@dataclass(frozen=True, slots=True)
class Place:
    """Where a row stands.

    Attributes:
        file: The file.
        number: Of its line, or of the row in a file of published ones; from 1.
        published: Whether it is such a file.
    """

    file: Path
    number: int
    published: bool = False

    def __str__(self) -> str:
        return f"{self.file}, row {self.number}" if self.published else f"{self.file}:{self.number}"


Placed = tuple[Place, EpisodeRow]


class Agreement:
    """Sees rows, and remembers those of finished episodes, with which later ones have to agree.

    Args:
        seed: That of the bench; None where any will do.
    """

    def __init__(self, seed: int | None):
        self._seed = seed
        self._finished: dict[tuple[Cell, int], Placed] = {}

    def checked(self, rows: Iterable[Placed]) -> Iterator[EpisodeRow]:
        """The same rows, each as soon as it is seen to be right.

        Raises:
            BenchError: One is of another seed, or says something else than another of its episode.
        """
        for place, row in rows:
            if self._seed is not None and row.seed != self._seed:
                remedy = "Name others with --rows" if place.published else "Remove the line"
                raise BenchError(
                    f"{place}: is of the seed {row.seed}, and the bench of {self._seed}. "
                    f"{remedy}, or name another folder"
                )
            if not row.error:
                before, other = self._finished.setdefault((row.cell, row.episode), (place, row))
                if not _agree_on(row, other, partly=place.published or before.published):
                    raise _contradiction(place, before, row)
            yield row


def _agree_on(one: EpisodeRow, other: EpisodeRow, *, partly: bool) -> bool:
    """Whether two rows of an episode say the same of it; run twice, it takes other times.

    Those of published rows leave fields out, and earlier versions had fewer (`partly`).
    """
    if not partly:
        return one.model_copy(update={"seconds": other.seconds}) == other
    both = (one.model_fields_set & other.model_fields_set) - {"seconds"}
    return all(getattr(one, name) == getattr(other, name) for name in both)


def _contradiction(place: Place, before: Place, row: EpisodeRow) -> BenchError:
    there = str(before)
    if not place.published and place.file == before.file:
        there = f"line {before.number}"
    remedy = "Remove the line that is wrong, or name another folder"
    if place.published or before.published:
        remedy = "Name others with --rows, or another folder"
    return BenchError(
        f"{place}: says something else than {there} of the same episode ({row.task}, "
        f"{row.monitor}, {row.vlm}, number {row.episode}). {remedy}"
    )
