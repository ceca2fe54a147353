"""What the belief bench writes: tables, targets and figures."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tpvqa.bench.figures import close, saved
from tpvqa.bench.folders import folder_within
from tpvqa.bench.ledger import REMEDY
from tpvqa.bench.summary import summarise
from tpvqa.bench.tables import write_table
from tpvqa.files import write_whole
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.figures import draw
from tpvqa_experiments.belief.lasting_tables import lasting_markdown, lasting_rows
from tpvqa_experiments.belief.lasting_targets import lasting_targets
from tpvqa_experiments.belief.markdown import results_markdown, targets_markdown
from tpvqa_experiments.belief.parts import Extent
from tpvqa_experiments.belief.results import BeliefResults
from tpvqa_experiments.belief.targets import targets

LASTING = "lasting.md"
"""The tables of errors that last, where any were run."""


def write_results(folder: Path, results: BeliefResults, extent: Extent) -> list[Check]:
    """Write everything that can be read of the results.

    Returns:
        The figures beside their targets.

    Raises:
        MissingExtraError: PyArrow or Matplotlib is not installed.
        WriteError: The folder cannot be written to.
    """
    write_table(folder, "summary", summary_rows(results))
    write_table(folder, "episodes", list(_episodes(results)))
    checks = targets(results, extent)
    _write(folder / "targets.json", json.dumps([each.flat() for each in checks], indent=1) + "\n")
    _write(folder / "targets.md", targets_markdown(checks))
    rows = lasting_rows(results, extent)
    if rows:
        lasting = list(lasting_targets(results, extent))
        _write(folder / LASTING, lasting_markdown(results, extent, lasting))
        _write(folder / "lasting.json", json.dumps(rows, indent=1) + "\n")
    _write(folder / "belief.md", results_markdown(results, extent))
    beside = folder_within(folder, "figures")
    for name, figure in draw(results, extent).items():
        for kind in ("svg", "png"):
            write_whole(beside / f"{name}.{kind}", saved(figure, kind), remedy=REMEDY)
        close(figure)
    return checks


def summary_rows(results: BeliefResults) -> list[dict[str, Any]]:
    """One row of plain values for every cell."""
    return [
        {"condition": cell.condition, **summarise(cell, rows, ()).flat()}
        for cell, rows in results.rows.items()
    ]


def _episodes(results: BeliefResults) -> Iterator[dict[str, Any]]:
    for rows in results.rows.values():
        for row in rows:
            values = row.model_dump()
            values["answers"] = json.dumps(row.answers)
            values["decisions"] = json.dumps(row.decisions)
            yield values


def _write(path: Path, text: str) -> None:
    write_whole(path, text.encode(), remedy=REMEDY)
