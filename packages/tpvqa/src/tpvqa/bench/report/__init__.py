"""One self-contained HTML page about a bench: tables and figures."""

import base64
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tpvqa.bench import figures
from tpvqa.bench.accuracy import Decisions, answers_of, decisions_of
from tpvqa.bench.cell import Cell
from tpvqa.bench.curve import Curve, crossings
from tpvqa.bench.folders import folder_within
from tpvqa.bench.ledger import REMEDY
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.summary import REFERENCE, Summary, summaries
from tpvqa.errors import WriteError
from tpvqa.files import write_whole
from tpvqa.pages import template
from tpvqa.questions import Way
from tpvqa.vlm.metrics import Metrics

WAYS = (Way.PRECONDITION, Way.POSSIBLE, Way.EFFECT, Way.SUCCESSFUL, Way.DID)
WORDS = {
    Way.PRECONDITION: "Action preconditions",
    Way.POSSIBLE: "Is it possible to <action> here?",
    Way.EFFECT: "Action effects",
    Way.SUCCESSFUL: "Was <action> successful?",
    Way.DID: "Did the robot successfully <action>?",
    Way.ALTERNATIVE: "Where else is it?",
}


@dataclass(frozen=True)
class AnswerLine:
    """Answers of one way of asking on one task, beside the paper's accuracy."""

    task: str
    way: str
    source: str
    metrics: Metrics
    decision_accuracy: float | None
    paper: float | None


@dataclass(frozen=True, slots=True)
class Group:
    """What stands in one table: cells with one VLM, in one world and condition.

    Attributes:
        title: The VLM, and where it has several worlds or a condition, these.
    """

    vlm: str
    world: str
    condition: str
    title: str

    @property
    def file(self) -> str:
        """The end of the names of its files."""
        return re.sub(r"[^\w.=,+-]+", "_", self.title)


@dataclass(frozen=True)
class Results:
    """All that a bench has found.

    Attributes:
        settings: What decided it.
        rows: The episodes of every cell.
        balanced: Lines about the balanced set, by VLM.
        curves: Completion by task, monitor and accuracy.
        published: Accuracies that others measured, by way of asking and task, to stand beside.
        reference: The monitor that the others are compared with.
        beside: Episodes in the same folder that are of other cells, or more than were asked for.
    """

    settings: Mapping[str, Any]
    rows: Mapping[Cell, Sequence[EpisodeRow]]
    balanced: Mapping[str, Sequence[AnswerLine]] = field(default_factory=dict)
    curves: Mapping[str, Mapping[str, Curve]] = field(default_factory=dict)
    published: Mapping[Way, Mapping[str, float]] = field(default_factory=dict)
    reference: str = REFERENCE
    beside: int = 0

    @property
    def summaries(self) -> list[Summary]:
        """The figures of every cell."""
        return summaries(self.rows, self.reference)

    @property
    def errors(self) -> int:
        """Episodes that the program could not run to their end."""
        return sum(bool(row.error) for rows in self.rows.values() for row in rows)

    @property
    def groups(self) -> list[Group]:
        """The tables, in order."""
        found = dict.fromkeys((cell.vlm, cell.world, cell.condition) for cell in self.rows)
        return [Group(*each, self._title(*each)) for each in found]

    def _title(self, vlm: str, world: str, condition: str) -> str:
        several = len({cell.world for cell in self.rows if cell.vlm == vlm}) > 1
        return ", ".join(filter(None, (vlm, world if several else "", condition)))

    def summaries_of(self, group: Group) -> list[Summary]:
        """The figures of the cells of a group."""
        return summaries(self._rows(group), self.reference)

    def of(self, group: Group) -> dict[str, dict[str, Sequence[EpisodeRow]]]:
        """The episodes of a group, by task and monitor."""
        found: dict[str, dict[str, Sequence[EpisodeRow]]] = {}
        for cell, rows in self._rows(group).items():
            if rows:
                found.setdefault(cell.task, {})[cell.monitor] = rows
        return found

    def _rows(self, group: Group) -> dict[Cell, Sequence[EpisodeRow]]:
        own = (group.vlm, group.world, group.condition)
        return {
            cell: rows
            for cell, rows in self.rows.items()
            if (cell.vlm, cell.world, cell.condition) == own
        }

    def answer_lines(self, group: Group) -> list[AnswerLine]:
        """How right the answers given in the episodes of a group were."""
        lines = []
        for task, by_monitor in self.of(group).items():
            rows = [row for own in by_monitor.values() for row in own]
            for way in WORDS:
                metrics = answers_of(rows, way)
                if metrics is not None:
                    paper = self.published.get(way, {}).get(task)
                    lines.append(AnswerLine(task, WORDS[way], "episodes", metrics, None, paper))
        return lines

    def lines(self, group: Group) -> list[AnswerLine]:
        """How right a VLM's answers were: on the balanced set, then in a group's episodes."""
        return [*self.balanced.get(group.vlm, ()), *self.answer_lines(group)]

    def decision_lines(self, group: Group) -> list[tuple[str, str, Decisions]]:
        """How right the decisions of every monitor were."""
        found = []
        for task, by_monitor in self.of(group).items():
            for monitor, rows in by_monitor.items():
                for when in ("before", "after"):
                    decisions = decisions_of(rows, when)
                    if decisions is not None:
                        found.append((task, monitor, decisions))
        return found

    def crossings(self) -> list[tuple[str, str, float | None]]:
        """By task and monitor, from which accuracy on asking beats not asking."""
        return [
            (task, monitor, at)
            for task, by_monitor in self.curves.items()
            for monitor, at in crossings(by_monitor).items()
        ]


def draw(results: Results) -> Iterator[tuple[str, Any]]:
    """All figures with their names, each made when it is asked for: they take much memory."""
    for group in results.groups:
        own = results.summaries_of(group)
        if own:
            yield f"completion-{group.file}", figures.completion(own)
            yield f"endings-{group.file}", figures.endings(results.of(group))
            yield f"limits-{group.file}", figures.limits(results.of(group))
    if results.curves:
        yield "accuracy", figures.accuracy_curves(results.curves)


def write_bench_report(folder: Path, results: Results) -> Path:
    """Write the figures (SVG and PNG) and the page; the page needs nothing beside it.

    Raises:
        MissingExtraError: Matplotlib is not installed.
        WriteError: The folder cannot be written to.
    """
    pictures = {}
    beside = folder_within(folder, "figures")
    try:
        for name, figure in draw(results):
            for kind in ("svg", "png"):
                data = figures.saved(figure, kind)
                write_whole(beside / f"{name}.{kind}", data, remedy=REMEDY)
                if kind == "svg":
                    encoded = base64.b64encode(data).decode()
                    pictures[name] = f"data:image/svg+xml;base64,{encoded}"
            figures.close(figure)
        page = template("tpvqa.bench.report").render(results=results, pictures=pictures, rate=_rate)
        path = folder / "report.html"
        write_whole(path, page.encode(), remedy=REMEDY)
    except OSError as error:
        raise WriteError.of(folder, error, REMEDY) from error
    return path


def _rate(value: float | None, digits: int = 3) -> str:
    return "–" if value is None else f"{value:.{digits}f}"
