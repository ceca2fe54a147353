"""How good the answers of one VLM are, with intervals that heed what hangs together."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.bench.vlms.asking import Row
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import auroc, calibration_error, log_loss

SAMPLES = 1000
"""Bootstrap samples."""
LEAST = 2
"""Clusters, below which there is no interval."""
Indices = NDArray[np.int64]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure with its 95% interval.

    Attributes:
        value: The figure; None where there is nothing to count.
        low: Of the interval; None where too little hangs apart to tell.
        high: The same.
    """

    value: float | None
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True, slots=True)
class Score:
    """Figures over some answers of one VLM; see `vlm.metrics.Metrics` for what they mean.

    Attributes:
        answers: How many, abstentions included.
        clusters: How many independent groups of looks they are of.
        accuracy: Right answers; abstentions count as wrong.
        balanced_accuracy: Mean of that where yes and where no is right.
        auroc: Of P(yes).
        calibration_error: Expected, of P(yes), in 10 bins.
        log_loss: Of P(yes), in nats.
        abstained: Share of *cannot see* and *unknown*.
        seconds: Each, when it was asked.
    """

    answers: int
    clusters: int
    accuracy: Estimate
    balanced_accuracy: Estimate
    auroc: Estimate
    calibration_error: Estimate
    log_loss: Estimate
    abstained: Estimate
    seconds: Estimate


FIGURES = (
    "accuracy",
    "balanced_accuracy",
    "auroc",
    "calibration_error",
    "log_loss",
    "abstained",
    "seconds",
)


class Columns:
    """Answers as arrays."""

    def __init__(self, rows: Sequence[Row]):
        self.truth = np.array([row.truth for row in rows], bool)
        self.yes = np.array([row.reply is Reply.YES for row in rows], bool)
        self.no = np.array([row.reply is Reply.NO for row in rows], bool)
        self.right = np.where(self.truth, self.yes, self.no)
        told = [np.nan if row.p_yes is None else row.p_yes for row in rows]
        self.p_yes = np.array(told, float)
        self.seconds = np.array([row.seconds for row in rows], float)

    def figures(self, at: Indices) -> Floats:
        """`FIGURES` over some of the answers; NaN where there is nothing to count."""
        truth, right = self.truth[at], self.right[at]
        p_yes = self.p_yes[at]
        told = ~np.isnan(p_yes)
        p, of_told = p_yes[told], truth[told]
        found = (
            _mean(right),
            (_mean(right[truth]) + _mean(right[~truth])) / 2,
            auroc(p, of_told),
            calibration_error(p, of_told),
            log_loss(p, of_told),
            _mean(~(self.yes[at] | self.no[at])),
            _mean(self.seconds[at]),
        )
        return np.array([np.nan if value is None else value for value in found])


def _mean(values: NDArray[np.bool_] | Floats) -> float:
    return float(values.mean()) if len(values) else float("nan")


def clusters_of(rows: Sequence[Row]) -> list[Indices]:
    """Where the answers of each cluster stand."""
    places: dict[str, list[int]] = {}
    for place, row in enumerate(rows):
        places.setdefault(row.cluster, []).append(place)
    return [np.array(found, np.int64) for _, found in sorted(places.items())]


def resampled(
    statistic: Callable[[Indices], Floats], clusters: Sequence[Indices], *, seed: int
) -> list[Estimate]:
    """Figures with 95% intervals: whole clusters are drawn anew, with replacement.

    Percentiles of the bootstrap (Efron 1979), of clusters as Davison and Hinkley 1997, 3.8.

    Args:
        statistic: Figures over the answers at some places, each perhaps several times.
        clusters: Where the answers of each cluster stand.
        seed: Decides the draws.
    """
    whole = statistic(np.concatenate(clusters) if clusters else np.empty(0, np.int64))
    if len(clusters) < LEAST:
        return [_estimate(value) for value in whole]
    draws = np.random.default_rng(seed)
    samples = np.array(
        [
            statistic(np.concatenate([clusters[k] for k in drawn]))
            for drawn in draws.integers(0, len(clusters), (SAMPLES, len(clusters)))
        ]
    )
    found = []
    for value, column in zip(whole, samples.T, strict=True):
        known = column[~np.isnan(column)]
        if np.isnan(value) or len(known) < SAMPLES // 2:
            found.append(_estimate(value))
            continue
        low, high = np.percentile(known, (2.5, 97.5))
        found.append(Estimate(float(value), float(low), float(high)))
    return found


def _estimate(value: float) -> Estimate:
    return Estimate(None if np.isnan(value) else float(value))


def score(rows: Sequence[Row], *, seed: int = 0) -> Score:
    """The figures of some answers of one VLM."""
    columns, clusters = Columns(rows), clusters_of(rows)
    found = resampled(columns.figures, clusters, seed=seed)
    return Score(len(rows), len(clusters), *found)


@dataclass(frozen=True, slots=True)
class Difference:
    """How much better one way of answering is than another, on the same questions.

    Attributes:
        first: What is compared.
        second: With what.
        pairs: Questions that both were asked.
        accuracy: The difference of the accuracies, first less second.
        balanced_accuracy: The same of the balanced ones.
    """

    first: str
    second: str
    pairs: int
    accuracy: Estimate
    balanced_accuracy: Estimate


Key = tuple[str, str, str, str, int]


def difference(
    first: Sequence[Row], second: Sequence[Row], names: tuple[str, str], *, seed: int = 0
) -> Difference | None:
    """Two ways of answering on the questions that both were asked; None without any.

    Args:
        first: Answers of one.
        second: Answers of the other.
        names: What they are called.
        seed: Decides the draws.
    """
    other: Mapping[Key, Row] = {_key(row): row for row in second}
    pairs = [(row, other[_key(row)]) for row in first if _key(row) in other]
    if not pairs:
        return None
    one, two = (Columns(list(side)) for side in zip(*pairs, strict=True))
    truth, gain = one.truth, one.right.astype(float) - two.right

    def gains(at: Indices) -> Floats:
        known, gained = truth[at], gain[at]
        return np.array([_mean(gained), (_mean(gained[known]) + _mean(gained[~known])) / 2])

    found = resampled(gains, clusters_of([row for row, _ in pairs]), seed=seed)
    return Difference(*names, len(pairs), *found)


def _key(row: Row) -> Key:
    return row.look, row.way, row.fact, row.predicate, row.repeat
