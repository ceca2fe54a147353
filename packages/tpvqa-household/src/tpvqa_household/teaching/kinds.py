"""Where pictures like a user's own end."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.embedded.likeness import Floats, Likeness

FALSE_ALARMS = 0.02
"""Share of pictures like those that were taught that is taken for unlike."""
_DIRECTIONS = 32
_SHRUNK = 0.3
"""What part of the mean spread each feature has at least: in few pictures many never change."""
_BEYOND = 1.1
"""How much farther than all that was held back it ends where that is too little to tell a share."""


def known_pictures(kinds: Floats, folds: NDArray[np.int64]) -> Likeness:
    """The likeness to pictures, ending where a stated share of those held back is beyond.

    Args:
        kinds: n × features that tell kinds of pictures apart.
        folds: Of each picture; those of other folds say how far away it is.
    """
    distances = np.zeros(len(kinds))
    for fold in np.unique(folds):
        out = folds == fold
        taught = kinds[~out] if (~out).any() else kinds
        distances[out] = _likeness(taught).distance(kinds[out])
    ordered = np.sort(distances)
    place = int(np.ceil((len(ordered) + 1) * (1 - FALSE_ALARMS))) - 1
    end = ordered[place] if place < len(ordered) else _BEYOND * ordered[-1]
    return replace(_likeness(kinds), edge=max(float(end), 1e-6))


def _likeness(kinds: Floats) -> Likeness:
    mean, spread = kinds.mean(0), kinds.std(0)
    scale = np.sqrt(spread**2 + (_SHRUNK * spread.mean()) ** 2) + 1e-6
    away = ((kinds - mean) / scale).astype(np.float64)
    # Of n pictures there are at most n - 1 directions; those of the Gram matrix are cheap to find.
    values, vectors = np.linalg.eigh(away @ away.T)
    values, vectors = values[::-1], vectors[:, ::-1]
    count = max(1, min(_DIRECTIONS, len(kinds) // 4))
    kept = np.maximum(values[:count], 1e-9)
    axes = away.T @ (vectors[:, :count] / np.sqrt(kept))
    variances = kept / max(1, len(kinds) - 1)
    left = max(float(values.sum() - kept.sum()), 0.0) / max(1, len(kinds) - 1)
    rest = max(left / max(1, len(mean) - count), 1e-3)
    return Likeness(
        mean.astype(np.float32),
        scale.astype(np.float32),
        axes.astype(np.float32),
        np.maximum(variances, 1e-9).astype(np.float32),
        rest,
        1.0,
    )
