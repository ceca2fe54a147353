"""Logistic regression on features that are there or not, with a normal prior on every weight."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
STEPS = 20
ENOUGH = 0.02


def logistic(
    present: NDArray[np.int64],
    yes: Array,
    counts: Array,
    *,
    mean: Array,
    width: Array,
) -> Array:
    """The most probable weights, by Newton's method.

    Args:
        present: The features of every answer; (answers, most features), and the number of features
            where a place is empty.
        yes: 1 where the answer is yes.
        counts: How much each answer counts.
        mean: Where each weight is expected; (features,).
        width: Standard deviation of each around that; (features,).
    """
    # A feature that is nowhere keeps the weight that it is expected to have.
    met = np.setdiff1d(present, [len(mean)])
    places = np.full(len(mean) + 1, len(met))
    places[met] = np.arange(len(met))
    found = mean.copy()
    found[met] = _newton(places[present], yes, counts, mean[met], width[met])
    return found


def _newton(
    present: NDArray[np.int64], yes: Array, counts: Array, mean: Array, width: Array
) -> Array:
    size, across = len(mean) + 1, present.shape[1]
    prior = np.append(mean, 0.0)
    precision = np.append(width**-2.0, 1.0)
    pairs = (present[:, :, None] * size + present[:, None, :]).ravel()

    def cost(weights: Array) -> float:
        odds = weights[present].sum(axis=1)
        unlikely = np.logaddexp(0.0, odds) - yes * odds
        return float(counts @ unlikely + precision @ (weights - prior) ** 2 / 2)

    weights = prior.copy()
    least = cost(weights)
    for _ in range(STEPS):
        p = np.exp(-np.logaddexp(0.0, -weights[present].sum(axis=1)))
        gradient = np.bincount(present.ravel(), np.repeat(counts * (p - yes), across), size)
        curved = np.repeat(counts * p * (1 - p), across * across)
        hessian = np.bincount(pairs, curved, size * size).reshape(size, size)
        # The empty place has no weight.
        gradient[-1] = hessian[-1, :] = hessian[:, -1] = 0.0
        gradient += precision * (weights - prior)
        hessian[np.diag_indices(size)] += precision
        step = np.linalg.solve(hessian, gradient)
        # A whole step may go too far where answers are far from what is expected.
        while (found := cost(weights - step)) > least and np.abs(step).max() > ENOUGH:
            step /= 2
        weights, least = weights - step, found
        if np.abs(step).max() < ENOUGH:
            break
    return weights[:-1]
