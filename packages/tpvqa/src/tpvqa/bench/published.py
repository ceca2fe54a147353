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

from tpvqa.bench.agreeing import Place, Placed
from tpvqa.bench.row import EpisodeRow, row_fault
from tpvqa.bench.told_object import told_object, told_texts
from tpvqa.errors import BenchError, MissingExtraError, cut
from tpvqa.files import read_plain, write_whole

LEFT_OUT = ("seconds", "answers", "decisions")
"""Fields that are not kept."""
_SETTINGS, _TASKS = b"tpvqa.bench", b"tpvqa.tasks"
_LARGEST = 256 * 2**20
"""Bytes of a file; half a million rows have five million."""
_UNPACKED, _MOST_ROWS, _LONGEST = 2 * 2**30, 5_000_000, 10_000
"""Bytes and rows that a file may say it has unpacked, bytes of one text."""
_PLAIN = {"BOOLEAN", "INT32", "INT64", "FLOAT", "DOUBLE", "BYTE_ARRAY"}
"""What the columns of rows are, as Parquet calls it."""


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
    """The same as `placed_rows`, without their places."""
    return (row for _, row in placed_rows(path, settings))


def placed_rows(path: Path, settings: Mapping[str, Any]) -> Iterator[Placed]:
    """Read the rows of a file, or of all Parquet files in a folder.

    Args:
        path: A file that `write_published` wrote, or a folder of them.
        settings: Those that the rows must have come about with.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: There are none, they are of another bench, or a file is damaged.
    """
    files = _files(path)
    if not files:
        raise BenchError(f"{path} holds no *.parquet. Name a file or a folder of published rows")
    for file in files:
        opened = _Opened(file)
        if opened.settings is None:
            raise BenchError(f"{file}: it does not say which bench its rows are of")
        other = differences(opened.settings, settings)
        if other:
            raise BenchError(f"{file} holds rows of a bench with other settings ({other})")
        yield from opened.rows()


def tasks_of(path: Path) -> dict[str, str]:
    """What the files of own tasks said that published rows were run with, by name.

    Args:
        path: A file that `write_published` wrote, or a folder of them.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: A file cannot be read.
    """
    found: dict[str, str] = {}
    for file in _files(path):
        found |= _Opened(file).tasks
    return found


def version_of(path: Path) -> str:
    """The version that ran published rows.

    Args:
        path: A file that `write_published` wrote, or a folder of them.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: There are none, or they do not say.
    """
    file = next(iter(_files(path)), None)
    settings = None if file is None else _Opened(file).settings
    if settings is None:
        raise BenchError(f"{path}: holds no published rows. Name a file or a folder of them")
    return str(settings.get("version"))


def _files(path: Path) -> list[Path]:
    return sorted(path.glob("*.parquet")) if path.is_dir() else [path]


class _Opened:
    """A file of published rows, which may be a stranger's.

    Attributes:
        settings: Of their bench; None where the file does not say.
        tasks: As of `write_published`.

    Raises:
        MissingExtraError: PyArrow is not installed.
        BenchError: It cannot be read, or is damaged.
    """

    def __init__(self, file: Path):
        self._file = file
        self._pa, parquet = _pyarrow()
        try:
            data = self._pa.BufferReader(read_plain(file, most=_LARGEST))
            self._table = self._within_bounds(parquet, data)
            told = self._table.schema_arrow.metadata or {}
        except (OSError, self._pa.ArrowException) as error:
            raise self._unread(error) from error
        try:
            self.settings = told_object(told[_SETTINGS]) if _SETTINGS in told else None
            self.tasks = told_texts(told.get(_TASKS, b"{}"))
        except ValueError as error:
            raise BenchError(
                f"{file}: damaged ({error}). Name another file of published rows"
            ) from None

    def _within_bounds(self, parquet: ModuleType, data: Any) -> Any:
        """The file, its texts as numbers into the list of those that there are: a few bytes of it
        could be as many copies of a long one as there are rows."""
        found = parquet.ParquetFile(data).metadata
        groups = (found.row_group(each) for each in range(found.num_row_groups))
        if found.num_rows > _MOST_ROWS or sum(e.total_byte_size for e in groups) > _UNPACKED:
            raise OSError(f"it has more than {_MOST_ROWS:,} rows, or {_UNPACKED >> 30} GiB of them")
        columns = [found.schema.column(each) for each in range(found.num_columns)]
        for each in columns:
            if each.max_repetition_level or each.physical_type not in _PLAIN:
                raise OSError(f"its column {cut(each.path)} holds no plain values")
        if len(columns) > len(EpisodeRow.model_fields):
            raise OSError(f"it has {len(columns):,} columns, more than rows have")
        texts = [each.path for each in columns if each.physical_type == "BYTE_ARRAY"]
        data.seek(0)
        return parquet.ParquetFile(data, read_dictionary=texts)

    def rows(self) -> Iterator[Placed]:
        """The rows, as they stand in it."""
        try:
            table = self._table.read()
            table.validate(full=True)  # texts are UTF-8
            for column in table.columns:
                if self._pa.types.is_dictionary(column.type):
                    self._see_short(column)
        except (OSError, self._pa.ArrowException) as error:
            raise self._unread(error) from error
        values = (each for batch in table.to_batches(10_000) for each in batch.to_pylist())
        for number, value in enumerate(values, 1):
            place = Place(self._file, number, published=True)
            try:
                yield place, EpisodeRow.model_validate(value)
            except ValidationError as error:
                raise BenchError(
                    f"{place}: not a row of this version ({row_fault(error)}). "
                    "Name another file of published rows"
                ) from None

    def _see_short(self, column: Any) -> None:
        from pyarrow import compute

        for chunk in column.chunks:
            longest = compute.max(compute.binary_length(chunk.dictionary)).as_py()
            if (longest or 0) > _LONGEST:
                raise OSError(f"it has a text of more than {_LONGEST:,} bytes")

    def _unread(self, error: Exception) -> BenchError:
        said = getattr(error, "strerror", None) or str(error) or type(error).__name__
        return BenchError(
            f"{self._file}: cannot be read ({said.splitlines()[0]}). Name a file of published rows"
        )


def differences(there: Mapping[str, Any], here: Mapping[str, Any]) -> str:
    """In which settings two benches differ, in words; empty where in none."""
    here = json.loads(json.dumps(dict(here)))
    return ", ".join(
        f"{cut(key)} {cut(repr(there.get(key)))} there, {cut(repr(here.get(key)))} here"
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
