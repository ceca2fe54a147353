"""Which kind of picture a picture is, by the mean and spread of its features."""

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Likeness:
    """The Mahalanobis distance to pictures of a kind, in the directions in which they differ most.

    What lies in none of these directions counts by its mean square. Lee et al. 2018, *A simple
    unified framework for detecting out-of-distribution samples*, without classes.

    Attributes:
        mean: Of each of n features.
        scale: The standard deviation of each.
        axes: n × k, the k directions.
        variances: Along each of them.
        rest: The mean variance in all other directions.
        edge: The squared distance at which the kind ends.
    """

    mean: Floats
    scale: Floats
    axes: Floats
    variances: Floats
    rest: float
    edge: float

    def distance(self, features: Floats) -> NDArray[np.float64]:
        """Squared distances of pictures, m × n, as multiples of `edge`: above 1 is unlike."""
        away = ((features - self.mean) / self.scale).astype(np.float64)
        along = away @ self.axes.astype(np.float64)
        within = (along**2 / self.variances).sum(-1)
        left = np.maximum((away**2).sum(-1) - (along**2).sum(-1), 0.0) / self.rest
        squared: NDArray[np.float64] = (within + left) / self.edge
        return squared

    def arrays(self, name: str) -> dict[str, Floats]:
        """All of it as arrays, under keys that begin with a name."""
        return {
            f"{name}.{field.name}": np.asarray(getattr(self, field.name), np.float32)
            for field in fields(self)
        }

    @classmethod
    def of(cls, arrays: Mapping[str, Floats], name: str) -> "Likeness":
        """What `arrays` gave.

        Raises:
            KeyError: Something of it is missing.
            ValueError: The arrays do not fit each other.
        """
        mean, scale, axes, variances = (
            arrays[f"{name}.{part}"] for part in ("mean", "scale", "axes", "variances")
        )
        if not (mean.shape == scale.shape == axes.shape[:1] and axes.shape[1:] == variances.shape):
            raise ValueError(f"the arrays of {name!r} do not fit each other")
        rest, edge = float(arrays[f"{name}.rest"]), float(arrays[f"{name}.edge"])
        return cls(mean, scale, axes, variances, rest, edge)


@dataclass(frozen=True)
class Divide:
    """A plane between two kinds of pictures.

    Attributes:
        weights: Of n features.
        bias: Above 0 lies the second kind.
    """

    weights: Floats
    bias: float

    def beyond(self, features: Floats) -> NDArray[np.float64]:
        """How far on the second kind's side pictures lie, m × n."""
        found: NDArray[np.float64] = features.astype(np.float64) @ self.weights + self.bias
        return found

    def arrays(self, name: str) -> dict[str, Floats]:
        """As `Likeness.arrays`."""
        return {f"{name}.weights": self.weights, f"{name}.bias": np.asarray(self.bias, np.float32)}

    @classmethod
    def of(cls, arrays: Mapping[str, Floats], name: str) -> "Divide":
        """As `Likeness.of`."""
        return cls(arrays[f"{name}.weights"], float(arrays[f"{name}.bias"]))


def summary(maps: Floats) -> Floats:
    """What of a picture's map, 1 × channels × height × width, is compared: mean and spread."""
    flat = maps.reshape(maps.shape[1], -1)
    return np.concatenate([flat.mean(1), flat.std(1)]).astype(np.float32)
