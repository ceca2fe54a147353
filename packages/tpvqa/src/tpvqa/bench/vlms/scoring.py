"""How good the answers of one VLM are, with intervals that heed what hangs together."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.bench.vlms.asking import Row
from tpvqa.bench.vlms.lasting import LEAST, SAMPLES
from tpvqa.vlm import Reply
from tpvqa.vlm.metrics import NEAREST

BINS = 10
"""Of the calibration error, as in `vlm.metrics`."""
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
        when_answered: Right answers among yes and no.
        balanced_accuracy: Mean of the accuracies where yes and where no is right.
        auroc: Of P(yes).
        calibration_error: Expected, of P(yes), in 10 bins.
        log_loss: Of P(yes), in nats.
        abstained: Share of *cannot see* and *unknown*.
        seconds: Each, when it was asked.
    """

    answers: int
    clusters: int
    accuracy: Estimate
    when_answered: Estimate
    balanced_accuracy: Estimate
    auroc: Estimate
    calibration_error: Estimate
    log_loss: Estimate
    abstained: Estimate
    seconds: Estimate


def score(rows: Sequence[Row], *, seed: int = 0) -> Score:
    """The figures of some answers of one VLM.

    Intervals are percentiles of a bootstrap that draws whole clusters anew (Davison and Hinkley
    1997, 3.8).

    Args:
        rows: The answers.
        seed: Decides the draws.
    """
    cluster, count = _clusters([row.cluster for row in rows])
    weights = _weights(count, seed)
    truth = np.array([row.truth for row in rows], bool)
    yes = np.array([row.reply is Reply.YES for row in rows], bool)
    answered = yes | np.array([row.reply is Reply.NO for row in rows], bool)
    right = np.where(truth, yes, answered & ~yes)
    p_yes = np.array([np.nan if row.p_yes is None else row.p_yes for row in rows], float)
    told = ~np.isnan(p_yes)
    p = np.where(told, p_yes, 0.5)
    near = np.clip(p, NEAREST, 1 - NEAREST)
    seconds = np.array([row.seconds for row in rows], float)

    def summed(values: NDArray[np.bool_] | Floats) -> Floats:
        """The sum of a column in every sample."""
        return weights @ np.bincount(cluster, values.astype(float), count)

    every = summed(np.ones(len(rows)))
    surprise = np.where(told, -np.log(np.where(truth, near, 1 - near)), 0.0)
    found = (
        _ratio(summed(right), every),
        _ratio(summed(right), summed(answered)),
        _balanced(summed, right.astype(float), truth),
        _auroc(weights, cluster[told], p[told], truth[told]),
        _calibration(summed, p, truth, told),
        _ratio(summed(surprise), summed(told)),
        _ratio(summed(~answered), every),
        _ratio(summed(seconds), every),
    )
    return Score(len(rows), count, *map(_estimate, found))


def _clusters(names: Sequence[str]) -> tuple[NDArray[np.int64], int]:
    """The number of the cluster of each answer, and how many clusters there are."""
    known, numbers = np.unique(np.array(names), return_inverse=True)
    return numbers.astype(np.int64), len(known)


def _weights(clusters: int, seed: int) -> Floats:
    """How often each cluster counts: once in the first row, as drawn in the others."""
    whole = np.ones((1, clusters))
    if clusters < LEAST:
        return whole
    drawn = np.random.default_rng(seed).multinomial(clusters, whole[0] / clusters, SAMPLES)
    return np.concatenate([whole, drawn])


def _ratio(hits: Floats, of: Floats) -> Floats:
    found = np.full(len(of), np.nan)
    np.divide(hits, of, out=found, where=of > 0)
    return found


def _balanced(summed, right: Floats, truth: NDArray[np.bool_]) -> Floats:  # type: ignore[no-untyped-def]
    on_yes = _ratio(summed(right * truth), summed(truth))
    return (on_yes + _ratio(summed(right * ~truth), summed(~truth))) / 2


def _calibration(  # type: ignore[no-untyped-def]
    summed, p: Floats, truth: NDArray[np.bool_], told: NDArray[np.bool_]
) -> Floats:
    bin_of = np.minimum((p * BINS).astype(int), BINS - 1)
    inside = [told & (bin_of == b) for b in range(BINS)]
    gaps = sum(np.abs(summed(np.where(each, p - truth, 0.0))) for each in inside)
    return _ratio(np.asarray(gaps, float), summed(told))


def _auroc(
    weights: Floats, cluster: NDArray[np.int64], p: Floats, truth: NDArray[np.bool_]
) -> Floats:
    """Area under the ROC curve in every sample; ties count half."""
    levels, level = np.unique(p, return_inverse=True)
    found = np.full(len(weights), np.nan)
    for place, sample in enumerate(weights):
        weight = sample[cluster]
        yes = np.bincount(level, weight * truth, len(levels))
        no = np.bincount(level, weight * ~truth, len(levels))
        total = yes.sum() * no.sum()
        if total:
            found[place] = yes @ (np.cumsum(no) - no / 2) / total
    return found


def _estimate(samples: Floats) -> Estimate:
    """Of a figure in the whole and in every sample."""
    value, drawn = samples[0], samples[1:]
    if np.isnan(value):
        return Estimate(None)
    known = drawn[~np.isnan(drawn)]
    if not len(drawn) or len(known) < len(drawn) / 2:
        return Estimate(float(value))
    low, high = np.percentile(known, (2.5, 97.5))
    return Estimate(float(value), float(low), float(high))


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

    @property
    def merit(self) -> Estimate:
        """The balanced one, where yes and no are both right at times."""
        return self.accuracy if self.balanced_accuracy.value is None else self.balanced_accuracy


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
    cluster, count = _clusters([row.cluster for row, _ in pairs])
    weights = _weights(count, seed)
    truth = np.array([row.truth for row, _ in pairs], bool)
    gain = np.array([float(_right(one)) - _right(two) for one, two in pairs])

    def summed(values: NDArray[np.bool_] | Floats) -> Floats:
        return weights @ np.bincount(cluster, values.astype(float), count)

    plain = _ratio(summed(gain), summed(np.ones(len(pairs))))
    balanced = _balanced(summed, gain, truth)
    return Difference(*names, len(pairs), _estimate(plain), _estimate(balanced))


def _right(row: Row) -> bool:
    return row.reply is (Reply.YES if row.truth else Reply.NO)


def _key(row: Row) -> Key:
    return row.look, row.way, row.fact, row.predicate, row.repeat
