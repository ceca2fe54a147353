"""How sure heads may be: what their log odds are multiplied by, learnt from what was held back."""

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.teaching.logistic import even

_NEAR = 0.5
"""How far, as a logarithm, one head's slope is thought to lie from what suits all."""

_GRID = np.exp(np.linspace(np.log(0.1), np.log(10.0), 120))


def slopes(odds: NDArray[np.float64], labels: NDArray[np.int64]) -> NDArray[np.float64]:
    """What the log odds of each head are multiplied by, so that those held back are likeliest.

    A head with few pictures of one kind stays near what suits all heads together.

    Args:
        odds: n × heads, of pictures that did not teach them; nan where there are none.
        labels: n × heads: 1, 0, -1 for not known.
    """
    each = np.array([_losses(odds[:, i], labels[:, i], _GRID) for i in range(odds.shape[1])])
    common = _GRID[each.sum(0).argmin()]
    away = (np.log(_GRID / common) / _NEAR) ** 2 / 2
    return np.asarray(_GRID[(each + away).argmin(1)], np.float64)


def losses(odds: NDArray[np.float64], labels: NDArray[np.int64]) -> NDArray[np.float64]:
    """The loss of each head as sure as `slopes` makes it, yes and no weighing alike.

    Args:
        odds: n × heads, of pictures that did not teach them; nan where there are none.
        labels: n × heads: 1, 0, -1 for not known.
    """
    slope = slopes(odds, labels)
    each = [_losses(odds[:, i], labels[:, i], slope[[i]])[0] for i in range(len(slope))]
    return np.array(each)


def _losses(
    odds: NDArray[np.float64], labels: NDArray[np.int64], grid: NDArray[np.float64]
) -> NDArray[np.float64]:
    """The loss of one head under each slope, as if it had as many yes and no as the fewer."""
    asked = (labels >= 0) & ~np.isnan(odds)
    labels, odds = labels[asked], odds[asked]
    fewer = min(int((labels == 0).sum()), int((labels == 1).sum()))
    if not fewer:
        return np.zeros(len(grid))
    signed = np.where(labels == 1, odds, -odds)
    loss = np.logaddexp(0, -grid[:, None] * signed)
    return np.asarray(loss @ even(labels, 2.0 * fewer), np.float64)
