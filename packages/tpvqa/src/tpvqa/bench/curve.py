"""Completion against the accuracy of answers: where perception stops being worth having."""

from collections.abc import Mapping, Sequence

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa.monitors.capabilities import never_asks
from tpvqa.plugins import Kind, load_spec

ACCURACIES = (0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0)
WORLD = "symbolic"
LEVELS = ("tp", "none")
"""Monitors without perception, whose completion the others' is measured against."""
Curve = dict[float, Interval]
"""Completion rate by accuracy, each with its 95% Wilson interval."""


def curve_cells(tasks: Sequence[str], monitors: Sequence[str]) -> list[Cell]:
    """The cells of the curves: a noise-model VLM of every accuracy; one where nothing is asked."""
    return [
        Cell(task, monitor, f"oracle:{accuracy:g}", WORLD)
        for task in tasks
        for monitor in monitors
        for accuracy in (ACCURACIES[-1:] if is_level(monitor) else ACCURACIES)
    ]


def is_level(monitor: str) -> bool:
    """Whether the curve of a monitor is a level line, as it never asks."""
    return never_asks(load_spec(Kind.MONITOR, monitor))


def curves(
    rows: Mapping[Cell, Sequence[EpisodeRow]], tasks: Sequence[str], monitors: Sequence[str]
) -> dict[str, dict[str, Curve]]:
    """Completion rate by task, monitor and accuracy; of monitors that never ask, a constant."""
    found: dict[str, dict[str, Curve]] = {}
    for task in tasks:
        for monitor in monitors:
            points: Curve = {}
            for accuracy in ACCURACIES:
                asked = ACCURACIES[-1] if is_level(monitor) else accuracy
                own = rows.get(Cell(task, monitor, f"oracle:{asked:g}", WORLD), [])
                if own:
                    points[accuracy] = wilson(sum(row.completed for row in own), len(own))
            if points:
                found.setdefault(task, {})[monitor] = points
    return found


def crossings(by_monitor: Mapping[str, Curve]) -> dict[str, float | None]:
    """By monitor, from which accuracy on asking beats not asking; empty where all ask."""
    levels = [by_monitor[monitor] for monitor in LEVELS if monitor in by_monitor]
    if not levels:
        return {}
    level = next(iter(levels[0].values())).rate
    return {
        monitor: crossing({accuracy: each.rate for accuracy, each in curve.items()}, level)
        for monitor, curve in by_monitor.items()
        if not is_level(monitor)
    }


def crossing(curve: Mapping[float, float], level: float) -> float | None:
    """The accuracy from which a monitor is at least as good as a level; None if it never is.

    Linear between the measured accuracies, from the last one that is worse.
    """
    below = [accuracy for accuracy, rate in curve.items() if rate < level]
    if not below:
        return min(curve)
    last = max(below)
    above = min((accuracy for accuracy in curve if accuracy > last), default=None)
    if above is None:
        return None
    share = (level - curve[last]) / (curve[above] - curve[last])
    return last + share * (above - last)
