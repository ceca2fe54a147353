"""Tables of a bench as files: CSV and Parquet."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from tpvqa.bench.ledger import REMEDY
from tpvqa.bench.limits import sensitivity
from tpvqa.bench.report import Group, Results
from tpvqa.errors import MissingExtraError
from tpvqa.files import write_whole
from tpvqa.spelling import plain_row


def write_tables(folder: Path, results: Results) -> list[Path]:
    """Write every table as CSV and Parquet; a file is written whole or not.

    `summary` (a row for every task and monitor), `episodes`, `answers` (how right they were),
    `decisions`, `limits` (completion under tighter ones) and `curve` (completion by accuracy).

    Raises:
        MissingExtraError: PyArrow is not installed.
        WriteError: The folder cannot be written to.
    """
    tables = {
        "summary": [each.flat() for each in results.summaries],
        "episodes": list(_episodes(results)),
        "answers": list(_answers(results)),
        "decisions": [
            {**_of(group), "task": task, "monitor": monitor, **asdict(each)}
            for group in results.groups
            for task, monitor, each in results.decision_lines(group)
        ],
        "limits": list(_limits(results)),
        "curve": [
            {
                "task": task,
                "monitor": monitor,
                "accuracy": accuracy,
                "completion_rate": each.rate,
                "ci_low": each.low,
                "ci_high": each.high,
            }
            for task, by_monitor in results.curves.items()
            for monitor, curve in by_monitor.items()
            for accuracy, each in curve.items()
        ],
    }
    return [
        path for name, rows in tables.items() if rows for path in write_table(folder, name, rows)
    ]


def _episodes(results: Results) -> Iterator[dict[str, Any]]:
    for rows in results.rows.values():
        for row in rows:
            values = row.model_dump()
            values["answers"] = json.dumps(row.answers)
            values["decisions"] = json.dumps(row.decisions)
            yield values


def _answers(results: Results) -> Iterator[dict[str, Any]]:
    for group in results.groups:
        for line in results.lines(group):
            yield {
                **_of(group),
                "task": line.task,
                "asked": line.way,
                "on": line.source,
                "decision_accuracy": line.decision_accuracy,
                "paper": line.paper,
                **asdict(line.metrics),
            }


def _of(group: Group) -> dict[str, str]:
    return {"vlm": group.vlm, "world": group.world, "condition": group.condition}


def _limits(results: Results) -> Iterator[dict[str, Any]]:
    for cell, rows in results.rows.items():
        for name, points in (sensitivity(rows) if rows else {}).items():
            for limit, rate in points.items():
                yield {**asdict(cell), "limit_of": name, "limit": limit, "completion_rate": rate}


def write_table(folder: Path, name: str, values: Sequence[Mapping[str, Any]]) -> list[Path]:
    """Write one table as CSV and Parquet; texts of the CSV as `plain_row` has them.

    Raises:
        MissingExtraError: PyArrow is not installed.
        WriteError: The folder cannot be written to.
    """
    try:
        import pyarrow as pa
        from pyarrow import csv, parquet
    except ImportError as error:
        raise MissingExtraError("pyarrow", "bench", "Tables of a bench") from error
    forms = (
        (csv.write_csv, "csv", [plain_row(row) for row in values]),
        (parquet.write_table, "parquet", list(values)),
    )
    paths = []
    for write, ending, rows in forms:
        data = pa.BufferOutputStream()
        write(pa.Table.from_pylist(rows), data)
        path = folder / f"{name}.{ending}"
        paths.append(path)
        write_whole(path, data.getvalue().to_pybytes(), remedy=REMEDY)
    return paths
