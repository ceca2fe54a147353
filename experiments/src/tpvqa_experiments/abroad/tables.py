"""The tables of the bench abroad."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean, median
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa_experiments.abroad.parts import SEEING, Part, is_limit
from tpvqa_experiments.belief.markdown import rate, table

PATIENCE = 8
"""Tries after which a skill that never works should have been seen to be dead."""
Rows = Mapping[Cell, Sequence[EpisodeRow]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One monitor over the tasks of a part under one condition.

    Attributes:
        completion: Over the trials of all tasks.
        least: The least completion rate of a task.
        least_in: That task.
        quotient: Actions beside those of who sees all, in episodes that both completed: a mean over
            tasks of the quotient of means; None where that was not measured.
        difference: The same as a difference.
        typical: Questions an action, in the task that has the median of it.
        most: The same in the task that has most.
        most_in: That task.
        named: Of the trials in which a skill that never works was tried, the share in which it was
            called dead within `PATIENCE` tries; None where there are none.
        misnamed: Share of trials in which a skill that works was called dead.
        seconds: Of an episode that was run here; None where all are published, which tell no times.
        endings: How trials ended, the most frequent first.
    """

    vlm: str
    condition: str
    monitor: str
    tasks: int
    trials: int
    completion: Interval
    least: float
    least_in: str
    quotient: float | None
    difference: float | None
    typical: float
    most: float
    most_in: str
    named: float | None
    misnamed: float
    seconds: float | None
    endings: str

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
    """A line for every VLM, condition and monitor, in the order of the cells; limits last."""
    keys = dict.fromkeys((cell.vlm, cell.condition, cell.monitor) for cell in rows)
    groups = list(dict.fromkeys(key[:2] for key in keys))
    ordered = sorted(keys, key=lambda key: (groups.index(key[:2]), *_last(key[2])))
    return [_line(rows, *key) for key in ordered]


def _last(monitor: str) -> tuple[bool, bool]:
    """Orders monitors: limits come last, who sees all as the last of them."""
    return is_limit(monitor), monitor == SEEING


def _line(rows: Rows, vlm: str, condition: str, monitor: str) -> Line:
    own = _of(rows, vlm, condition, monitor)
    trials = [row for found in own.values() for row in found]
    questions = {task: asked(found) for task, found in own.items()}
    done = {task: _sum(found, "completed") / len(found) for task, found in own.items()}
    most_in, least_in = max(questions, key=questions.__getitem__), min(done, key=done.__getitem__)
    quotient, difference = _beside(own, _of(rows, vlm, condition, SEEING))
    endings = Counter(row.ending for row in trials).most_common()
    return Line(
        vlm=vlm,
        condition=condition,
        monitor=monitor,
        tasks=len(own),
        trials=len(trials),
        completion=wilson(int(_sum(trials, "completed")), len(trials)),
        least=done[least_in],
        least_in=least_in,
        quotient=quotient,
        difference=difference,
        typical=median(questions.values()),
        most=questions[most_in],
        most_in=most_in,
        named=_named([row for row in trials if row.dead]),
        misnamed=sum(bool(row.misnamed) for row in trials) / len(trials),
        seconds=_mean([row.seconds for row in trials if row.seconds]),
        endings=", ".join(f"{name} {count}" for name, count in endings),
    )


def _of(rows: Rows, vlm: str, condition: str, monitor: str) -> dict[str, Sequence[EpisodeRow]]:
    """The episodes of a monitor by task."""
    wanted = (vlm, condition, monitor)
    return {
        cell.task: found
        for cell, found in rows.items()
        if (cell.vlm, cell.condition, cell.monitor) == wanted
    }


def _beside(
    own: Mapping[str, Sequence[EpisodeRow]], limits: Mapping[str, Sequence[EpisodeRow]]
) -> tuple[float | None, float | None]:
    """Quotient and difference of actions, in episodes that both completed: means over tasks."""
    quotients, differences = [], []
    for task, found in own.items():
        pairs = paired_actions(found, limits.get(task, ()))
        least = sum(there for _, there in pairs)
        if least:
            quotients.append(sum(here for here, _ in pairs) / least)
            differences.append(fmean(here - there for here, there in pairs))
    return (fmean(quotients), fmean(differences)) if quotients else (None, None)


def paired_actions(own: Sequence[EpisodeRow], limit: Sequence[EpisodeRow]) -> list[tuple[int, int]]:
    """Actions of a monitor and of who sees all, in the episodes that both completed."""
    there = {row.episode: row.actions for row in limit if row.completed}
    return [
        (row.actions, there[row.episode]) for row in own if row.completed and row.episode in there
    ]


def asked(rows: Sequence[EpisodeRow]) -> float:
    """Questions an action, over all episodes of a cell."""
    return _sum(rows, "questions") / max(_sum(rows, "actions"), 1)


def _mean(values: Sequence[float]) -> float | None:
    return fmean(values) if values else None


def _named(rows: Sequence[EpisodeRow]) -> float | None:
    found = sum(row.named is not None and row.named <= PATIENCE for row in rows)
    return found / len(rows) if rows else None


def _sum(rows: Sequence[EpisodeRow], name: str) -> float:
    return float(sum(getattr(row, name) for row in rows))


def markdown(settings: Mapping[str, Any], parts: Mapping[Part, Rows]) -> str:
    """The tables of all parts: over their tasks, and task by task."""
    told = ", ".join(f"{name} {value}" for name, value in settings.items())
    sections = [f"# Abroad, measured\n\nSettings: {told}.\n"]
    for part, rows in parts.items():
        if rows:
            sections.append(f"## {part}\n\n{_over_tasks(part, rows)}\n{_by_task(rows)}")
    return "\n".join(sections)


def _over_tasks(part: Part, rows: Rows) -> str:
    names = [
        *("VLM", "condition", "monitor", "tasks", "trials", "completed", "95% interval"),
        *("least in a task", "actions / seeing", "actions − seeing"),
        *("questions an action", "most", "working skill called dead", "seconds"),
        "how they ended",
    ]
    found = [
        [
            each.vlm,
            each.condition,
            each.monitor,
            str(each.tasks),
            str(each.trials),
            rate(each.completion.rate),
            f"{rate(each.completion.low)}–{rate(each.completion.high)}",
            f"{rate(each.least)} ({each.least_in})",
            "" if each.quotient is None else f"{each.quotient:.2f}",
            "" if each.difference is None else f"{each.difference:+.1f}",
            f"{each.typical:.1f}",
            f"{each.most:.1f} ({each.most_in})",
            rate(each.misnamed),
            "" if each.seconds is None else f"{each.seconds:.2f}",
            each.endings,
        ]
        for each in lines(rows)
    ]
    if part is Part.DEAD:
        names.append(f"dead skill named within {PATIENCE} tries")
        for told, each in zip(found, lines(rows), strict=True):
            told.append("" if each.named is None else rate(each.named))
    return table(names, found)


def _by_task(rows: Rows) -> str:
    """A line for every task and condition: completion, actions, questions an action."""
    monitors = sorted(dict.fromkeys(cell.monitor for cell in rows), key=_last)
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
    done, actions = _sum(rows, "completed") / len(rows), _sum(rows, "actions") / len(rows)
    return f"{rate(done)}, {actions:.0f}, {asked(rows):.1f}"
