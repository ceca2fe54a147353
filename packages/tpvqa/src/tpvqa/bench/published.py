"""Rows of a bench in one small file, for others to check its tables and to go on from.

A row of `episodes.jsonl` says how often each answer was given, and how long it took; that is most
of it, and no table of completion and questions needs it. Without, a row takes five to ten bytes.
"""

import json
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import ValidationError

from tpvqa.bench.row import EpisodeRow
from tpvqa.errors import BenchError, MissingExtraError
from tpvqa.files import write_whole
from tpvqa.told import first_fault

LEFT_OUT = ("seconds", "answers", "decisions")
"""Fields that are not kept."""
_SETTINGS, _TASKS = b"tpvqa.bench", b"tpvqa.tasks"


def write_published(
    rows: Iterable[EpisodeRow],
    settings: Mapping[str, Any],
    path: Path,
    tasks: Mapping[str, str] | None = None,
) -> int:
    """Write finished rows, whole or not at all; those of failed episodes are left out.

    Args:
        rows: Of any cells.
        settings: Of their bench.
        path: A Parquet file.
        tasks: What the files of own tasks say, as `OwnTask.fingerprint`, by name.

    Returns:
        How many rows it holds.

    Raises:
        MissingExtraError: PyArrow is not installed.
        WriteError: It cannot be written.
    """
    pa, parquet = _pyarrow()
    names = [name for name in EpisodeRow.model_fields if name not in LEFT_OUT]
    ordered = sorted(
        (row for row in rows if not row.error),
        key=lambda row: (row.vlm, row.condition, row.task, row.monitor, row.episode),
    )
    columns = {}
    for name in names:
        values = [getattr(row, name) for row in ordered]
        kind = EpisodeRow.model_fields[name].annotation
        if kind is str:
            columns[name] = pa.array(values, pa.string()).dictionary_encode()
        elif kind is int:
            columns[name] = pa.array(values, pa.int64())
        else:
            columns[name] = pa.array(values)
    told = {_SETTINGS: json.dumps(dict(settings)), _TASKS: json.dumps(dict(tasks or {}))}
    table = pa.table(columns).replace_schema_metadata(told)
    data = pa.BufferOutputStream()
    parquet.write_table(table, data, compression="zstd", compression_level=19)
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, data.getvalue().to_pybytes(), remedy="Name another file")
    return len(ordered)


def read_published(path: Path, settings: Mapping[str, Any]) -> Iterator[EpisodeRow]:
    """Read the rows of a file, or of all Parquet files in a folder.

    Args:
        path: A file that `write_published` wrote, or a folder of them.
        settings: Those that the rows must have come about with.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: There are none, they are of another bench, or a file is damaged.
    """
    pa, parquet = _pyarrow()
    files = sorted(path.glob("*.parquet")) if path.is_dir() else [path]
    if not files:
        raise BenchError(f"{path} holds no *.parquet. Name a file or a folder of published rows")
    for file in files:
        try:
            table = parquet.read_table(file)
        except (OSError, pa.ArrowException) as error:
            raise BenchError(
                f"{file}: cannot be read ({str(error).splitlines()[0]}). Name a file of published "
                "rows"
            ) from error
        told = (table.schema.metadata or {}).get(_SETTINGS)
        if told is None:
            raise BenchError(f"{file}: it does not say which bench its rows are of")
        other = differences(json.loads(told), settings)
        if other:
            raise BenchError(f"{file} holds rows of a bench with other settings ({other})")
        try:
            for batch in table.to_batches(10_000):
                yield from map(EpisodeRow.model_validate, batch.to_pylist())
        except ValidationError as error:
            raise BenchError(
                f"{file}: not rows of this version ({first_fault(error)['msg']})"
            ) from None


def tasks_of(path: Path) -> dict[str, str]:
    """What the files of own tasks said that published rows were run with, by name.

    Args:
        path: A file that `write_published` wrote, or a folder of them.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: A file cannot be read.
    """
    found: dict[str, str] = {}
    for file in sorted(path.glob("*.parquet")) if path.is_dir() else [path]:
        found |= json.loads(_told(file).get(_TASKS, b"{}"))
    return found


def version_of(path: Path) -> str:
    """The version that ran published rows.

    Args:
        path: A file that `write_published` wrote, or a folder of them.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: There are none, or they do not say.
    """
    file = next(iter(sorted(path.glob("*.parquet"))), None) if path.is_dir() else path
    told = _told(file).get(_SETTINGS) if file else None
    if told is None:
        raise BenchError(f"{path}: holds no published rows. Name a file or a folder of them")
    return str(json.loads(told).get("version"))


def _told(file: Path) -> Mapping[bytes, bytes]:
    pa, parquet = _pyarrow()
    try:
        return parquet.read_schema(file).metadata or {}
    except (OSError, pa.ArrowException) as error:
        raise BenchError(f"{file}: cannot be read ({str(error).splitlines()[0]})") from error


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """In which settings two benches differ, in words; empty where in none."""
    here = json.loads(json.dumps(dict(here)))
    return ", ".join(
        f"{key} {there.get(key)!r} there, {here.get(key)!r} here"
        for key in sorted({*there, *here})
        if there.get(key) != here.get(key)
    )


def _pyarrow() -> tuple[ModuleType, ModuleType]:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise MissingExtraError("pyarrow", "bench", "Published rows") from error
    return pyarrow, parquet
