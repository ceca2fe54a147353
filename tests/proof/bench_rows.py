"""Runs published trials of the benches again: `python -m tests.proof.bench_rows`.

Takes some rows of every part (`experiments/rows/belief/*.parquet`, and `paper_rows.json` of the
paper's bench), runs exactly these trials, and compares every column but the seconds. Calibrations
are learnt as the bench learns them, and kept in a folder; an empty one proves the learning, too.
`--record` writes `paper_rows.json`; it holds what trials came to before something was changed.

The belief's rows are of version 0.2: since then TPVQA, its votes and PaLMEVQA decide otherwise, on
purpose.

Where facts that exclude each other are believed (without consistency, without a model), the plan
depends on what was planned before in the same process: the planner's worker keeps what it has
grounded for such states. Of many rows of the ablations one in a hundred can differ for that alone.
"""

import argparse
import json
import re
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import zip_longest
from pathlib import Path
from typing import Any

PAPER_ROWS = Path(__file__).parent / "paper_rows.json"
PAPER_PART = "paper-bench"
PAPER_CELLS = (
    ("serve_breakfast", "tpvqa", "embedded"),
    ("eat_apple", "palmevqa", "embedded"),
    ("eat_apple", "effectvqa", "oracle:0.8"),
    ("clean_dishes", "successvqa", "oracle:0.8"),
    ("serve_breakfast", "tpvqa", "recorded:gemma-3-12b:fresh"),
)
"""Task, monitor and VLM of cells of the paper's bench."""
PAPER_EPISODES = 4
CELL = ("task", "monitor", "vlm", "world", "condition")
"""The columns that name a cell."""
UNEQUAL = ("seconds",)
"""Columns that differ from run to run."""
SHOWN = 5
"""Different rows of a part that are shown."""

Row = Mapping[str, Any]
Cell = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Part:
    """Rows that were run with the same settings.

    Attributes:
        name: What it is called.
        settings: What decided them, as their bench tells it.
        rows: Every row.
    """

    name: str
    settings: Mapping[str, Any]
    rows: Sequence[Row]


def run_again(
    cell: Cell, episodes: Sequence[int], settings: Mapping[str, Any], cache: Path
) -> list[Row]:
    """Run episodes of a cell as its bench does. Only this and `paper_part` know how that is done.

    Args:
        cell: By the columns of `CELL`.
        episodes: Their numbers; of a chain all from its beginning.
        settings: Of the bench.
        cache: Where calibrations are kept.
    """
    from tpvqa.bench import cell as cells
    from tpvqa.bench.stage import run_each
    from tpvqa.config import Limits, SimulationConfig, TrialConfig
    from tpvqa_experiments.belief.calibrations import by_replies, calibrations, source_of
    from tpvqa_experiments.belief.parts import believes

    which = cells.Cell(*cell)
    common = TrialConfig(
        seed=settings["seed"],
        simulation=SimulationConfig(
            failure=settings["failure"],
            disturbance=settings["disturbance"],
            spontaneous=settings["spontaneous"],
        ),
        limits=Limits(
            repeats=settings["limit of repeats"],
            replans=settings["limit of replans"],
            actions=settings["limit of actions"],
        ),
    )
    learnt_from = settings.get("trials of a calibration")  # the paper's bench learns none
    told = None
    if learnt_from is not None and believes(which.monitor):
        source = source_of(which, settings["the embedded network is calibrated in"])
        known = calibrations(cache, [source], common, learnt_from)[source]
        told = by_replies(known) if which.believed else known
    rows = run_each(which, common, tuple(episodes), told)
    return [row.model_dump() for row in rows]


def paper_part() -> Part:
    """Rows of the paper's bench with its defaults, run now."""
    from tpvqa_experiments.paper import PaperBench

    bench = PaperBench(vlms=tuple(dict.fromkeys(vlm for *_, vlm in PAPER_CELLS)))
    worlds = {(each.task, each.monitor, each.vlm): each.world for each in bench.cells()}
    rows: list[Row] = []
    for cell in PAPER_CELLS:
        rows += run_again(
            (*cell, worlds[cell], ""), range(PAPER_EPISODES), bench.settings(), Path()
        )
    kept = [{name: row[name] for name in row if name not in UNEQUAL} for row in rows]
    return Part(PAPER_PART, bench.settings(), kept)


def published(folder: Path) -> Iterator[Part]:
    """The parts of the belief bench that were published, and the recorded one of the paper's."""
    from pyarrow import parquet

    for file in sorted(folder.glob("*.parquet")):
        table = parquet.read_table(file)
        settings = json.loads(table.schema.metadata[b"tpvqa.bench"])
        yield Part(file.stem, settings, table.to_pylist())
    if PAPER_ROWS.exists():
        there = json.loads(PAPER_ROWS.read_text(encoding="utf-8"))
        yield Part(PAPER_PART, there["settings"], there["rows"])


def chosen(rows: Sequence[Row], count: int, cells: int) -> dict[Cell, list[Row]]:
    """Some rows from a few cells that are as different as can be; always the same.

    Where there are cells of the belief monitor and of others, two of five are of the former: each
    takes a calibration. Rows of a cell that passes on what was learned are of one chain.
    """
    by_cell: dict[Cell, list[Row]] = defaultdict(list)
    for row in rows:
        by_cell[tuple(row[name] for name in CELL)].append(row)
    believing = {cell for cell in by_cell if cell[1].partition(":")[0] == "belief"}
    others = set(by_cell) - believing
    of_belief = min(len(believing), max(2 * cells // 5, cells - len(others)))
    picked = _different(believing, of_belief)
    picked += _different(others, cells - of_belief, picked)
    found = {}
    for place, cell in enumerate(picked):
        share = (place + 1) * count // len(picked) - place * count // len(picked)
        found[cell] = _of_every_ending(_hardest_chain(by_cell[cell], chain(cell)), share)
    return found


def _different(cells: Collection[Cell], count: int, besides: Sequence[Cell] = ()) -> list[Cell]:
    """Cells that share as few columns as can be, with each other and with others."""
    left, picked = sorted(cells, key=_drawn), list(besides)
    for _ in range(min(count, len(left))):
        met = Counter(column for cell in picked for column in enumerate(cell))
        best = min(left, key=lambda cell: sum(met[column] for column in enumerate(cell)))
        left.remove(best)
        picked.append(best)
    return picked[len(besides) :]


def _of_every_ending(rows: Sequence[Row], count: int) -> list[Row]:
    """One row of each ending, then another of each, and so on."""
    by_ending: dict[str, list[Row]] = defaultdict(list)
    for row in sorted(rows, key=lambda row: _drawn(row["episode"])):
        by_ending[f"{row['because']} {row['completed']}"].append(row)
    turns = zip_longest(*(by_ending[ending] for ending in sorted(by_ending)))
    found = [row for turn in turns for row in turn if row is not None][:count]
    return sorted(found, key=lambda row: int(row["episode"]))


def _drawn(thing: object) -> str:
    """Puts things in an order that has nothing to do with what they are called."""
    return sha256(repr(thing).encode()).hexdigest()


def _hardest_chain(rows: Sequence[Row], size: int) -> Sequence[Row]:
    """The first chain of those in which most episodes failed; all rows where there are none."""
    if not size:
        return rows
    chains: dict[int, list[Row]] = defaultdict(list)
    for row in sorted(rows, key=lambda row: int(row["episode"])):
        chains[row["episode"] // size].append(row)
    return min(chains.values(), key=lambda own: sum(row["completed"] for row in own))


def chain(cell: Cell) -> int:
    """Through how many episodes a cell passes on what was learned; 0 for none."""
    found = re.search(r"carried=(\d+)", cell[-1])
    return int(found[1]) if found else 0


def compared(part: Part, count: int, cells: int, cache: Path) -> list[tuple[Row, list[str]]]:
    """Run chosen rows of a part again; each with the columns in which it differs, in words."""
    found = []
    for cell, rows in chosen(part.rows, count, cells).items():
        numbers = [int(row["episode"]) for row in rows]
        size = chain(cell)
        if size:  # what was learned before them counts
            numbers = list(range(min(numbers) // size * size, max(numbers) + 1))
        again = {row["episode"]: row for row in run_again(cell, numbers, part.settings, cache)}
        found += [(row, differences(row, again[row["episode"]])) for row in rows]
    return found


def differences(there: Row, here: Row) -> list[str]:
    """Which columns of a row differ now, in words."""
    return [
        f"{name} {there[name]!r} there, {here.get(name, 'none')!r} here"
        for name in there
        if name not in UNEQUAL and there[name] != here.get(name, ...)
    ]


def _report(part: Part, results: Sequence[tuple[Row, list[str]]], seconds: float) -> int:
    """Print a line about a part; how many of its rows differ."""
    different = [(row, told) for row, told in results if told]
    equal = len(results) - len(different)
    print(f"{part.name:12} {len(results):6} {equal:6} {len(different):10} {seconds:8.0f}")
    for row, told in different[:SHOWN]:
        cell = " / ".join(str(row[name]) for name in CELL if row[name])
        print(f"  {cell}, episode {row['episode']}: {'; '.join(told)}")
    return len(different)


def _main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rows", type=Path, default=Path("experiments/rows/belief"))
    parser.add_argument("--count", type=int, default=20, help="rows of each part")
    parser.add_argument("--cells", type=int, default=5, help="cells that they are taken from")
    parser.add_argument("--cache", type=Path, default=Path("/tmp/proof-calibrations"))
    parser.add_argument("--parts", default="", help="only these, with commas")
    parser.add_argument("--record", action="store_true", help=f"write {PAPER_ROWS.name}")
    options = parser.parse_args()
    if options.record:
        part = paper_part()
        lines = ",\n  ".join(json.dumps(row, ensure_ascii=False) for row in part.rows)
        text = f'{{"settings": {json.dumps(part.settings)},\n "rows": [\n  {lines}\n]}}\n'
        PAPER_ROWS.write_text(text, encoding="utf-8")
        return 0
    wanted = [name for name in options.parts.split(",") if name]
    before, different = len(list(options.cache.glob("*"))), 0
    print(f"{'part':12} {'rows':>6} {'equal':>6} {'different':>10} {'seconds':>8}")
    for part in published(options.rows):
        if not wanted or part.name in wanted:
            began = time.perf_counter()
            results = compared(part, options.count, options.cells, options.cache)
            different += _report(part, results, time.perf_counter() - began)
    learnt = len(list(options.cache.glob("*"))) - before
    print(f"calibrations: {learnt} learnt, {before} lay in {options.cache}")
    return int(different > 0)


if __name__ == "__main__":
    sys.exit(_main())
