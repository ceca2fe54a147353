"""Heads for a user's questions: logistic regression on the frozen branch, from few pictures."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.taught.sight import WIDE
from tpvqa_household.teaching.logistic import Array, even, fitted
from tpvqa_household.teaching.sureness import slopes

STRENGTHS = (1.0, 10.0, 100.0, 1000.0)
"""Inverse penalties that are tried on what is held back."""
FOLDS = 5
_DIRECTIONS = 512
"""In which pictures differ most; what differs in no other is left out."""
_MOST_ROWS = 1500
"""Views from which the directions are found."""
_SHRUNK = 0.1
"""Share of the mean spread that is added to each feature's, so that a rare one is not blown up."""
_COMMON = 20.0
"""How many pictures the mean of all heads weighs in the choice of one head's strength."""


@dataclass(frozen=True)
class Fit:
    """Heads, their log odds as sure as they were right on what was held back.

    Attributes:
        weights: Heads × features.
        bias: Of each head.
        held_back: n × heads, log odds of every picture by heads that neither it nor its group
            taught; nan where there is none.
        strengths: Of each head, that did best there.
    """

    weights: Floats
    bias: Floats
    held_back: Array
    strengths: Array


def folds_of(
    groups: NDArray[np.str_], seed: int, labels: NDArray[np.int64] | None = None
) -> NDArray[np.int64]:
    """A number below `FOLDS` for each picture, the same for a group.

    Args:
        groups: Of n pictures.
        seed: Decides which groups come together.
        labels: n: 1, 0, -1 for not known. With them groups with either answer are dealt out
            evenly: few groups with *yes* are not all in one fold.
    """
    names, of = np.unique(groups, return_inverse=True)
    order = chance_array(seed, 0, "folds of teaching").permutation(len(names))
    if labels is not None:
        yes, no = (np.bincount(of, labels == value, len(names)) > 0 for value in (1, 0))
        rank = np.select([yes & ~no, yes, no], [0, 1, 2], 3)
        order = order[np.argsort(rank[order], kind="stable")]
    place = np.empty(len(names), np.int64)
    place[order] = np.arange(len(names)) % FOLDS
    return np.asarray(place[of], np.int64)


class _Space:
    """Pictures in the directions in which they differ, and back."""

    def __init__(self, features: Floats):
        self.mean, spread = features.mean(0), features.std(0)
        counts = np.full(features.shape[1], float(features.shape[1] - WIDE))
        counts[:WIDE] = WIDE  # the whole picture weighs as much as all its parts
        scale = (spread + _SHRUNK * spread.mean() + 1e-6) * np.sqrt(counts)
        self.scale = scale.astype(np.float32)
        away = (features - self.mean) / self.scale
        some = away[:: -(-len(away) // _MOST_ROWS)]
        values, vectors = np.linalg.eigh((some @ some.T).astype(np.float64))
        kept = np.flatnonzero(values > 1e-6 * max(values[-1], 1e-9))[::-1][:_DIRECTIONS]
        roots = np.sqrt(values[kept])
        self._back = some.T @ (vectors[:, kept] / roots).astype(np.float32)
        self.places: Array = (away @ self._back).astype(np.float64)

    def outputs(self, coefficients: Array) -> tuple[Array, float]:
        """Weights and bias for what the branch gives."""
        weights = (self._back @ coefficients[:-1]) / self.scale
        return weights, float(coefficients[-1] - weights @ self.mean)


def fit_heads(
    features: Floats,
    labels: NDArray[np.int64],
    groups: NDArray[np.str_],
    *,
    seed: int = 0,
    done: Callable[[], None] = lambda: None,
) -> Fit:
    """Fit a head for each column of the labels.

    Args:
        features: Views × n × features; of the first view is what is held back.
        labels: n × heads: 1 for yes, 0 for no, -1 for not known. Each column has both.
        groups: Of each picture; what is held back in turn are whole groups.
        seed: Decides which.
        done: Called after each head.
    """
    views, count, wide = features.shape
    space = _Space(features.reshape(-1, wide))
    places = space.places.reshape(views, count, -1)
    tried = []
    for column in range(labels.shape[1]):
        folds = folds_of(groups, seed, labels[:, column])
        tried.append(_held_back(places, labels[:, column], folds))
        done()
    every = np.stack(tried, 2)  # strengths × n × heads
    chosen = _chosen(every, labels)
    held = np.stack([every[best, :, column] for column, best in enumerate(chosen)], 1)
    slope = slopes(held, labels)
    rows, offsets = [], []
    for column, best in enumerate(chosen):
        known = labels[:, column] >= 0
        found = _fitted(places[:, known], labels[known, column], STRENGTHS[best], None)
        weights, bias = space.outputs(found)
        rows.append(weights * slope[column])
        offsets.append(bias * slope[column])
    return Fit(
        np.stack(rows).astype(np.float32),
        np.array(offsets, np.float32),
        held * slope,
        np.array([STRENGTHS[best] for best in chosen]),
    )


def _held_back(x: Array, labels: NDArray[np.int64], folds: NDArray[np.int64]) -> Array:
    """Strengths × n: log odds of each picture by heads that its fold did not teach.

    Args:
        x: Views × n × directions.
        labels: n.
        folds: n.
    """
    found = np.full((len(STRENGTHS), len(labels)), np.nan)
    for fold in range(FOLDS):
        out = (folds == fold) & (labels >= 0)
        taught = (folds != fold) & (labels >= 0)
        y = labels[taught]
        if not out.any() or len(np.unique(y)) < 2:
            continue
        at = None
        for number, strength in enumerate(STRENGTHS):
            at = _fitted(x[:, taught], y, strength, at)
            found[number, out] = x[0, out] @ at[:-1] + at[-1]
    return found


def _fitted(x: Array, y: NDArray[np.int64], strength: float, start: Array | None) -> Array:
    """Coefficients from all views of pictures, which weigh as much as the pictures."""
    each = np.tile(y, len(x))
    rows = x.reshape(len(each), -1)
    return fitted(rows, each.astype(float), even(each, float(len(y))), strength, start)


def _chosen(every: Array, labels: NDArray[np.int64]) -> list[int]:
    """The best strength of each head: by its own pictures, and by those of all heads."""
    counted = (labels >= 0) & ~np.isnan(every)
    signed = np.where(labels == 1, every, -every)
    loss = np.logaddexp(0, -np.where(counted, signed, 0.0))
    sums, counts = np.where(counted, loss, 0.0).sum(1), counted.sum(1)
    common = sums.sum(1) / np.maximum(1, counts.sum(1))
    score = (sums + _COMMON * common[:, None]) / (counts + _COMMON)
    return [int(best) for best in score.argmin(0)]
