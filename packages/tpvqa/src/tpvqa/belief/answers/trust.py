"""Whether the VLM is as good as its calibration says, learned from its own answers."""

from functools import lru_cache
from math import exp, log
from operator import mul

GRID = (0.01, 0.15, 0.3, 0.45, 0.6, 0.8, 1.0, 1.3, 1.7, 2.2)
"""Factors by which log likelihood ratios may have to be multiplied."""
RECORDED = (
    *(0.11, 0.13, 0.15, 0.18, 0.23, 0.23, 0.24, 0.41),
    *(0.55, 0.67, 0.76, 0.79, 0.93, 0.95, 1.87, 1.95),
)
"""Such factors of eight real VLMs in a household and on blocks, for the default calibration
(`tools/default_trust.py`; recordings of ViPlan, Merler et al. 2025)."""
ALIKE = 0.4
"""How far the next VLM is from one of them: standard deviation of log γ."""
KNOWN = 10
"""Labelled answers after which a calibration is believed as much as those recordings."""

ELSEWHERE = 0.02
"""Chance that a calibration says nothing of the VLM in this scene, however well it was learned: the
camera, the light or the model is another one."""
NOTHING = 0.5
"""The share of that chance with which its answers are then worth nothing at all."""


class Trust:
    """A posterior over how much an answer is worth, compared with what the calibration says.

    An answer with log likelihood ratio r is right with probability σ(γ r); γ is 1 where the
    calibration is right, near 0 where the answers are worth nothing. γ has a log-normal prior on a
    grid. No truth is needed: answers that contradict the belief, and each other, are improbable
    under a large γ.

    Args:
        spread: Standard deviation of log γ beforehand.
    """

    def __init__(self, spread: float = 0.5):
        self.spread = spread
        self._trusted: dict[float, float] = {}
        self._weights = [exp(-0.5 * (log(factor) / spread) ** 2) for factor in GRID]
        self._normalise()

    def ratio(self, ratio: float) -> float:
        """The log likelihood ratio of an answer, as far as it can be trusted."""
        if ratio == 0.0:
            return 0.0
        size = abs(ratio)
        trusted = self._trusted.get(size)
        if trusted is None:
            right = sum(map(mul, self._weights, _rights(size)))
            trusted = self._trusted[size] = log(right / (1 - right))
        return trusted if ratio > 0 else -trusted

    @staticmethod
    def after(rows: int) -> "Trust":
        """How far to trust a calibration that was learned from so many answers.

        Where nothing was learned, a VLM is one like those that were recorded: some know what they
        see, some hardly.
        """
        trust, unknown = (
            Trust(0.15 + 0.6 / (1 + rows / 200)),
            (1 - ELSEWHERE) * KNOWN / (KNOWN + rows),
        )
        recorded = [
            sum(exp(-0.5 * (log(factor / known) / ALIKE) ** 2) for known in RECORDED)
            for factor in GRID
        ]
        trust.weights = tuple(
            (1 - unknown - ELSEWHERE) * learned
            + unknown * each / sum(recorded)
            + ELSEWHERE * ((1 - NOTHING) / len(GRID) + (NOTHING if place == 0 else 0.0))
            for place, (learned, each) in enumerate(zip(trust.weights, recorded, strict=True))
        )
        return trust

    @property
    def mean(self) -> float:
        """The expected γ."""
        return sum(g * w for g, w in zip(GRID, self._weights, strict=True))

    @property
    def weights(self) -> tuple[float, ...]:
        """The probability of every factor of `GRID`."""
        return tuple(self._weights)

    @weights.setter
    def weights(self, weights: tuple[float, ...]) -> None:
        self._weights = list(weights)
        self._normalise()

    def _normalise(self) -> None:
        floor = 1e-9 * sum(self._weights)
        above = [max(w, floor) for w in self._weights]
        self._weights = [w / sum(above) for w in above]
        self._trusted.clear()


@lru_cache(maxsize=4096)
def _rights(ratio: float) -> tuple[float, ...]:
    """How probable an answer of a log likelihood ratio is to be right, for every factor."""
    return tuple(1 / (1 + exp(-factor * ratio)) for factor in GRID)
