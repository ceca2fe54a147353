"""Logistic regression with a penalty, by Newton's method: few rows, few directions."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_STEPS = 50
_SMALL = 1e-8


def fitted(x: Array, y: Array, weight: Array, strength: float, start: Array | None = None) -> Array:
    """The coefficients that lessen Σ weight · log loss + |coefficients|² / (2 strength).

    Args:
        x: n × k.
        y: n, 1 for yes and 0 for no.
        weight: Of each row.
        strength: The inverse of the penalty, as scikit-learn's `C`. The bias goes unpunished.
        start: Where to begin; changes how long it takes, not where it ends.

    Returns:
        k coefficients and then the bias.
    """
    one = np.concatenate([x, np.ones((len(x), 1))], 1)
    penalty = np.full(one.shape[1], 1.0 / strength)
    penalty[-1] = 1e-9
    found = np.zeros(one.shape[1]) if start is None else start.copy()
    signs = np.where(y > 0.5, 1.0, -1.0)
    loss = _loss(found, one, signs, weight, penalty)
    for _ in range(_STEPS):
        chance = 1.0 / (1.0 + np.exp(-np.clip(one @ found, -60, 60)))
        slope = one.T @ (weight * (chance - y)) + penalty * found
        bend = (one * (weight * np.maximum(chance * (1 - chance), 1e-12))[:, None]).T @ one
        bend[np.diag_indices_from(bend)] += penalty
        step, share = np.linalg.solve(bend, slope), 1.0
        gain = float(slope @ step)
        while share > 1e-6:  # half as far, until it is no worse
            there = found - share * step
            new = _loss(there, one, signs, weight, penalty)
            if new <= loss - 1e-4 * share * gain:
                found, loss = there, new
                break
            share /= 2
        if gain < _SMALL * max(1.0, loss) or share <= 1e-6:
            break
    return found


def even(labels: NDArray[np.int64], total: float) -> Array:
    """Weights of rows, in all `total`, under which yes (1) and no (0) weigh the same."""
    weight = np.zeros(len(labels))
    for value in (0, 1):
        of = labels == value
        if of.any():
            weight[of] = total / 2 / of.sum()
    return weight


def _loss(at: Array, one: Array, signs: Array, weight: Array, penalty: Array) -> float:
    losses = np.logaddexp(0.0, -signs * (one @ at))
    return float(weight @ losses + 0.5 * (penalty @ at**2))
