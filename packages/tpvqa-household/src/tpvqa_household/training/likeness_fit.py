"""Fitting where a kind of pictures ends."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.embedded.likeness import Floats, Likeness


def fitted(features: Floats, *, directions: int) -> Likeness:
    """The likeness to pictures whose features are given, n × m, with the edge still at 1."""
    mean, scale = features.mean(0), features.std(0) + 1e-6
    away = ((features - mean) / scale).astype(np.float64)
    variances, axes = np.linalg.eigh(np.cov(away.T))
    kept, axes = variances[::-1][:directions], axes[:, ::-1][:, :directions]
    # The sign of an axis says nothing; fixed, so that the same pictures give the same file.
    axes = axes * np.where(axes[np.abs(axes).argmax(0), np.arange(axes.shape[1])] < 0, -1, 1)
    rest = max(float(variances.sum() - kept.sum()) / max(1, len(mean) - directions), 1e-9)
    return Likeness(
        mean.astype(np.float32),
        scale.astype(np.float32),
        axes.astype(np.float32),
        kept.astype(np.float32),
        rest,
        1.0,
    )


def ending(likeness: Likeness, distances: NDArray[np.float64], share: float) -> Likeness:
    """The same with its edge where a share of pictures, by their distances, is taken for unlike.

    Args:
        likeness: Whose edge is 1.
        distances: Of pictures of the kind that it was not fitted to.
        share: Of them, how many are beyond the edge.
    """
    return replace(likeness, edge=float(np.quantile(distances, 1 - share)))
