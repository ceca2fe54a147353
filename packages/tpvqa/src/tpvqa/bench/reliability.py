"""Reliability of P(yes) before and after a calibration: in figures, and as a picture."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief import LabelledAnswer
from tpvqa.belief.calibrating.fitting import telling
from tpvqa.belief.calibrating.held_out import HeldOut
from tpvqa.belief.calibrating.runs import runs
from tpvqa.bench.figures import Figure
from tpvqa.bench.statistics import wilson
from tpvqa.bench.style import styled_pyplot
from tpvqa.questions import Way
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import calibration_error

BINS = 10
_FEW = 10
"""Answers that tell nothing yet."""
_CHANCE = 0.1
"""How much more often yes is to be said where it is right, for answers to tell something."""
_WORSE = 0.02
"""Of the calibration error: what a calibration may lose by chance."""
_NAMED = 3
_WITHOUT = "do without this calibration"
_WITHOUT_BUT = (
    "weigh what is lost without this calibration: its answers are better as the VLM says them, its "
    "counted faults and what sensors and reports are worth still help, and are used with it alone"
)
BEFORE, AFTER = "#d55e00", "#0072b2"


@dataclass(frozen=True, slots=True)
class Line:
    """The answers to questions of one kind; None where there is nothing to count.

    Attributes:
        way: The way of asking; None for all.
        predicate: The predicate, or the action where a whole action is asked about.
        answers: Answers that count, without abstentions.
        abstained: Share of abstentions.
        accuracy: Share of right answers.
        yes_if_true: Share of yes where yes is right.
        yes_if_false: Share of yes where no is right.
        error_before: Expected calibration error of the VLM's P(yes) (of its word, where it gives
            none).
        error_after: The same after calibration, on answers that it was not learnt from.
    """

    way: Way | None
    predicate: str | None
    answers: int
    abstained: float | None
    accuracy: float | None
    yes_if_true: float | None
    yes_if_false: float | None
    error_before: float | None
    error_after: float | None


def lines(
    rows: Sequence[LabelledAnswer], judged: Sequence[HeldOut], *, chosen_looks: bool
) -> list[Line]:
    """A line for every way and predicate, and a last one for all answers."""
    every, _ = telling(list(runs(rows)), chosen_looks=chosen_looks)
    kinds = sorted({(row.way, row.predicate) for row in every})
    return [_line(*kind, every, judged) for kind in kinds] + [_line(None, None, every, judged)]


def one_sided(table: Sequence[Line], remedy: str = "") -> list[str]:
    """Of which predicates labels say yes alone, or no alone, in sentences, and what to do.

    Args:
        table: As `lines` gives it.
        remedy: What to do; by default, what to label.
    """
    said = []
    for lacking, rate in (("no", "yes_if_false"), ("yes", "yes_if_true")):
        counted = [each for each in table if each.answers]
        told = {each.predicate for each in counted if getattr(each, rate) is not None}
        untold = dict.fromkeys(each.predicate for each in counted if each.predicate not in told)
        names = ["all questions"] if None in untold else [each for each in untold if each]
        if names:
            more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
            label = (
                f"Next, label looks at which {lacking} is right, as before and after the action "
                "that changes it."
            )
            said.append(
                f"no label says {lacking} of {', '.join(names[:_NAMED])}{more}: what the VLM "
                f"answers where {lacking} is right is not known. {remedy or label}"
            )
    return said


def doubts(whole: Line, *, besides: bool = False) -> list[str]:
    """Why a calibration may do harm, in sentences; none where nothing speaks for that.

    Args:
        whole: The line for all answers.
        besides: Whether it also tells of faults, sensors or skills.
    """
    if whole.answers < _FEW:
        return []
    yes_if_true, yes_if_false = whole.yes_if_true, whole.yes_if_false
    if yes_if_true is not None and yes_if_false is not None and yes_if_true < yes_if_false:
        return [
            f"yes was said more often where no was right ({yes_if_false:.2f}) than where yes was "
            f"({yes_if_true:.2f}): the answers are taken to tell nothing. See that labels and "
            "questions are right, and that yes and no were not exchanged."
        ]
    if yes_if_true is not None and yes_if_false is not None:
        if yes_if_true - yes_if_false < _CHANCE:
            return [
                f"the answers are no better than chance: yes was said in {yes_if_true:.2f} where "
                f"it was right, and in {yes_if_false:.2f} where no was. Label more looks of what "
                "the pictures show well, both where yes and where no is right; where it stays so, "
                "ask in other words, or another VLM."
            ]
    elif whole.accuracy is not None and whole.accuracy < 0.5 + _CHANCE:
        return [
            f"the answers are no better than chance: {whole.accuracy:.2f} of them are right. "
            "See that labels and questions are right."
        ]
    before, after = whole.error_before, whole.error_after
    if before is not None and after is not None and after > before + _WORSE:
        return [
            f"calibrated, the answers are less reliable than as the VLM says them ({after:.3f} for "
            f"{before:.3f}): {whole.answers} answers are too few, or what is said to be right is "
            f"not. Give more, or {_WITHOUT_BUT if besides else _WITHOUT}."
        ]
    return []


def _line(
    way: Way | None,
    predicate: str | None,
    every: Sequence[LabelledAnswer],
    judged: Sequence[HeldOut],
) -> Line:
    def own(row: LabelledAnswer) -> bool:
        return way is None or (row.way, row.predicate) == (way, predicate)

    asked = [row for row in every if own(row)]
    found = [each for each in judged if own(each.row)]
    truth = np.array([each.row.truth for each in found], bool)
    yes = np.array([each.row.reply is Reply.YES for each in found], bool)
    before, after = probabilities(found)
    return Line(
        way=way,
        predicate=predicate,
        answers=len(found),
        abstained=_share(np.array([row.reply not in (Reply.YES, Reply.NO) for row in asked], bool)),
        accuracy=_share(yes == truth),
        yes_if_true=_share(yes[truth]),
        yes_if_false=_share(yes[~truth]),
        error_before=calibration_error(before, truth),
        error_after=None if after is None else calibration_error(after, truth),
    )


def probabilities(
    judged: Sequence[HeldOut],
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """P(yes) before and after; after is None where some answers have no other trials to learn
    from."""
    before = np.array([each.before for each in judged], float)
    after = [each.after for each in judged if each.after is not None]
    return before, np.array(after, float) if len(after) == len(judged) else None


def _share(hits: NDArray[np.bool_]) -> float | None:
    return float(hits.mean()) if len(hits) else None


def reliability_figure(judged: Sequence[HeldOut], vlm: str) -> Figure:
    """Reliability before and after, side by side, with how many answers say what.

    Args:
        judged: Answers, with what calibrations that did not know them make of them.
        vlm: Whose they are.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    # One answer that counts for two ways of asking is one answer here.
    once = list({(each.row.trial, each.row.look, each.row.text): each for each in judged}.values())
    before, after = probabilities(once)
    truth = np.array([each.row.truth for each in once], bool)
    panels = [("before: as the VLM says", before, BEFORE)]
    if after is not None:
        panels.append(("after: calibrated, on held-out trials", after, AFTER))
    pyplot = styled_pyplot()
    figure, axes = pyplot.subplots(
        2,
        len(panels),
        figsize=(0.6 + 4.2 * len(panels), 5.2),
        sharex=True,
        sharey="row",
        squeeze=False,
        height_ratios=(3.4, 1),
    )
    for (title, p, colour), (upper, lower) in zip(panels, axes.T, strict=True):
        _curve(upper, p, truth, colour)
        upper.set_title(title, loc="left", fontsize=12, fontweight="bold", pad=22)
        upper.annotate(
            f"calibration error {calibration_error(p, truth):.3f}",
            (0, 1),
            xytext=(0, 6),
            xycoords="axes fraction",
            textcoords="offset points",
            fontsize=11,
        )
        lower.hist(p, bins=BINS, range=(0, 1), color=colour, rwidth=0.92)
        lower.set_yscale("log")
        lower.yaxis.set_major_formatter(lambda count, _: f"{count:,.0f}")
        lower.set_xlabel("P(yes)")
    axes[0][0].set_ylabel("share where yes is right")
    axes[1][0].set_ylabel("answers")
    figure.suptitle(f"{vlm}: {len(once):,} answers", fontsize=13)
    return figure


def _curve(axes: Figure, p: NDArray[np.float64], truth: NDArray[np.bool_], colour: str) -> None:
    """One reliability curve with 95% intervals of its bins."""
    axes.plot([0, 1], [0, 1], color="#b8bcc2", linewidth=1.2, linestyle=(0, (4, 3)), zorder=0)
    bin_of = np.minimum((p * BINS).astype(int), BINS - 1)
    inside = [bin_of == b for b in range(BINS) if (bin_of == b).any()]
    x = np.array([p[each].mean() for each in inside])
    y = np.array([truth[each].mean() for each in inside])
    low, high = np.array([_interval(int(truth[each].sum()), int(each.sum())) for each in inside]).T
    axes.vlines(x, low, high, color=colour, linewidth=2.2, alpha=0.35)
    axes.plot(x, y, color=colour, linewidth=2.2, marker="o", markersize=6)
    axes.set_xlim(-0.02, 1.02)
    axes.set_ylim(-0.02, 1.02)
    axes.grid(color="#eceef1", linewidth=0.8)
    axes.set_axisbelow(True)


def _interval(hits: int, count: int) -> tuple[float, float]:
    found = wilson(hits, count)
    return found.low, found.high
