"""Intervals and tests for completion rates."""

from collections.abc import Sequence
from dataclasses import dataclass

from tpvqa.errors import MissingExtraError


@dataclass(frozen=True, slots=True)
class Interval:
    """A rate with its 95% interval."""

    rate: float
    low: float
    high: float


@dataclass(frozen=True, slots=True)
class Paired:
    """How two monitors differ on the same episodes.

    Attributes:
        difference: Completion rate of the first less that of the second.
        only_first: Episodes that only the first completed.
        only_second: Episodes that only the second completed.
        p: Two-sided exact McNemar test.
    """

    difference: float
    only_first: int
    only_second: int
    p: float


def wilson(successes: int, trials: int) -> Interval:
    """The 95% Wilson score interval of a rate (Wilson 1927).

    Raises:
        MissingExtraError: SciPy is not installed.
    """
    interval = _binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    return Interval(successes / trials, float(interval.low), float(interval.high))


def paired(first: Sequence[bool], second: Sequence[bool]) -> Paired:
    """Compare two monitors that met the same faults, episode by episode (McNemar 1947)."""
    pairs = list(zip(first, second, strict=True))
    only_first = sum(a and not b for a, b in pairs)
    only_second = sum(b and not a for a, b in pairs)
    differing = only_first + only_second
    p = float(_binomtest(only_first, differing).pvalue) if differing else 1.0
    return Paired((only_first - only_second) / len(pairs), only_first, only_second, p)


def _binomtest(successes: int, trials: int):  # type: ignore[no-untyped-def]
    try:
        from scipy.stats import binomtest
    except ImportError as error:
        raise MissingExtraError("scipy", "bench", "Statistics of a bench") from error
    return binomtest(successes, trials)
