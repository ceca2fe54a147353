"""Fitting where a kind of pictures ends, and what divides two kinds."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import MissingExtraError
from tpvqa_household import DISTRIBUTION
from tpvqa_household.embedded.likeness import Divide, Floats, Likeness

EDGE_FROM = 5
"""Of the held-out parts, counted from the recipe's `validation_from`, those from this one on set
the edge; those before it only measure."""
_STRENGTH = 0.1
"""Inverse strength of a divide's regularisation, for standardised features."""


def fitted(features: Floats, *, directions: int) -> Likeness:
    """The likeness to pictures whose features are given, n × m, with the edge still at 1."""
    mean, scale = features.mean(0), features.std(0) + 1e-6
    away = ((features - mean) / scale).astype(np.float64)
    variances, axes = np.linalg.eigh(np.atleast_2d(np.cov(away.T)))
    kept, axes = variances[::-1][:directions], axes[:, ::-1][:, :directions]
    # The sign of an axis says nothing; fixed, so that the same pictures give the same file.
    axes = axes * np.where(axes[np.abs(axes).argmax(0), np.arange(axes.shape[1])] < 0, -1, 1)
    rest = max(float(variances.sum() - kept.sum()) / max(1, len(mean) - directions), 1e-3)
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


def reaching(likeness: Likeness, distances: NDArray[np.float64]) -> Likeness:
    """The same with its edge beyond all pictures of the given distances, if it is not already."""
    return replace(likeness, edge=likeness.edge * max(1.0, 1.001 * float(distances.max())))


def divide(first: Floats, second: Floats, held_back: Floats, share: float) -> Divide:
    """A plane between two kinds of pictures, which weigh the same, by logistic regression.

    Args:
        first: Features of the first kind, n × m.
        second: Of the second kind.
        held_back: Of the first kind, that set where the plane lies.
        share: How many of them lie on the second kind's side.

    Raises:
        MissingExtraError: scikit-learn is not installed.
    """
    try:
        from sklearn.linear_model import LogisticRegression
    except ImportError as error:
        raise MissingExtraError(
            "scikit-learn", "train", "Fitting limits", distribution=DISTRIBUTION
        ) from error
    mean, scale = first.mean(0), first.std(0) + 1e-6
    x = (np.concatenate([first, second]) - mean) / scale
    kind = np.repeat([0, 1], [len(first), len(second)])
    model = LogisticRegression(C=_STRENGTH, class_weight="balanced", max_iter=3000).fit(x, kind)
    found = Divide((model.coef_[0] / scale).astype(np.float32), 0.0)
    return replace(found, bias=-float(np.quantile(found.beyond(held_back), 1 - share)))
