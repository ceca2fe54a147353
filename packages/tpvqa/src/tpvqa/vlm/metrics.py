"""How good yes/no answers are, from rows of answer and truth."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.vlm.answer import Reply


@dataclass(frozen=True, slots=True)
class Scored:
    """One answer beside the truth.

    Attributes:
        reply: What the VLM said.
        truth: Whether yes is right.
        p_yes: Its P(yes); None where it gave none.
        visible: Whether the picture shows it.
        hard: Whether no is right although the thing asked about is in view.
    """

    reply: Reply
    truth: bool
    p_yes: float | None = None
    visible: bool = True
    hard: bool = False


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
    truth = np.array([row.truth for row in shown], bool)
    said_yes = np.array([row.reply is Reply.YES for row in shown], bool)
    said_no = np.array([row.reply is Reply.NO for row in shown], bool)
    right = np.where(truth, said_yes, said_no).astype(bool)
    hard = np.array([row.hard for row in shown], bool)
    told = [row for row in shown if row.p_yes is not None]
    p_yes = np.array([row.p_yes for row in told], float)
    told_truth = np.array([row.truth for row in told], bool)
    on_yes, on_no = _rate(right[truth]), _rate(right[~truth])
    return Metrics(
        visible=len(shown),
        accuracy=_rate(right),
        balanced_accuracy=None if on_yes is None or on_no is None else (on_yes + on_no) / 2,
        false_positive_rate=_rate(said_yes[~truth]),
        false_negative_rate=_rate(said_no[truth]),
        auroc=auroc(p_yes, told_truth),
        calibration_error=calibration_error(p_yes, told_truth),
        abstained=_rate(~(said_yes | said_no)),
        hard_no=_rate(right[hard]),
        hidden=len(hidden),
        cannot_see_rightly=_rate(np.array([row.reply is Reply.CANNOT_SEE for row in hidden], bool)),
    )


def _rate(hits: NDArray[np.bool_]) -> float | None:
    return float(hits.mean()) if len(hits) else None


def auroc(scores: NDArray[np.float64], truth: NDArray[np.bool_]) -> float | None:
    """Area under the ROC curve; ties count half. None where one class is missing."""
    positive = int(truth.sum())
    negative = len(truth) - positive
    if not positive or not negative:
        return None
    _, place, counts = np.unique(scores, return_inverse=True, return_counts=True)
    ranks = (np.cumsum(counts) - (counts - 1) / 2)[place]
    return float((ranks[truth].sum() - positive * (positive + 1) / 2) / (positive * negative))


def calibration_error(
    p_yes: NDArray[np.float64], truth: NDArray[np.bool_], *, bins: int = 10
) -> float | None:
    """Expected calibration error of P(yes): |mean P(yes) - share of yes|, over equal bins."""
    if not len(truth):
        return None
    bin_of = np.minimum((p_yes * bins).astype(int), bins - 1)
    total = 0.0
    for b in range(bins):
        inside = bin_of == b
        if inside.any():
            total += inside.mean() * abs(p_yes[inside].mean() - truth[inside].mean())
    return float(total)


NEAREST = 1e-4
"""To 0 or 1 of a probability in the log loss: one wrong certainty would decide it."""


def log_loss(p_yes: NDArray[np.float64], truth: NDArray[np.bool_]) -> float | None:
    """Mean negative log-likelihood of the truth, in nats; None where there is none."""
    if not len(truth):
        return None
    p = np.clip(p_yes, NEAREST, 1 - NEAREST)
    return float(-np.log(np.where(truth, p, 1 - p)).mean())
