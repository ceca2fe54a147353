"""Whether a curve of completion over questions lies above a single monitor's point."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa_experiments.belief.parts import BELIEF, VOTES, Extent, priced
from tpvqa_experiments.belief.resampling import Estimate, Resampled, interval
from tpvqa_experiments.belief.results import BeliefResults


class Lies(StrEnum):
    """Where the curve is, seen from the point."""

    ABOVE = "clearly above"  # significantly
    ON = "on or above"  # not significantly below
    BELOW = "below"  # significantly
    LEFT = "not reached"  # the point asks less than every point of the curve


@dataclass(frozen=True, slots=True)
class Against:
    """The curve beside one point.

    Attributes:
        questions: Mean questions of the point.
        completion: Its completion rate.
        difference: The curve's completion at as many questions, less the point's; None where
            the curve does not reach so far to the left.
        lies: The verdict.
    """

    questions: float
    completion: float
    difference: Estimate | None
    lies: Lies


def against(curve: Sequence[Sequence[EpisodeRow]], point: Sequence[EpisodeRow]) -> Against:
    """Compare a curve with a point that ran the same episodes.

    The curve is linear between its points, sorted by questions, and flat to their right.

    Args:
        curve: The episodes of each of its points, in any order.
        point: The episodes of the point.
    """
    points = [Resampled(rows) for rows in curve]
    at = Resampled(point)
    xs = np.array([each.mean("questions") for each in points])
    order = np.argsort(xs, kind="stable")
    questions, completion = at.mean("questions"), at.mean("completed")
    if not points or questions < xs[order[0]]:
        return Against(questions, completion, None, Lies.LEFT)
    ys = np.array([each.mean("completed") for each in points])
    value = float(np.interp(questions, xs[order], ys[order])) - completion
    # In a sample the points keep their places along the curve.
    all_xs = np.array([points[place].means("questions") for place in order])
    all_xs = np.maximum.accumulate(all_xs, axis=0)
    all_ys = np.array([points[place].means("completed") for place in order])
    samples = np.array(
        [np.interp(x, all_xs[:, k], all_ys[:, k]) for k, x in enumerate(at.means("questions"))]
    ) - at.means("completed")
    count = min(each.count for each in (at, *points))
    found = interval(value, samples, count)
    return Against(questions, completion, found, _verdict(found))


def _verdict(found: Estimate) -> Lies:
    if found.low > 0:
        return Lies.ABOVE
    return Lies.BELOW if found.high < 0 else Lies.ON


def curve_of(
    results: BeliefResults, extent: Extent, task: str, vlm: str, world: str
) -> list[Sequence[EpisodeRow]]:
    """The episodes of the belief monitor at every cost of a question."""
    monitors = (BELIEF, *map(priced, extent.prices))
    found = (results.of(Cell(task, monitor, vlm, world)) for monitor in monitors)
    return [rows for rows in found if rows]


def votes_beside_curve(
    results: BeliefResults, extent: Extent, task: str, vlm: str, world: str
) -> dict[str, Against]:
    """The curve beside every vote that was run."""
    curve = curve_of(results, extent, task, vlm, world)
    points = {vote: results.of(Cell(task, vote, vlm, world)) for vote in VOTES}
    return {vote: against(curve, rows) for vote, rows in points.items() if rows and curve}


def together(verdicts: Sequence[Against]) -> Lies:
    """The verdict on a cell: its worst, so that clearly above means above every vote."""
    for lies in (Lies.LEFT, Lies.BELOW, Lies.ON):
        if any(each.lies is lies for each in verdicts):
            return lies
    return Lies.ABOVE
