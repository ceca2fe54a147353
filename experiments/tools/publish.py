"""Packs the finished rows of a bench, for others to check and to go on from.

python experiments/tools/publish.py bench-belief --out experiments/rows/belief
tpvqa bench belief --rows experiments/rows/belief --only-tables --out bench-belief-again
python experiments/tools/publish.py bench-abroad --whole abroad --out experiments/rows/abroad

Several folders, of machines that ran different parts with the same settings, become one; what is
published already stays. Those of the belief bench become a file for every part; with `--whole`
those of any bench one file. Their calibrations are published beside them, for a bench that goes on.
"""

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import TASKS
from tpvqa.bench.ledger import ROWS, SETTINGS, Ledger, merged
from tpvqa.bench.published import read_published, tasks_of, write_published
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.told_object import read_object
from tpvqa.errors import BenchError, TpvqaError
from tpvqa_experiments.belief import Part
from tpvqa_experiments.belief.calibrations import CALIBRATIONS
from tpvqa_experiments.belief.parts import Extent


def main() -> None:
    """Write one file for every part, or one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--parts", help="with commas; default: all")
    parser.add_argument("--whole", metavar="NAME", help="all rows in one file of this name")
    given = parser.parse_args()
    parts = [Part(name) for name in given.parts.split(",")] if given.parts else list(Part)
    settings = _settings(given.folders)
    rows = merged(_all(given.folders, settings, given.out))
    _keep_calibrations(given.folders, given.out / CALIBRATIONS)
    if given.whole:
        if given.parts:
            parser.error("--whole packs all parts; leave --parts out")
        path = given.out / f"{given.whole}.parquet"
        _write(list(rows.values()), settings, path, _tasks(given.folders, path))
        return
    extent, written = Extent(), set[Cell]()
    for part in Part:
        cells = {cell for cell, _ in extent.cells(part)} - written
        written |= cells
        own = [row for (cell, _), row in rows.items() if cell in cells]
        if part in parts and own:
            _write(own, settings, given.out / f"{part}.parquet")
    left = sum(cell not in written for cell, _ in rows)
    if left:
        print(f"{left:,} rows are of no cell of the bench's defaults, and were left out")


def _write(
    rows: Sequence[EpisodeRow],
    settings: Mapping[str, Any],
    path: Path,
    tasks: Mapping[str, str] | None = None,
) -> None:
    count = write_published(rows, settings, path, tasks)
    print(f"{path}: {count:,} rows, {path.stat().st_size / 1e6:.2f} MB")


def _tasks(folders: Sequence[Path], published: Path) -> dict[str, str]:
    found = tasks_of(published) if published.exists() else {}
    for folder in folders:
        here = read_object(folder / TASKS) or {}
        for name in found.keys() & here.keys():
            if found[name] != here[name]:
                raise BenchError(
                    f"{folder}: the files of {name!r} say something else than elsewhere"
                )
        found |= here
    return found


def _settings(folders: Sequence[Path]) -> dict[str, Any]:
    found = [read_object(folder / SETTINGS) for folder in folders]
    for folder, settings in zip(folders, found, strict=True):
        if settings is None or not (folder / ROWS).is_file():
            raise BenchError(f"{folder} holds no bench. Name one that a `tpvqa bench` has filled")
    return found[0] or {}


def _all(folders: Sequence[Path], settings: Mapping[str, Any], out: Path) -> Iterator[EpisodeRow]:
    if out.is_dir() and any(out.glob("*.parquet")):
        yield from read_published(out, settings)
    for folder in folders:
        ledger = Ledger(folder, settings)
        yield from ledger.rows.values()
        ledger.close()


def _keep_calibrations(folders: Sequence[Path], out: Path) -> None:
    kept = dict[Path, Calibration]()
    for path in (each for folder in folders for each in (folder / CALIBRATIONS).glob("*.json")):
        told, there = Calibration.load(path), out / path.name
        if there not in kept and there.exists():
            kept[there] = Calibration.load(there)
        if kept.setdefault(there, told) != told:
            raise BenchError(f"{path} says something else than another of this name, see {there}")
    for there, told in kept.items():
        told.save(there)


if __name__ == "__main__":
    try:
        main()
    except (TpvqaError, ValueError) as error:
        sys.exit(f"error: {error}")
