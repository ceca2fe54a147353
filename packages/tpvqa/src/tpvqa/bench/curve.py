"""Completion against the accuracy of answers: where perception stops being worth having."""

from collections.abc import Mapping, Sequence

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow

ACCURACIES = (0.5, 0.55, 0.6, 0.65, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0)
WORLD = "symbolic"
Curve = dict[float, float]


def curve_cells(tasks: Sequence[str], monitors: Sequence[str]) -> list[Cell]:
    """The cells of the curves: a noise-model VLM of every accuracy; TP once, as it never asks."""
    return [
        Cell(task, monitor, f"oracle:{accuracy:g}", WORLD)
        for task in tasks
        for monitor in monitors
        for accuracy in (ACCURACIES if monitor not in BLIND else ACCURACIES[-1:])
    ]


BLIND = ("tp", "none")
"""Monitors that never ask."""


def curves(
    rows: Mapping[Cell, Sequence[EpisodeRow]], tasks: Sequence[str], monitors: Sequence[str]
) -> dict[str, dict[str, Curve]]:
    """Completion rate by task, monitor and accuracy; of monitors that never ask, a constant."""
    found: dict[str, dict[str, Curve]] = {}
    for task in tasks:
        for monitor in monitors:
            points: Curve = {}
            for accuracy in ACCURACIES:
                asked = ACCURACIES[-1] if monitor in BLIND else accuracy
                own = rows.get(Cell(task, monitor, f"oracle:{asked:g}", WORLD), [])
                if own:
                    points[accuracy] = sum(row.completed for row in own) / len(own)
            if points:
                found.setdefault(task, {})[monitor] = points
    return found


def crossing(curve: Curve, level: float) -> float | None:
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
