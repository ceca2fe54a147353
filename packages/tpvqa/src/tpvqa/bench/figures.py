"""The figures of a bench, as SVG and PNG."""

from collections import Counter
from collections.abc import Mapping, Sequence
from io import BytesIO
from pathlib import Path
from typing import Any

from tpvqa.bench.curve import Curve, crossing
from tpvqa.bench.limits import sensitivity
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.summary import Summary
from tpvqa.errors import MissingExtraError

COLOURS = ("#1b6ca8", "#e07b39", "#8a8f98", "#3a9679", "#b8405e", "#7a5ea8", "#c2a83e", "#4a4e69")
ENDINGS = {
    "goal": "#3a9679",
    "believed done and was not": "#b8405e",
    "limit of replans": "#e07b39",
    "limit of repeats": "#e8b04b",
    "limit of actions": "#f0d58c",
    "gave up": "#8a8f98",
    "no plan": "#5c6370",
    "error": "#111111",
}
Figure = Any


def styled_pyplot() -> Any:
    """pyplot in the style of all figures of a bench.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    try:
        import matplotlib
    except ImportError as error:
        raise MissingExtraError("matplotlib", "bench", "The figures of a bench") from error
    matplotlib.use("Agg")
    from matplotlib import pyplot

    pyplot.rcParams.update(
        {
            "font.size": 10,
            "axes.spines.top": False,
            "axes.spines.right": False,
            "svg.hashsalt": "tpvqa",
            "figure.constrained_layout.use": True,
            "axes.titlesize": 11,
        }
    )
    return pyplot


def colours(monitors: Sequence[str]) -> dict[str, str]:
    """The colour of each monitor, the same in all figures."""
    return {monitor: COLOURS[k % len(COLOURS)] for k, monitor in enumerate(monitors)}


def short(task: str) -> str:
    """A task's name in a figure: of one that is called by its problem's path, the end."""
    parts = Path(task).parts
    return task if len(parts) < 3 else f"…/{parts[-2]}/{parts[-1]}"


def completion(found: Sequence[Summary]) -> Figure:
    """Completion rates with 95% intervals: a group of bars for every task."""
    pyplot = styled_pyplot()
    tasks = list(dict.fromkeys(each.task for each in found))
    monitors = list(dict.fromkeys(each.monitor for each in found))
    shade = colours(monitors)
    figure, axes = pyplot.subplots(figsize=(2.2 + 2.2 * len(tasks), 3.4))
    width = 0.8 / len(monitors)
    for k, monitor in enumerate(monitors):
        own = {each.task: each for each in found if each.monitor == monitor}
        places = [t + (k - (len(monitors) - 1) / 2) * width for t, _ in enumerate(tasks)]
        for place, task in zip(places, tasks, strict=True):
            if task not in own:
                continue
            each = own[task]
            axes.bar(
                place,
                each.completion_rate,
                width * 0.92,
                color=shade[monitor],
                label=monitor if task == tasks[0] else None,
            )
            axes.errorbar(
                place,
                each.completion_rate,
                yerr=[
                    [each.completion_rate - each.ci_low],
                    [each.ci_high - each.completion_rate],
                ],
                color="#222222",
                linewidth=1,
                capsize=2,
            )
            axes.annotate(
                f"{each.completion_rate:.2f}".lstrip("0"),
                (place, each.ci_high),
                xytext=(0, 2),
                textcoords="offset points",
                ha="center",
                fontsize=7,
            )
    axes.set_xticks(range(len(tasks)), [short(task) for task in tasks])
    axes.set_ylim(0, 1.08)
    axes.set_ylabel("completion rate")
    axes.legend(frameon=False, ncols=1, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def endings(rows: Mapping[str, Mapping[str, Sequence[EpisodeRow]]]) -> Figure:
    """How trials ended: a stacked bar for every task and monitor."""
    pyplot = styled_pyplot()
    bars = [(task, monitor) for task, own in rows.items() for monitor in own]
    figure, axes = pyplot.subplots(figsize=(8.5, 0.6 + 0.27 * len(bars)))
    left = [0.0] * len(bars)
    counts = [Counter(row.ending for row in rows[task][monitor]) for task, monitor in bars]
    names = [name for name in ENDINGS if any(name in count for count in counts)]
    names += sorted({name for count in counts for name in count} - set(names))
    for name in names:
        shares = [count[name] / sum(count.values()) for count in counts]
        axes.barh(
            range(len(bars)), shares, left=left, label=name, color=ENDINGS.get(name), height=0.78
        )
        left = [a + b for a, b in zip(left, shares, strict=True)]
    axes.set_yticks(range(len(bars)), [f"{short(task)} · {monitor}" for task, monitor in bars])
    axes.invert_yaxis()
    axes.set_xlim(0, 1)
    axes.set_xlabel("share of episodes")
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))
    return figure


def limits(rows: Mapping[str, Mapping[str, Sequence[EpisodeRow]]]) -> Figure:
    """Completion under tighter limits: a row of panels for every task."""
    pyplot = styled_pyplot()
    names = ("actions", "repeats", "replans")
    figure, panels = pyplot.subplots(
        len(rows), 3, figsize=(9, 0.4 + 2.2 * len(rows)), sharey=True, squeeze=False
    )
    monitors = list(dict.fromkeys(monitor for own in rows.values() for monitor in own))
    shade = colours(monitors)
    for line, (task, own) in zip(panels, rows.items(), strict=True):
        for axes, name in zip(line, names, strict=True):
            for monitor, episodes in own.items():
                points = sensitivity(episodes)[name]
                axes.plot(
                    list(points),
                    list(points.values()),
                    marker="o",
                    markersize=3,
                    color=shade[monitor],
                    label=monitor,
                )
            axes.set_ylim(0, 1.03)
            axes.set_xlabel(f"limit of {name}")
        line[0].set_ylabel(f"{short(task)}\ncompletion rate")
    figure.legend(
        *panels[0][0].get_legend_handles_labels(),
        frameon=False,
        loc="outside upper center",
        ncols=len(monitors),
    )
    return figure


def accuracy_curves(found: Mapping[str, Mapping[str, Curve]]) -> Figure:
    """Completion against the accuracy of answers, and where each curve crosses TP's."""
    pyplot = styled_pyplot()
    figure, panels = pyplot.subplots(
        1, len(found), figsize=(0.8 + 3.2 * len(found), 3.3), sharey=True, squeeze=False
    )
    monitors = list(dict.fromkeys(monitor for own in found.values() for monitor in own))
    shade = colours(monitors)
    for axes, (task, own) in zip(panels[0], found.items(), strict=True):
        level = own.get("tp", own.get("none"))
        for monitor, curve in own.items():
            blind = monitor in ("tp", "none")
            axes.plot(
                list(curve),
                list(curve.values()),
                color=shade[monitor],
                linestyle="--" if blind else "-",
                marker=None if blind else "o",
                markersize=3,
                label=monitor,
            )
            if level is not None and not blind:
                at = crossing(curve, next(iter(level.values())))
                if at is not None and at > min(curve):
                    axes.plot(
                        [at],
                        [next(iter(level.values()))],
                        marker="x",
                        markersize=7,
                        markeredgewidth=2,
                        color=shade[monitor],
                    )
        axes.set_title(task)
        axes.set_xlabel("accuracy of answers")
        axes.set_ylim(0, 1.03)
    panels[0][0].set_ylabel("completion rate")
    figure.legend(
        *panels[0][0].get_legend_handles_labels(),
        frameon=False,
        loc="outside upper center",
        ncols=len(monitors),
    )
    return figure


def saved(figure: Figure, kind: str) -> bytes:
    """A figure as "svg" or "png"; the same figure gives the same bytes."""
    buffer = BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    figure.savefig(buffer, format=kind, dpi=160, metadata=metadata)
    return buffer.getvalue()


def close(figure: Figure) -> None:
    """Free a figure."""
    styled_pyplot().close(figure)
