"""The figures of a bench, as SVG and PNG."""

from collections import Counter
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from tpvqa.bench.curve import LEVELS, Curve, crossings, is_level
from tpvqa.bench.limits import sensitivity
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa.bench.style import Style, styled_pyplot, styles
from tpvqa.bench.summary import Summary

ENDINGS = {
    "goal": "#009e73",
    "believed done and was not": "#d55e00",
    "limit of replans": "#e69f00",
    "limit of repeats": "#f3c969",
    "limit of actions": "#f7e7b0",
    "gave up": "#8a8f98",
    "no plan": "#5c6370",
    "error": "#111111",
}
GRID = "#e6e6e6"
INK = "#222222"
Figure = Any


def short(task: str) -> str:
    """A task's name in a figure: of one that is called by its problem's path, the end."""
    parts = Path(task).parts
    return task if len(parts) < 3 else f"…/{parts[-2]}/{parts[-1]}"


def completion(found: Sequence[Summary]) -> Figure:
    """Completion rates with 95% intervals: a group of bars for every task."""
    pyplot = styled_pyplot()
    tasks = list(dict.fromkeys(each.task for each in found))
    monitors = list(dict.fromkeys(each.monitor for each in found))
    drawn = styles(monitors)
    # A bar is wide enough for its figure.
    figure, axes = pyplot.subplots(figsize=(2.4 + 0.42 * len(tasks) * (len(monitors) + 1), 3.8))
    width = 0.84 / len(monitors)
    for k, monitor in enumerate(monitors):
        style = drawn[monitor]
        own = {each.task: each for each in found if each.monitor == monitor}
        places = [t + (k - (len(monitors) - 1) / 2) * width for t, _ in enumerate(tasks)]
        label: str | None = monitor
        for place, task in zip(places, tasks, strict=True):
            if task not in own:
                continue
            each = own[task]
            axes.bar(
                place,
                each.completion_rate,
                width * 0.92,
                facecolor=style.colour if style.filled else "white",
                edgecolor="white" if style.filled else style.colour,
                hatch=style.hatch,
                label=label,
            )
            label = None
            axes.errorbar(
                place,
                each.completion_rate,
                yerr=[
                    [max(0.0, each.completion_rate - each.ci_low)],
                    [max(0.0, each.ci_high - each.completion_rate)],
                ],
                color=INK,
                linewidth=1.2,
                capsize=2.5,
            )
            axes.annotate(
                f"{each.completion_rate:.2f}".lstrip("0"),
                (place, each.ci_high),
                xytext=(0, 2),
                textcoords="offset points",
                ha="center",
                fontsize=8,
            )
    axes.set_xticks(range(len(tasks)), [short(task) for task in tasks])
    axes.set_ylim(0, 1.08)
    axes.set_ylabel("completion rate")
    axes.yaxis.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(frameon=False, ncols=1, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def endings(rows: Mapping[str, Mapping[str, Sequence[EpisodeRow]]]) -> Figure:
    """How trials ended: a stacked bar for every task and monitor."""
    pyplot = styled_pyplot()
    bars = [(task, monitor) for task, own in rows.items() for monitor in own]
    figure, axes = pyplot.subplots(figsize=(9, 0.6 + 0.3 * len(bars)))
    left = [0.0] * len(bars)
    counts = [Counter(row.ending for row in rows[task][monitor]) for task, monitor in bars]
    names = [name for name in ENDINGS if any(name in count for count in counts)]
    names += sorted({name for count in counts for name in count} - set(names))
    for name in names:
        shares = [count[name] / sum(count.values()) for count in counts]
        axes.barh(
            range(len(bars)),
            shares,
            left=left,
            label=name,
            color=ENDINGS.get(name),
            edgecolor="white",
            linewidth=0.6,
            height=0.78,
        )
        left = [a + b for a, b in zip(left, shares, strict=True)]
    axes.set_yticks(range(len(bars)), [f"{short(task)} · {monitor}" for task, monitor in bars])
    axes.margins(y=0.01)
    axes.invert_yaxis()
    axes.set_xlim(0, 1)
    axes.set_xlabel("share of episodes")
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def limits(rows: Mapping[str, Mapping[str, Sequence[EpisodeRow]]]) -> Figure:
    """Completion under tighter limits, with 95% intervals: a row of panels for every task."""
    pyplot = styled_pyplot()
    names = ("actions", "repeats", "replans")
    figure, panels = pyplot.subplots(
        len(rows), 3, figsize=(10, 0.6 + 2.6 * len(rows)), sharey=True, squeeze=False
    )
    drawn = styles(list(dict.fromkeys(monitor for own in rows.values() for monitor in own)))
    for line, (task, own) in zip(panels, rows.items(), strict=True):
        for monitor, episodes in own.items():
            count = len(episodes)
            under = sensitivity(episodes)
            for axes, name in zip(line, names, strict=True):
                points: Mapping[float, Interval] = {
                    limit: wilson(round(rate * count), count) for limit, rate in under[name].items()
                }
                _draw_curve(axes, points, drawn[monitor], monitor)
        for axes, name in zip(line, names, strict=True):
            axes.set_ylim(0, 1.03)
            axes.set_xlabel(f"limit of {name}")
        line[0].set_ylabel(f"{short(task)}\ncompletion rate")
    _legend(figure, panels, list(drawn))
    return figure


def accuracy_curves(found: Mapping[str, Mapping[str, Curve]]) -> Figure:
    """Completion against the accuracy of answers with 95% intervals, and where TP's is crossed."""
    pyplot = styled_pyplot()
    figure, panels = pyplot.subplots(
        1, len(found), figsize=(1.0 + 3.9 * len(found), 4.6), sharey=True, squeeze=False
    )
    drawn = styles(list(dict.fromkeys(monitor for own in found.values() for monitor in own)))
    for axes, (task, own) in zip(panels[0], found.items(), strict=True):
        for monitor in sorted(own, key=lambda each: not is_level(each)):
            _draw_curve(axes, own[monitor], drawn[monitor], monitor)
        _mark_crossings(axes, own)
        axes.set_title(short(task))
        axes.set_xlabel("accuracy of answers")
        axes.set_xlim(min(min(curve) for curve in own.values()) - 0.01, 1.01)
        axes.set_ylim(0, 1.03)
    panels[0][0].set_ylabel("completion rate")
    _legend(figure, panels, list(drawn))
    return figure


def _draw_curve(axes: Any, points: Mapping[float, Interval], style: Style, label: str) -> None:
    """A curve in a band that is its 95% interval."""
    xs = list(points)
    axes.fill_between(
        xs,
        [each.low for each in points.values()],
        [each.high for each in points.values()],
        color=style.colour,
        alpha=0.16,
        linewidth=0,
    )
    axes.plot(
        xs,
        [each.rate for each in points.values()],
        **style.plotted,
        linewidth=1.8,
        markersize=4.5,
        label=label,
    )
    axes.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)


def _mark_crossings(axes: Any, own: Mapping[str, Curve]) -> None:
    """A circle where a curve crosses TP's, with the accuracy beside it."""
    found = crossings(own)
    crossed = sorted(
        at for monitor, at in found.items() if at is not None and at > min(own[monitor])
    )
    for k, at in enumerate(crossed):
        level = next(own[monitor] for monitor in LEVELS if monitor in own)
        height = next(iter(level.values())).rate
        axes.plot(
            [at],
            [height],
            linestyle="none",
            marker="o",
            markersize=11,
            markeredgewidth=1.6,
            markerfacecolor="none",
            markeredgecolor=INK,
        )
        left = k % 2 == 0 and len(crossed) > 1  # neighbours do not write over each other
        axes.annotate(
            f"{at:.2f}".lstrip("0"),
            (at, height),
            xytext=(-7 if left else 7, -13 - 11 * (k // 2)),
            textcoords="offset points",
            ha="right" if left else "left",
            fontsize=10,
            color=INK,
        )


def _legend(figure: Figure, panels: Any, order: Sequence[str]) -> None:
    """One legend for all panels, with every line that any of them has."""
    handles: dict[str, Any] = dict.fromkeys(order)
    for axes in panels.flat:
        drawn, labels = axes.get_legend_handles_labels()
        handles |= dict(zip(labels, drawn, strict=True))
    across = max(3, int(figure.get_figwidth() / 1.7))
    figure.legend(
        handles.values(),
        handles,
        frameon=False,
        loc="outside upper center",
        ncols=min(len(handles), across),
        handlelength=2.8,
    )


def saved(figure: Figure, kind: str) -> bytes:
    """A figure as "svg" or "png"; the same figure gives the same bytes."""
    buffer = BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    figure.savefig(buffer, format=kind, dpi=160, metadata=metadata)
    return buffer.getvalue()


def close(figure: Figure) -> None:
    """Free a figure."""
    styled_pyplot().close(figure)
