"""Intervals for differences and ratios between cells that ran the same episodes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tpvqa.bench.row import EpisodeRow
from tpvqa.chance import chance_array

Floats = NDArray[np.float64]
RESAMPLES = 1000
Z = 1.959964  # 97.5% quantile of the normal distribution


@dataclass(frozen=True, slots=True)
class Estimate:
    """A figure with its 95% interval."""

    value: float
    low: float
    high: float


class Resampled:
    """Means of a cell's figures over bootstrap samples of episodes.

    All cells are resampled by the same episodes, as they met the same faults: what they have in
    common cancels in differences (Efron and Tibshirani 1993, chapter 8).

    Args:
        rows: The episodes of a cell, at least one.
    """

    def __init__(self, rows: Sequence[EpisodeRow]):
        self.rows = rows
        self.count = len(rows)
        self._weights = _weights(_size(rows))[:, [row.episode for row in rows]]
        self._totals = np.maximum(self._weights.sum(axis=1), 1.0)

    def mean(self, name: str) -> float:
        """The mean of a figure of the rows, by its name."""
        return float(self._values(name).mean())

    def means(self, name: str) -> Floats:
        """The mean of every sample."""
        found: Floats = self._weights @ self._values(name) / self._totals
        return found

    def _values(self, name: str) -> Floats:
        return np.array([float(getattr(row, name)) for row in self.rows])


def _size(rows: Sequence[EpisodeRow]) -> int:
    """Cells whose sizes differ share the samples of the next thousand."""
    return 1000 * (max(row.episode for row in rows) // 1000 + 1)


@lru_cache(maxsize=4)
def _weights(size: int) -> Floats:
    """How often each episode is drawn: Poisson's weights, so that it depends on no other."""
    random = chance_array(0, 0, "resampling", size)
    return random.poisson(1.0, (RESAMPLES, size)).astype(float)


def interval(value: float, samples: Floats, count: int) -> Estimate:
    """The interval of a difference of rates, from samples of it.

    With few episodes in which two monitors differ, a bootstrap is too sure. As Agresti and Min
    (2005) do, two episodes are added in which either half wins.

    Args:
        value: The difference.
        samples: The same in every bootstrap sample.
        count: Episodes of the smallest cell in it.
    """
    half = Z * float(np.sqrt(np.var(samples) + 1 / (count + 2) ** 2))
    return Estimate(value, max(value - half, -1.0), min(value + half, 1.0))


def difference(
    first: Sequence[EpisodeRow], second: Sequence[EpisodeRow], name: str = "completed"
) -> Estimate:
    """A share of the first cell less that of the second, on the episodes of both."""
    mine, other = _common(first, second)
    return interval(
        mine.mean(name) - other.mean(name), mine.means(name) - other.means(name), mine.count
    )


def ratio(first: Sequence[EpisodeRow], second: Sequence[EpisodeRow], name: str) -> Estimate:
    """A figure's mean in the first cell over that in the second, on the episodes of both."""
    mine, other = _common(first, second)
    below = other.mean(name)
    if not below:
        value = float("inf") if mine.mean(name) else 1.0
        return Estimate(value, value, value)
    samples = mine.means(name) / np.maximum(other.means(name), 1e-9)
    low, high = np.quantile(samples, (0.025, 0.975))
    return Estimate(mine.mean(name) / below, float(low), float(high))


def _common(
    first: Sequence[EpisodeRow], second: Sequence[EpisodeRow]
) -> tuple[Resampled, Resampled]:
    both = {row.episode for row in first} & {row.episode for row in second}
    mine = Resampled([row for row in first if row.episode in both])
    return mine, Resampled([row for row in second if row.episode in both])
