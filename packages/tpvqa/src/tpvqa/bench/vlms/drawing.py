"""The figure of a comparison: every figure with its interval, and accuracy by predicate."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from tpvqa.bench.figures import GRID, INK, Figure
from tpvqa.bench.style import styled_pyplot
from tpvqa.bench.vlms.comparing import Comparison, OfVLM
from tpvqa.bench.vlms.lasting import Lasting
from tpvqa.bench.vlms.scoring import Estimate, Score

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5230", "#882255")
"""Of VLMs, from the palette of Okabe and Ito (2008)."""
MARKERS = ("o", "s", "D", "^", "v", "P", "X", "<")
_PANELS = (
    ("accuracy", "accuracy", True),
    ("balanced_accuracy", "balanced accuracy", True),
    ("auroc", "AUROC", True),
    ("calibration_error", "calibration error", False),
    ("abstained", "abstained", False),
)
_MOST = 12
"""Parts that fit beside each other."""


@dataclass(frozen=True, slots=True)
class Line:
    """What is drawn in one colour: a VLM, or a VLM in one wording.

    Attributes:
        name: What it is called.
        score: Its figures.
        lasting: How far its errors last.
        predicates: Accuracy by predicate.
    """

    name: str
    score: Score
    lasting: Lasting
    predicates: Mapping[str, Estimate]


def lines_of(found: Comparison) -> list[Line]:
    """The VLMs; where there are several wordings each VLM once in each, as they are no one VLM's
    answers to one question."""
    lines: list[Line] = []
    for vlm in found.vlms:
        known = {part.name: part.score.accuracy for part in vlm.parts if part.by == "predicate"}
        worded = [each for each in found.wordings if each.vlm == vlm.vlm]
        named = [(each, each.lasting) for each in worded if each.predicate is None]
        for whole, lasting in named:
            own = {
                each.predicate: each.score.accuracy
                for each in worded
                if each.predicate is not None and each.wording == whole.wording
            }
            if lasting is not None:
                name = f"{_short(vlm.vlm)}, {_short(whole.wording)}"
                lines.append(Line(name, whole.score, lasting, known | own))
        if not named:
            lines.append(Line(_short(vlm.vlm), vlm.score, vlm.lasting, known))
    return lines


def comparison_figure(found: Comparison) -> Figure:
    """Every figure of every VLM with its 95% interval; below, accuracy by predicate.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    pyplot = styled_pyplot()
    names, lines = _parts(found.vlms), lines_of(found)
    looks = list(zip(lines, _cycled(COLOURS, lines), _cycled(MARKERS, lines), strict=True))
    height = 1.5 + 0.42 * len(lines)
    lower = 3.6 if names else 0.0
    figure = pyplot.figure(figsize=(13.33, height + lower + 0.6))
    upper, *rest = (
        figure.subfigures(2, 1, height_ratios=(height, lower)) if names else (figure.subfigures(),)
    )
    panels = upper.subplots(1, len(_PANELS) + 1, sharey=True)
    for axes, (key, title, up) in zip(panels, (*_PANELS, ("", "errors that last", False))):  # noqa: B905
        for place, (line, colour, marker) in enumerate(looks):
            told = getattr(line.score, key) if key else _lasting(line)
            _dot(axes, told, place, colour, marker)
        axes.set_title(f"{title}\n{'higher' if up else 'lower'} is better", fontsize=11, color=INK)
        axes.set_xlim(-0.03, 1.03)
        axes.set_xticks([0, 0.5, 1], ["0", ".5", "1"])
        axes.xaxis.grid(color=GRID, linewidth=0.8)
        axes.set_axisbelow(True)
        axes.tick_params(length=0)
        axes.spines["left"].set_visible(False)
    panels[0].set_yticks(range(len(lines)), [line.name for line in lines])
    panels[0].set_ylim(len(lines) - 0.4, -0.6)
    told = found.vlms[0].score.accuracy.low is not None
    figure.suptitle(
        f"{found.of}: {found.looks:,} looks, {found.vlms[0].score.answers:,} questions, "
        + (f"95% intervals over {found.clusters} groups of looks" if told else "no intervals"),
        fontsize=13,
        x=0.01,
        ha="left",
    )
    if names:
        _by_predicate(rest[0].subplots(), looks, names)
    return figure


def _parts(vlms: Sequence[OfVLM]) -> list[str]:
    """The predicates with the most answers."""
    counts: dict[str, int] = {}
    for vlm in vlms:
        for part in vlm.parts:
            if part.by == "predicate":
                counts[part.name] = counts.get(part.name, 0) + part.score.answers
    return sorted(counts, key=lambda name: -counts[name])[:_MOST]


def _by_predicate(axes: Any, looks: Sequence[tuple[Line, str, str]], names: Sequence[str]) -> None:
    step = 0.7 / max(len(looks), 1)
    for k, (line, colour, marker) in enumerate(looks):
        for place, name in enumerate(names):
            if name in line.predicates:
                at = place + (k - (len(looks) - 1) / 2) * step
                _dot(axes, line.predicates[name], at, colour, marker, upright=True)
        axes.plot([], [], color=colour, marker=marker, linestyle="none", label=line.name)
    axes.set_xticks(range(len(names)), names)
    axes.set_xlim(-0.6, len(names) - 0.4)
    axes.set_ylim(-0.03, 1.05)
    axes.set_ylabel("accuracy by predicate")
    axes.yaxis.grid(color=GRID, linewidth=0.8)
    axes.set_axisbelow(True)
    axes.tick_params(axis="x", length=0)
    axes.legend(frameon=False, loc="center left", bbox_to_anchor=(1, 0.5))


def _dot(
    axes: Any, told: Estimate, place: float, colour: str, marker: str, *, upright: bool = False
) -> None:
    """A figure with its interval; a dash where there is none."""
    if told.value is None:
        axes.text(*((place, 0.5) if upright else (0.5, place)), "–", ha="center", va="center")
        return
    line = axes.vlines if upright else axes.hlines
    if told.low is not None:
        line(place, told.low, told.high, color=colour, linewidth=3, alpha=0.35)
    x, y = (place, told.value) if upright else (told.value, place)
    axes.plot([x], [y], marker=marker, color=colour, markersize=7, linestyle="none")
    if not upright:
        left = told.value > 0.5
        axes.annotate(
            _said(told.value),
            (x, y),
            xytext=(0, 9),
            textcoords="offset points",
            ha="right" if left else "left",
            fontsize=10,
            color=INK,
        )


def _lasting(line: Line) -> Estimate:
    found = line.lasting
    return Estimate(found.share, found.low, found.high)


def _said(value: float) -> str:
    said = f"{value:.{2 if 0.015 <= value <= 0.985 or value in (0, 1) else 3}f}"
    return said[1:] if said.startswith("0") else said


def _short(vlm: str) -> str:
    return vlm if len(vlm) <= 30 else f"{vlm[:20]}…{vlm[-9:]}"


def _cycled(values: Sequence[str], lines: Sequence[Line]) -> list[str]:
    return [values[k % len(values)] for k, _ in enumerate(lines)]
