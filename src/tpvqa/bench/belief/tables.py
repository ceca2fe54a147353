"""Tables of the belief bench as files."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tpvqa.bench.belief.results import BeliefResults
from tpvqa.bench.summary import summarise
from tpvqa.bench.tables import write_table


def write_results(folder: Path, results: BeliefResults) -> None:
    """Write everything that can be read of the results.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: The folder cannot be written to.
    """
    write_table(folder, "summary", summary_rows(results))
    write_table(folder, "episodes", list(_episodes(results)))


def summary_rows(results: BeliefResults) -> list[dict[str, Any]]:
    """One row of plain values for every cell."""
    return [
        {"condition": cell.condition, **summarise(cell, rows, ()).flat()}
        for cell, rows in results.rows.items()
        if rows
    ]


def _episodes(results: BeliefResults) -> Iterator[dict[str, Any]]:
    for rows in results.rows.values():
        for row in rows:
            values = row.model_dump()
            values["answers"] = json.dumps(row.answers)
            values["decisions"] = json.dumps(row.decisions)
            yield values
