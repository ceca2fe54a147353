"""How good yes/no answers are, from rows of answer and truth."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.vlm.answer import Reply


@dataclass(frozen=True, slots=True)
class Scored:
    """An answer beside the truth.

    Attributes:
        reply: What the VLM said.
        truth: Whether yes is right.
        p_yes: Its P(yes); None where it gave none.
        visible: Whether the picture shows it.
        hard: Whether no is right although the thing asked about is in view.
        count: How many such answers there are.
    """

    reply: Reply
    truth: bool
    p_yes: float | None = None
    visible: bool = True
    hard: bool = False
    count: int = 1


@dataclass(frozen=True, slots=True)
class Metrics:
    """Figures over answers; None where there is nothing to count.

    Attributes:
        visible: Questions whose answer the picture shows. All rates but `cannot_see_rightly`
            are over these.
        accuracy: Right answers; *cannot see* and *unknown* count as wrong here.
        balanced_accuracy: Mean of the accuracies where yes and where no is right.
        false_positive_rate: Yes where no is right.
        false_negative_rate: No where yes is right.
        auroc: Probability that P(yes) is higher for a random yes than for a random no.
        calibration_error: Expected calibration error of P(yes) in 10 bins, weighted by count.
        abstained: *Cannot see* and *unknown* although the picture shows it.
        hard_no: Right answers where no is right though the thing asked about is in view.
        hidden: Questions whose answer the picture does not show.
        cannot_see_rightly: *Cannot see* among these.
    """

    visible: int
    accuracy: float | None
    balanced_accuracy: float | None
    false_positive_rate: float | None
    false_negative_rate: float | None
    auroc: float | None
    calibration_error: float | None
    abstained: float | None
    hard_no: float | None
    hidden: int
    cannot_see_rightly: float | None


def measure(rows: Iterable[Scored]) -> Metrics:
    """The figures of a set of answers."""
    every = list(rows)
    shown = [row for row in every if row.visible]
    hidden = [row for row in every if not row.visible]
    counts = _counts(shown)
    truth = np.array([row.truth for row in shown], bool)
    said_yes = np.array([row.reply is Reply.YES for row in shown], bool)
    said_no = np.array([row.reply is Reply.NO for row in shown], bool)
    right = np.where(truth, said_yes, said_no).astype(bool)
    hard = np.array([row.hard for row in shown], bool)
    told = [row for row in shown if row.p_yes is not None]
    p_yes = np.array([row.p_yes for row in told], float)
    told_truth = np.array([row.truth for row in told], bool)
    cannot_see = np.array([row.reply is Reply.CANNOT_SEE for row in hidden], bool)
    on_yes = _rate(right[truth], counts[truth])
    on_no = _rate(right[~truth], counts[~truth])
    return Metrics(
        visible=int(counts.sum()),
        accuracy=_rate(right, counts),
        balanced_accuracy=None if on_yes is None or on_no is None else (on_yes + on_no) / 2,
        false_positive_rate=_rate(said_yes[~truth], counts[~truth]),
        false_negative_rate=_rate(said_no[truth], counts[truth]),
        auroc=auroc(p_yes, told_truth, _counts(told)),
        calibration_error=calibration_error(p_yes, told_truth, _counts(told)),
        abstained=_rate(~(said_yes | said_no), counts),
        hard_no=_rate(right[hard], counts[hard]),
        hidden=int(_counts(hidden).sum()),
        cannot_see_rightly=_rate(cannot_see, _counts(hidden)),
    )


def _counts(rows: Sequence[Scored]) -> NDArray[np.int64]:
    return np.array([row.count for row in rows], np.int64)


def _rate(hits: NDArray[np.bool_], counts: NDArray[np.int64]) -> float | None:
    total = int(counts.sum())
    return int(counts[hits].sum()) / total if total else None


def auroc(
    scores: NDArray[np.float64],
    truth: NDArray[np.bool_],
    counts: NDArray[np.int64] | None = None,
) -> float | None:
    """Area under the ROC curve; ties count half. None where one class is missing.

    Args:
        scores: One for each answer, or for so many alike.
        truth: Whether yes is right.
        counts: How many answers each stands for; None for one.
    """
    counts = np.ones(len(truth), np.int64) if counts is None else counts
    positive = int(counts[truth].sum())
    negative = int(counts.sum()) - positive
    if not positive or not negative:
        return None
    _, place = np.unique(scores, return_inverse=True)
    alike = np.bincount(place, weights=counts)
    ranks = (np.cumsum(alike) - (alike - 1) / 2)[place]
    above = (ranks[truth] * counts[truth]).sum() - positive * (positive + 1) / 2
    return float(above / (positive * negative))


def calibration_error(
    p_yes: NDArray[np.float64],
    truth: NDArray[np.bool_],
    counts: NDArray[np.int64] | None = None,
    *,
    bins: int = 10,
) -> float | None:
    """Expected calibration error of P(yes): |mean P(yes) - share of yes|, over equal bins.

    Args:
        p_yes: One for each answer, or for so many alike.
        truth: Whether yes is right.
        counts: How many answers each stands for; None for one.
        bins: How many.
    """
    counts = np.ones(len(truth), np.int64) if counts is None else counts
    if not counts.sum():
        return None
    bin_of = np.minimum((p_yes * bins).astype(int), bins - 1)
    total = 0.0
    for b in range(bins):
        inside = bin_of == b
        weight = counts[inside]
        if weight.sum():
            gap = np.average(p_yes[inside], weights=weight) - np.average(
                truth[inside], weights=weight
            )
            total += weight.sum() / counts.sum() * abs(gap)
    return float(total)


NEAREST = 1e-4
"""To 0 or 1 of a probability in the log loss: one wrong certainty would decide it."""


def log_loss(p_yes: NDArray[np.float64], truth: NDArray[np.bool_]) -> float | None:
    """Mean negative log-likelihood of the truth, in nats; None where there is none."""
    if not len(truth):
        return None
    p = np.clip(p_yes, NEAREST, 1 - NEAREST)
    return float(-np.log(np.where(truth, p, 1 - p)).mean())
