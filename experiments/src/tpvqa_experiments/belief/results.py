"""What the belief bench has found, as its tables and figures ask for it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow


@dataclass(frozen=True)
class BeliefResults:
    """The episodes of the cells that were run.

    Attributes:
        settings: What decided them.
        rows: Episodes by cell.
        speed: What `benchmarks/belief.py` measured, in milliseconds; empty where it was not run.
    """

    settings: Mapping[str, Any]
    rows: Mapping[Cell, Sequence[EpisodeRow]]
    speed: Mapping[str, float] = field(default_factory=dict)

    def of(self, cell: Cell) -> Sequence[EpisodeRow]:
        """The episodes of a cell; none where it was not run."""
        return self.rows.get(cell, ())

    @property
    def errors(self) -> int:
        """Episodes that the program could not run to their end."""
        return sum(bool(row.error) for rows in self.rows.values() for row in rows)
