"""The figure of the bench of scenes: whether the probability of the first state is true."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tpvqa.bench.figures import Figure
from tpvqa.bench.statistics import wilson
from tpvqa.bench.style import styled_pyplot
from tpvqa_experiments.scenes.judged import Judged, Reading, arrays, reliability
from tpvqa_experiments.scenes.tables import ALL, of

BELIEF, NAIVE = "#0072b2", "#d55e00"
BINS = {ALL: 10}
FEW_BINS = 5
"""Of one VLM: it has an eighth of the scenes."""


def reliability_figure(judged: Sequence[Judged]) -> Figure:
    """Share of scenes that are right over the probability of their first state: a panel for all
    VLMs together, and one for each.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    pyplot = styled_pyplot()
    names = [ALL, *sorted({each.scene.model for each in judged})]
    across = min(3, len(names))
    down = -(-len(names) // across)
    figure, grid = pyplot.subplots(
        down,
        across,
        figsize=(0.8 + 3.1 * across, 1.0 + 2.9 * down),
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    for axes, name in zip(grid.flat, names, strict=False):
        own = of(judged, name)
        _panel(axes, own, BINS.get(name, FEW_BINS))
        axes.set_title("all VLMs" if name == ALL else name, fontsize=10, loc="left")
    for axes in list(grid.flat)[len(names) :]:
        axes.set_visible(False)
    for axes in grid[-1]:
        axes.set_xlabel("probability of the first state")
    for row in grid:
        row[0].set_ylabel("share right")
    figure.legend(
        *grid[0][0].get_legend_handles_labels(), frameon=False, loc="outside upper center", ncols=3
    )
    return figure


def _panel(axes: Any, own: Sequence[Judged], bins: int) -> None:
    axes.plot([0, 1], [0, 1], color="#b8bcc2", linewidth=1.2, linestyle=(0, (4, 3)), zorder=0)
    belief = [each.belief for each in own]
    _curve(axes, [each.naive for each in own], bins, NAIVE, "o", "naive")
    _curve(axes, belief, bins, BELIEF, "D", "belief, with 95% intervals")
    axes.annotate(
        f"right {np.mean([each.right for each in belief]):.2f}, error {reliability(belief):.3f}",
        (0.04, 0.93),
        xycoords="axes fraction",
        fontsize=8.5,
    )
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(-0.02, 1.1)
    axes.grid(color="#eceef1", linewidth=0.8)
    axes.set_axisbelow(True)


def _curve(
    axes: Any, readings: Sequence[Reading], bins: int, colour: str, marker: str, label: str
) -> None:
    sure, right = arrays(readings)
    place = np.minimum((sure * bins).astype(int), bins - 1)
    inside = [place == k for k in range(bins) if (place == k).any()]
    xs = [float(sure[each].mean()) for each in inside]
    ys = [float(right[each].mean()) for each in inside]
    if label != "naive":
        for x, each in zip(xs, inside, strict=True):
            found = wilson(int(right[each].sum()), int(each.sum()))
            axes.vlines(x, found.low, found.high, color=colour, linewidth=2, alpha=0.35)
    axes.plot(xs, ys, color=colour, linewidth=1.4, marker=marker, markersize=4, label=label)
