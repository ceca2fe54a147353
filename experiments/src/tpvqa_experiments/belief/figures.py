"""The figures of the belief bench."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from tpvqa.belief.filtering.ablations import PARTS
from tpvqa.bench.cell import Cell
from tpvqa.bench.figures import Figure
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa.bench.style import styled_pyplot
from tpvqa.plugins import split
from tpvqa_experiments.belief.comparison import curve_of
from tpvqa_experiments.belief.learning import BLOCK, RIGHT_TRUST, blocks
from tpvqa_experiments.belief.parts import (
    BASELINES,
    BELIEF,
    BELIEVED,
    SYMBOLIC,
    VOTES,
    WRONG_VLM,
    Extent,
    noise,
    without,
)
from tpvqa_experiments.belief.resampling import difference, ratio
from tpvqa_experiments.belief.results import BeliefResults

BEYOND = 1.5
"""How far the axis goes beyond the most questions that are shown."""
INK = "#0b4f8a"
"""The belief monitor."""
LEARNS, KNOWS = (f"told {vlm.partition(':')[2]}" for vlm in (BELIEVED, WRONG_VLM))
KNOWING = "#d55e00"
"""What stands beside it."""
MARKS = {
    "tpvqa": ("o", "#d55e00"),
    "tpvqa:3": ("^", "#d55e00"),
    "tpvqa:5": ("s", "#d55e00"),
    "vote": ("p", "#009e73"),
    "lead": ("h", "#cc79a7"),
    "effectvqa": ("v", "#767676"),
    "palmevqa": ("P", "#767676"),
    "successvqa": ("X", "#767676"),
    "tp": ("_", "#222222"),
    "blind": ("_", "#e69f00"),
}
"""Marker and colour of each rival, told apart without colour (Okabe and Ito 2008). Those with a
strict majority are open."""
OTHER = ("*", "#56b4e9")
Panel = tuple[Sequence[Sequence[EpisodeRow]], Mapping[str, Sequence[EpisodeRow]]]
"""The episodes at each point of the belief curve, and those of each rival."""


def draw(results: BeliefResults, extent: Extent) -> dict[str, Figure]:
    """All figures by name."""
    drawn = {}
    for rho in extent.rhos:
        named = {f"p = {p:g}": noise(p, rho) for p in extent.accuracies}
        found = _curves(results, extent, named, SYMBOLIC)
        if found is not None:
            drawn[f"curves_rho_{rho:g}"] = found
    for name, named, world in (
        ("paper_table", {"the paper's table": "paper-table"}, SYMBOLIC),
        ("embedded", {"embedded network": "embedded"}, "images"),
    ):
        found = _curves(results, extent, named, world)
        if found is not None:
            drawn[name] = found
    for name, others in (("ablations", _ablations), ("learning", _learning)):
        found = others(results, extent)
        if found is not None:
            drawn[name] = found
    return drawn


def _curves(
    results: BeliefResults, extent: Extent, named: Mapping[str, str], world: str
) -> Figure | None:
    """Completion over questions: a row of panels for every task, a column for every VLM."""

    def panel(task: str, vlm: str) -> Panel:
        rivals = {each: results.of(Cell(task, each, vlm, world)) for each in (*VOTES, *BASELINES)}
        return curve_of(results, extent, task, vlm, world), {
            rival: rows for rival, rows in rivals.items() if rows
        }

    tasks = extent.household
    panels = {(task, name): panel(task, vlm) for task in tasks for name, vlm in named.items()}
    if not any(curve for curve, _ in panels.values()):
        return None
    if len(named) == 1:  # the tasks beside each other
        (name,) = named
        return _small_multiples(
            [name], tasks, lambda row, column: panels[column, row], titles=tasks
        )
    return _small_multiples(
        tasks, list(named), lambda row, column: panels[row, column], titles=list(named)
    )


def _small_multiples(
    rows: Sequence[str],
    columns: Sequence[str],
    panel: Callable[[str, str], Panel],
    *,
    titles: Sequence[str],
) -> Figure:
    pyplot = styled_pyplot()
    figure, grid = pyplot.subplots(
        len(rows),
        len(columns),
        figsize=(1.0 + 1.75 * len(columns), 1.0 + 1.75 * len(rows)),
        sharex=True,
        sharey=True,
        squeeze=False,
    )
    panels = [[panel(row, column) for column in columns] for row in rows]
    most = BEYOND * max(_questions(each) for line in panels for each in line)
    for line, row, drawn in zip(grid, rows, panels, strict=True):
        for axes, each in zip(line, drawn, strict=True):
            _draw_panel(axes, *each, most)
        line[0].set_ylabel(f"{row}\ncompletion rate")
    for axes, title in zip(grid[0], titles, strict=True):
        axes.set_title(title)
    for axes in grid[-1]:
        axes.set_xlabel("questions")
    handles: dict[str, Any] = {}
    for axes in grid.flat:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    figure.legend(
        handles.values(),
        handles,
        frameon=False,
        loc="outside upper center",
        ncols=max(3, min(6, len(columns) * 2)),
        fontsize=8,
        handletextpad=0.3,
        columnspacing=1.2,
    )
    return figure


def _draw_panel(
    axes: Any,
    curve: Sequence[Sequence[EpisodeRow]],
    rivals: Mapping[str, Sequence[EpisodeRow]],
    most: float,
) -> None:
    axes.set_xscale("symlog", linthresh=10, linscale=0.5)
    axes.set_xlim(-1, most)
    axes.set_ylim(-0.03, 1.05)
    ticks = {0: "0", 10: "10", 100: "100", 1000: "1k", 10_000: "10k"}
    shown = [each for each in ticks if each <= most]
    axes.set_xticks(shown, [ticks[each] for each in shown])
    axes.set_xticks([], minor=True)
    axes.set_yticks([0, 0.5, 1], ["0", ".5", "1"])
    axes.set_yticks([0.25, 0.75], minor=True)
    axes.grid(color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    for rival, rows in rivals.items():
        marker, colour, face = _mark(rival)
        questions, rate, low, high = _point(rows)
        axes.vlines(questions, low, high, color=colour, linewidth=1, alpha=0.6)
        axes.plot(
            questions,
            rate,
            linestyle="none",
            marker=marker,
            markersize=9 if marker == "_" else 5,
            markeredgecolor=colour,
            markerfacecolor=face,
            markeredgewidth=1.6 if marker == "_" else 1,
            label=rival,
            clip_on=False,
        )
    points = sorted(map(_point, curve))
    if points:
        xs, ys, lows, highs = zip(*points, strict=True)
        if len(points) == 1:
            axes.plot([*xs, *xs], [*lows, *highs], color=INK, linewidth=1.2)
        axes.plot([xs[-1], most], [ys[-1]] * 2, color=INK, linewidth=1, linestyle=":")
        # What is linear in questions is not a straight line on this axis.
        between = np.unique([*xs, *np.linspace(xs[0], xs[-1], 500)])
        band = [np.interp(between, xs, edge) for edge in (lows, highs)]
        axes.fill_between(between, *band, color=INK, alpha=0.15, linewidth=0)
        axes.plot(between, np.interp(between, xs, ys), color=INK, linewidth=1.6)
        axes.plot(xs, ys, color=INK, linestyle="none", marker="D", markersize=3.5)
        axes.plot([], [], color=INK, linewidth=1.6, marker="D", markersize=3.5, label="belief")


def _mark(rival: str) -> tuple[str, str, str]:
    """Marker, edge and face."""
    strict = rival.endswith(":strict")
    plain = rival.removesuffix(":strict")
    marker, colour = MARKS.get(plain) or MARKS.get(split(plain)[0]) or OTHER
    return marker, colour, "white" if strict else colour


def _questions(panel: Panel) -> float:
    """The most that anything in it takes, in the mean; at least 10."""
    curve, rivals = panel
    return max([10.0, *(_point(rows)[0] for rows in (*curve, *rivals.values()))])


def _point(rows: Sequence[EpisodeRow]) -> tuple[float, float, float, float]:
    """Questions, completion rate, and its interval."""
    found = wilson(sum(row.completed for row in rows), len(rows))
    return sum(row.questions for row in rows) / len(rows), found.rate, found.low, found.high


def _learning(results: BeliefResults, extent: Extent) -> Figure | None:
    """Completion and trust by how many episodes a robot has behind it."""
    by_task = {task: found for task in extent.household if (found := blocks(results, task))}
    if not by_task:
        return None
    pyplot = styled_pyplot()
    figure, grid = pyplot.subplots(
        2,
        len(by_task),
        figsize=(1.0 + 2.4 * len(by_task), 4.4),
        sharex=True,
        sharey="row",
        squeeze=False,
    )
    for (above, below), (task, found) in zip(grid.T, by_task.items(), strict=True):
        middles = [block.first + (BLOCK + 1) / 2 for block in found]
        for which, (rates, name, colour, marker, line) in enumerate(
            (
                ([block.learning for block in found], f"{LEARNS}, has to learn", INK, "D", "-"),
                ([block.knowing for block in found], f"{KNOWS}, as it is", KNOWING, "o", "--"),
            )
        ):
            counts = [block.episodes[which] for block in found]
            drawn = [wilson(round(r * n), n) for r, n in zip(rates, counts, strict=True)]
            _draw_band(above, middles, drawn, colour)
            above.plot(
                middles,
                rates,
                color=colour,
                marker=marker,
                markersize=4,
                linewidth=1.6,
                linestyle=line,
                label=name,
            )
        trust = [
            Interval(
                block.trust, block.trust - block.trust_margin, block.trust + block.trust_margin
            )
            for block in found
        ]
        _draw_band(below, middles, trust, INK)
        below.plot(middles, [each.rate for each in trust], color=INK, marker="D", markersize=3.5)
        below.axhline(RIGHT_TRUST, color=KNOWING, linestyle="--")
        below.axhline(1, color="#767676", linewidth=0.8, linestyle=":")
        for axes in (above, below):
            axes.grid(color="#e6e6e6", linewidth=0.6)
            axes.set_axisbelow(True)
        above.set_title(task)
        above.set_ylim(0, 1.05)
        below.set_ylim(0, 1.4)
        below.set_xlabel("episode")
    grid[0][0].set_ylabel("completion rate")
    grid[1][0].set_ylabel("trust in answers")
    figure.legend(
        *grid[0][0].get_legend_handles_labels(), frameon=False, loc="outside upper center", ncols=2
    )
    return figure


def _draw_band(axes: Any, xs: Sequence[float], found: Sequence[Interval], colour: str) -> None:
    lows, highs = [each.low for each in found], [each.high for each in found]
    axes.fill_between(xs, lows, highs, color=colour, alpha=0.16, linewidth=0)


def _ablations(results: BeliefResults, extent: Extent) -> Figure | None:
    """What leaving a part out does: bars of completion and of questions, by task and VLM."""
    vlms = extent.ablated
    found = {
        (task, vlm, name): results.of(
            Cell(task, without(name) if name else BELIEF, noise(*vlm), SYMBOLIC)
        )
        for task in extent.household
        for vlm in vlms
        for name in ("", *PARTS)
    }
    if not any(rows for (_, _, name), rows in found.items() if name):
        return None
    pyplot = styled_pyplot()
    figure, grid = pyplot.subplots(
        len(extent.household),
        2 * len(vlms),
        figsize=(1.6 + 2.9 * len(vlms), 0.8 + 1.45 * len(extent.household)),
        sharey=True,
        sharex="col",
        squeeze=False,
    )
    places = range(len(PARTS))
    for line, task in zip(grid, extent.household, strict=True):
        for k, vlm in enumerate(vlms):
            left, right = line[2 * k], line[2 * k + 1]
            whole = found[task, vlm, ""]
            for place, name in enumerate(PARTS):
                rows = found[task, vlm, name]
                if not rows or not whole:
                    continue
                change = difference(rows, whole)
                left.barh(place, change.value, 0.7, color=INK)
                left.plot([change.low, change.high], [place, place], color="#222222", linewidth=1)
                share = ratio(rows, whole, "questions")
                right.barh(place, share.value, 0.7, color="#b7bcc4")
                right.plot([share.low, share.high], [place, place], color="#222222", linewidth=1)
            left.axvline(0, color="#222222", linewidth=0.8)
            right.axvline(1, color="#222222", linewidth=0.8)
        line[0].set_yticks(places, [f"no {name}" for name in PARTS])
        line[0].set_ylabel(task)
    for k, (accuracy, rho) in enumerate(vlms):
        grid[0][2 * k].set_title(f"p = {accuracy:g}, ρ = {rho:g}", loc="left")
        grid[-1][2 * k].set_xlabel("completion, change")
        grid[-1][2 * k + 1].set_xlabel("questions, ratio")
    grid[0][0].invert_yaxis()
    return figure
