"""Tables of a bench as files: CSV and Parquet."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.summary import Summary
from tpvqa.errors import BenchError, MissingExtraError


def write_tables(
    folder: Path, found: Sequence[Summary], episodes: Sequence[EpisodeRow]
) -> list[Path]:
    """Write `summary` and `episodes`, each as CSV and Parquet; a file is written whole or not.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: The folder cannot be written to.
    """
    rows = [row.model_dump() for row in episodes]
    for row in rows:
        row["answers"], row["decisions"] = json.dumps(row["answers"]), json.dumps(row["decisions"])
    written = []
    for name, values in (("summary", [each.flat() for each in found]), ("episodes", rows)):
        written += _write(folder, name, values)
    return written


def _write(folder: Path, name: str, values: Sequence[Mapping[str, Any]]) -> list[Path]:
    try:
        import pyarrow as pa
        from pyarrow import csv, parquet
    except ImportError as error:
        raise MissingExtraError("pyarrow", "bench", "Tables of a bench") from error
    table = pa.Table.from_pylist(list(values))
    paths = [folder / f"{name}.csv", folder / f"{name}.parquet"]
    for path, write in zip(paths, (csv.write_csv, parquet.write_table), strict=True):
        temporary = path.with_name(path.name + ".part")
        try:
            write(table, temporary)
            temporary.replace(path)
        except OSError as error:
            raise BenchError(f"{path}: cannot be written ({error})") from error
    return paths
