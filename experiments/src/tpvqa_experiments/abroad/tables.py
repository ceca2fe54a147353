"""The tables of the bench abroad."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import REMEDY
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa.files import write_whole
from tpvqa_experiments.abroad.parts import SEEING, Part
from tpvqa_experiments.belief.markdown import rate, table

Rows = Mapping[Cell, Sequence[EpisodeRow]]


@dataclass(frozen=True, slots=True)
class Line:
    """One monitor over the tasks of a part under one condition.

    Attributes:
        completion: Over the trials of all tasks.
        worst: The least completion rate of a task.
        actions: Actions beside those of who sees all, a mean over tasks of the quotient of means;
            None where that was not measured.
        typical: Questions an action, in the task that has the median of it.
        most: The same in the task that has most.
        most_in: That task.
        seconds: Of an episode.
        errors: Episodes that could not be run to their end.
    """

    vlm: str
    condition: str
    monitor: str
    tasks: int
    trials: int
    completion: Interval
    worst: float
    worst_in: str
    actions: float | None
    typical: float
    most: float
    most_in: str
    seconds: float
    errors: int

    def flat(self) -> dict[str, Any]:
        """As one row of plain values."""
        names = [name for name in self.__slots__ if name != "completion"]
        found = self.completion
        return {name: getattr(self, name) for name in names} | {
            "completion_rate": found.rate,
            "ci_low": found.low,
            "ci_high": found.high,
        }


def lines(rows: Rows) -> list[Line]:
    """A line for every VLM, condition and monitor, in the order of the cells; the limit last."""
    keys = dict.fromkeys((cell.vlm, cell.condition, cell.monitor) for cell in rows)
    groups = list(dict.fromkeys(key[:2] for key in keys))
    ordered = sorted(keys, key=lambda key: (groups.index(key[:2]), key[2] == SEEING))
    return [_line(rows, *key) for key in ordered]


def _line(rows: Rows, vlm: str, condition: str, monitor: str) -> Line:
    own = {
        cell.task: found
        for cell, found in rows.items()
        if (cell.vlm, cell.condition, cell.monitor) == (vlm, condition, monitor)
    }
    trials = [row for found in own.values() for row in found]
    asked = {
        task: _sum(found, "questions") / max(_sum(found, "actions"), 1)
        for task, found in own.items()
    }
    done = {task: _sum(found, "completed") / len(found) for task, found in own.items()}
    most_in, worst_in = max(asked, key=asked.__getitem__), min(done, key=done.__getitem__)
    return Line(
        vlm,
        condition,
        monitor,
        len(own),
        len(trials),
        wilson(int(_sum(trials, "completed")), len(trials)),
        done[worst_in],
        worst_in,
        _beside(rows, own),
        median(asked.values()),
        asked[most_in],
        most_in,
        _sum(trials, "seconds") / len(trials),
        sum(bool(row.error) for row in trials),
    )


def _beside(rows: Rows, own: Mapping[str, Sequence[EpisodeRow]]) -> float | None:
    """Actions as a multiple of those of who sees all, in episodes that both completed."""
    seen = {
        (cell.task, cell.vlm, cell.condition): found
        for cell, found in rows.items()
        if cell.monitor == SEEING
    }
    ratios = []
    for found in own.values():
        cell = found[0].cell
        limit = {row.episode: row for row in seen.get((cell.task, cell.vlm, cell.condition), ())}
        pairs = [
            (row.actions, limit[row.episode].actions)
            for row in found
            if row.completed and row.episode in limit and limit[row.episode].completed
        ]
        if pairs and sum(least for _, least in pairs):
            ratios.append(sum(n for n, _ in pairs) / sum(least for _, least in pairs))
    return sum(ratios) / len(ratios) if ratios else None


def _sum(rows: Sequence[EpisodeRow], name: str) -> float:
    return float(sum(getattr(row, name) for row in rows))


def markdown(settings: Mapping[str, Any], parts: Mapping[Part, Rows]) -> str:
    """The tables of all parts: over their tasks, and task by task."""
    told = ", ".join(f"{name} {value}" for name, value in settings.items())
    sections = [f"# Abroad, measured\n\nSettings: {told}.\n"]
    for part, rows in parts.items():
        if rows:
            sections.append(f"## {part}\n\n{_over_tasks(rows)}\n{_by_task(rows)}")
    return "\n".join(sections)


def _over_tasks(rows: Rows) -> str:
    names = (
        *("VLM", "condition", "monitor", "tasks", "trials", "completed", "95% interval"),
        *(
            "least in a task",
            "actions / seeing",
            "questions an action",
            "most",
            "seconds",
            "errors",
        ),
    )
    return table(
        names,
        [
            (
                each.vlm,
                each.condition,
                each.monitor,
                str(each.tasks),
                str(each.trials),
                rate(each.completion.rate),
                f"{rate(each.completion.low)}–{rate(each.completion.high)}",
                f"{rate(each.worst)} ({each.worst_in})",
                "" if each.actions is None else f"{each.actions:.2f}",
                f"{each.typical:.1f}",
                f"{each.most:.1f} ({each.most_in})",
                f"{each.seconds:.2f}",
                str(each.errors),
            )
            for each in lines(rows)
        ],
    )


def _by_task(rows: Rows) -> str:
    """A line for every task and condition: completion, actions, questions an action."""
    monitors = sorted(dict.fromkeys(cell.monitor for cell in rows), key=SEEING.__eq__)
    found = []
    for task, vlm, condition in dict.fromkeys((c.task, c.vlm, c.condition) for c in rows):
        cells = [
            rows.get(Cell(task, monitor, vlm, "symbolic", condition), ()) for monitor in monitors
        ]
        plan = next((row.first_plan for own in cells for row in own if row.first_plan), 0)
        found.append((task, vlm, condition, str(plan), *map(_short, cells)))
    text = "Task by task: completed, actions, questions an action.\n\n"
    return text + table(("task", "VLM", "condition", "plan", *monitors), found)


def _short(rows: Sequence[EpisodeRow]) -> str:
    if not rows:
        return ""
    actions = _sum(rows, "actions")
    asked = _sum(rows, "questions") / max(actions, 1)
    return f"{rate(_sum(rows, 'completed') / len(rows))}, {actions / len(rows):.0f}, {asked:.1f}"


def write_results(folder: Path, settings: Mapping[str, Any], parts: Mapping[Part, Rows]) -> None:
    """Write `abroad.md`, and `abroad.json` for programs.

    Raises:
        WriteError: The folder cannot be written to.
    """
    plain = [
        {"part": str(part), **line.flat()} for part, rows in parts.items() for line in lines(rows)
    ]
    write_whole(folder / "abroad.md", markdown(settings, parts).encode(), remedy=REMEDY)
    write_whole(
        folder / "abroad.json", (json.dumps(plain, indent=1) + "\n").encode(), remedy=REMEDY
    )
