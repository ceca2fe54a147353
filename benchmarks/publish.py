"""Packs the finished rows of the belief bench, for others to check and to go on from.

python benchmarks/publish.py bench-belief --out docs/data/belief
tpvqa bench belief --rows docs/data/belief --only-tables --out bench-belief-again

Several folders, of machines that ran different parts with the same settings, become one.
"""

import argparse
import json
from pathlib import Path

from tpvqa.bench.belief import Part
from tpvqa.bench.belief.parts import Extent
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import SETTINGS, Ledger
from tpvqa.bench.published import write_published
from tpvqa.bench.row import EpisodeRow


def main() -> None:
    """Write one file for every part."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--parts", default=",".join(Part), help="with commas; default: all")
    given = parser.parse_args()
    settings = json.loads((given.folders[0] / SETTINGS).read_text(encoding="utf-8"))
    rows: dict[tuple[Cell, int], EpisodeRow] = {}
    for folder in given.folders:
        ledger = Ledger(folder, settings)
        rows |= ledger.rows
        ledger.close()
    extent, written = Extent(), set[Cell]()
    for part in Part:
        cells = {cell for cell, _ in extent.cells(part)} - written
        written |= cells
        own = [row for (cell, _), row in rows.items() if cell in cells]
        if part in given.parts.split(",") and own:
            path = given.out / f"{part}.parquet"
            count = write_published(own, settings, path)
            print(f"{path}: {count:,} rows, {path.stat().st_size / 1e6:.2f} MB")


if __name__ == "__main__":
    main()
