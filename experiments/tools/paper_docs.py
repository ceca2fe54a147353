"""Put what the paper's bench has measured into the documentation, and its rows into small files.

`python experiments/tools/paper_docs.py FOLDER… [--belief FOLDER…] [--rows FOLDER]`, with folders
that `tpvqa bench paper` (and, for our monitor beside the rivals, `tpvqa bench belief`) have
written. Between `<!-- NAME -->` and `<!-- end -->`, the tables of `docs/paper.md` and of
`README.md` are made again.
"""

import argparse
import csv
import json
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import ROWS, SETTINGS, merged
from tpvqa.bench.published import write_published
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import paired, wilson
from tpvqa_experiments.paper import TASKS

ROOT = Path(__file__).parents[2]
FREE, RISKY = "limits=none", "limits=none,redo=risky"
COLUMNS = (
    ("embedded", "embedded", "images"),
    ("embedded, paper's simulator", "embedded", "images:paper"),
    ("paper-table", "paper-table", "symbolic"),
    ("gemma-3-12b", "recorded:gemma-3-12b:fresh", "symbolic"),
    ("internvl3-8b", "recorded:internvl3-8b:fresh", "symbolic"),
    ("gpt-4.1-nano", "recorded:gpt-4.1-nano:fresh", "symbolic"),
    ("qwen2.5-vl-72b", "recorded:qwen2.5-vl-72b:fresh", "symbolic"),
)
"""How a column is called, its VLM and its world."""
COMPLETION = (
    *("tpvqa", "tpvqa:strict", "effectvqa", "effectvqa:strict"),
    *("palmevqa", "successvqa", "tp"),
)
READINGS = (
    ("tie", "tpvqa", "effectvqa"),
    ("strict", "tpvqa:strict", "effectvqa:strict"),
    ("tie, no where-else", "tpvqa:no-alternatives", "effectvqa"),
    ("strict, no where-else", "tpvqa:strict:no-alternatives", "effectvqa:strict"),
)
RIVALS = (
    *("tp", "blind:5", "effectvqa", "effectvqa:strict", "tpvqa", "tpvqa:strict"),
    *("vote:5", "lead:4", "belief"),
)
FIELD = (
    *("blind:1", "blind:2", "blind:3", "blind:5", "blind:8", "effectvqa", "effectvqa:strict"),
    *(
        "tpvqa",
        "tpvqa:strict",
        "tpvqa:5",
        "vote:5",
        "lead:2",
        "lead:3",
        "lead:4",
        "lead:6",
        "belief",
    ),
)
FRONT = ("tp", "blind:5", "tpvqa", "tpvqa:strict", "vote:5", "belief")
SURE = 0.05


class Measured:
    """The rows of some benches, cell by cell."""

    def __init__(self, folders: Sequence[Path], episodes: int):
        self.folders = folders
        self.rows: dict[Cell, dict[int, EpisodeRow]] = {}
        for folder in folders:
            lines = (folder / ROWS).read_text(encoding="utf-8").splitlines()
            for (cell, number), row in merged(map(EpisodeRow.model_validate_json, lines)).items():
                if number < episodes:
                    self.rows.setdefault(cell, {})[number] = row

    def of(
        self, task: str, monitor: str, column: Sequence[str], condition: str = ""
    ) -> list[EpisodeRow]:
        """The episodes of a cell, in order."""
        _, vlm, world = column
        found = self.rows.get(Cell(task, monitor, vlm, world, condition), {})
        if not found and monitor.startswith("blind"):  # it never asks: whatever the VLM
            found = next(
                (
                    rows
                    for cell, rows in self.rows.items()
                    if (cell.task, cell.monitor, cell.condition) == (task, monitor, condition)
                    and cell.world != "images:paper"
                ),
                {},
            )
        return [found[number] for number in sorted(found)]

    def completion(self) -> Iterator[Sequence[str]]:
        """Every monitor of the paper under both majorities, by VLM."""
        yield ("task", "monitor", *(name for name, *_ in COLUMNS))
        for task in TASKS:
            for monitor in COMPLETION:
                yield (
                    task if monitor == COMPLETION[0] else "",
                    monitor,
                    *(_rate(self.of(task, monitor, column)) for column in COLUMNS),
                )

    def readings(self) -> Iterator[Sequence[str]]:
        """TPVQA less EffectVQA under every reading of what the paper leaves open."""
        yield (
            *("VLM", "task"),
            *(f"{name}; ≤ 10" for name, *_ in READINGS),
            *(f"{name}; no limit" for name, *_ in READINGS),
        )
        for column in COLUMNS:
            for task in TASKS:
                told = [
                    _less(self.of(task, ours, column, limit), self.of(task, other, column, limit))
                    for limit in ("", FREE)
                    for _, ours, other in READINGS
                ]
                if any(told):
                    yield (column[0] if task == TASKS[0] else "", task, *told)

    def rivals(self) -> Iterator[Sequence[str]]:
        """Everybody under limits that do not bind: redoing free, and risky."""
        yield ("VLM", "task", *RIVALS)
        for column in COLUMNS:
            for task in TASKS:
                told = []
                for monitor in RIVALS:
                    free = _mean(self.of(task, monitor, column, FREE))
                    risky = _mean(self.of(task, monitor, column, RISKY))
                    told.append(" / ".join(filter(None, (free, risky))))
                if any(told[2:]):
                    yield (column[0] if task == TASKS[0] else "", task, *told)

    def field(self) -> Iterator[Sequence[str]]:
        """The belief monitor beside every rival under noise models: completion and questions."""
        yield ("answers right in", "redoing", "task", *FIELD)
        for vlm in ("oracle:0.8", "oracle:0.95"):
            column = (vlm, vlm, "symbolic")
            for name, condition in (("free", FREE), ("risky", RISKY)):
                for task in (*TASKS, "build_tower"):
                    told = [_asked(self.of(task, each, column, condition)) for each in FIELD]
                    if any(told):
                        first = task == TASKS[0]
                        accuracy = vlm.partition(":")[2]
                        yield (accuracy if first else "", name if first else "", task, *told)

    def front(self) -> Iterator[Sequence[str]]:
        """The table of the front page."""
        column = COLUMNS[0]
        yield ("task", *(_FRONT[each] for each in FRONT))
        for task in TASKS:
            told = []
            for monitor in FRONT:
                free, risky = (self.of(task, monitor, column, each) for each in (FREE, RISKY))
                asked = sum(row.questions for row in free) / len(free) if free else 0
                told.append(
                    f"{_mean(free)} / {_mean(risky)}" + (f" ({asked:.0f})" if asked else "")
                )
            yield (task, *told)

    def accuracy(self) -> Iterator[Sequence[str]]:
        """How right answers were on the balanced set, beside the paper's."""
        found: dict[str, dict[str, dict[str, str]]] = {}
        for folder in self.folders:
            if not (folder / "answers.csv").exists():
                continue
            with (folder / "answers.csv").open(encoding="utf-8") as file:
                for row in csv.DictReader(file):
                    if (row["on"], row["condition"]) == ("balanced", ""):
                        found.setdefault(row["asked"], {})[row["task"]] = row
        yield ("query", "", *TASKS)
        for way, by_task in found.items():
            cells = [by_task.get(task) for task in TASKS]
            yield (
                way.replace("<", "\\<").replace(">", "\\>"),
                "paper",
                *(each["paper"] or "–" if each else "–" for each in cells),
            )
            yield (
                *("", "embedded"),
                *(f"{float(e['accuracy']):.3f} ({e['visible']})" if e else "–" for e in cells),
            )


_FRONT = {
    "tp": "never looks",
    "blind:5": "every action five times, blindly",
    "tpvqa": "the paper's, ties deny",
    "tpvqa:strict": "the paper's, strict majority",
    "vote:5": "the same with votes of five looks",
    "belief": "ours",
}


def _rate(rows: Sequence[EpisodeRow]) -> str:
    if not rows:
        return "–"
    found = wilson(sum(row.completed for row in rows), len(rows))
    return f"{found.rate:.2f} ({found.low:.2f}–{found.high:.2f})"


def _mean(rows: Sequence[EpisodeRow]) -> str:
    return f"{sum(row.completed for row in rows) / len(rows):.2f}" if rows else ""


def _asked(rows: Sequence[EpisodeRow]) -> str:
    """Completion @ questions."""
    if not rows:
        return ""
    asked = sum(row.questions for row in rows) / len(rows)
    return _mean(rows) + (f" @ {asked:.0f}" if asked else "")


def _less(first: Sequence[EpisodeRow], second: Sequence[EpisodeRow]) -> str:
    """The difference of two completion rates; bold where the exact McNemar test is sure."""
    if not first or not second:
        return ""
    found = paired([row.completed for row in first], [row.completed for row in second])
    said = f"{found.difference:+.2f}"
    return f"**{said}**" if found.p < SURE else said


def _table(lines: Iterable[Sequence[str]]) -> str:
    head, *body = lines
    told = [head, ["---"] * len(head), *body]
    return "".join(f"| {' | '.join(line)} |\n" for line in told)


def _fill(path: Path, tables: dict[str, str]) -> None:
    text = path.read_text(encoding="utf-8")
    for name, table in tables.items():
        marks = re.compile(rf"(<!-- {name} -->\n)(?:.*?)(<!-- end -->)", re.DOTALL)
        text = marks.sub(lambda found, table=table: f"{found[1]}\n{table}\n{found[2]}", text)  # type: ignore[misc]
    path.write_text(text, encoding="utf-8")


def main() -> None:
    """Fill the pages, and write the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+", type=Path)
    parser.add_argument("--belief", nargs="*", type=Path, default=[])
    parser.add_argument("--rows", type=Path, help="where to write small files of the rows")
    parser.add_argument("--episodes", type=int, default=300, help="of every cell, at most")
    given = parser.parse_args()
    of_paper = Measured(given.folders, given.episodes)
    everything = Measured([*given.belief, *given.folders], given.episodes)
    tables = {
        "completion": _table(of_paper.completion()),
        "readings": _table(of_paper.readings()),
        "rivals": _table(everything.rivals()),
        "accuracy": _table(of_paper.accuracy()),
        "front": _table(everything.front()),
        "field": _table(everything.field()),
    }
    _fill(ROOT / "docs" / "belief-measured.md", tables)
    _fill(ROOT / "docs" / "paper.md", tables)
    _fill(ROOT / "README.md", tables)
    if given.rows is not None:
        settings = json.loads((given.folders[0] / SETTINGS).read_text(encoding="utf-8"))
        for vlm in sorted({cell.vlm.partition(":")[0] for cell in of_paper.rows}):
            own = (
                row
                for cell, rows in of_paper.rows.items()
                if cell.vlm.partition(":")[0] == vlm
                for row in rows.values()
            )
            print(f"{vlm}: {write_published(own, settings, given.rows / f'{vlm}.parquet'):,} rows")


if __name__ == "__main__":
    main()
