"""How much a picture's answers say together: they err together, so less than if each were alone.

The evidence of each predicate is raised to an exponent, and in a share of the pictures it is worth
less still, whatever they say:

    P(state | answers) = (1 - s) · softmax(Σ q_p e_p + prior) + s · softmax(d Σ q_p e_p + prior)

Exponents, share and dullness are chosen on scenes that the likelihood was not learned from, by the
log score of the true state and `FIRST` times that of whether the state put first is the true one:
the first keeps the whole distribution honest, the second the probability that is acted on.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from tpvqa_experiments.scenes.likelihood import Evidence
from tpvqa_experiments.scenes.ridge import Array

FIRST = 3.0
EXPONENT_STEPS = (0.8, 0.4, 0.2, 0.1, 0.05)
SHARES = (0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.4)
DULLED = (0.2, 0.3, 0.4, 0.5, 0.6)
KEPT = 1500
"""States of a scene that are kept as they are, the likeliest, and drawn from the others, for the
choice; the drawn ones stand for all others."""
SURE = 1e-4
"""No state is taken to be surer than this leaves, in the second score."""


@dataclass(frozen=True, slots=True)
class Weighing:
    """The weights of a picture's evidence.

    Attributes:
        exponents: Of each predicate's evidence.
        share: The share of pictures whose answers are worth less.
        dulled: By how much less: a further exponent.
    """

    exponents: tuple[float, ...] = (0.7, 0.8, 0.8)
    share: float = 0.1
    dulled: float = 0.4

    def log_belief(self, evidence: Evidence, log_prior: Array) -> Array:
        """The logarithm of the probability of every arrangement."""
        said = np.tensordot(np.array(self.exponents), evidence.astype(float), 1)
        found = said + log_prior
        found -= np.logaddexp.reduce(found)
        if self.share == 0.0:
            return np.asarray(found)
        dull = self.dulled * said + log_prior
        dull -= np.logaddexp.reduce(dull)
        return np.asarray(np.logaddexp(np.log1p(-self.share) + found, np.log(self.share) + dull))


@dataclass(frozen=True, slots=True)
class Sample:
    """The states of one scene that the choice looks at.

    Attributes:
        evidence: Log likelihoods; (3, states).
        log_prior: Of each state; (states,).
        log_times: The logarithm of how many states each stands for; (states,).
        truth: The place of the true state.
    """

    evidence: Evidence
    log_prior: Array
    log_times: Array
    truth: int

    @classmethod
    def of(
        cls, evidence: Evidence, log_prior: Array, truth: int, rng: np.random.Generator
    ) -> "Sample":
        """All states of a small scene, the likeliest and some others of a large one."""
        count = len(log_prior)
        if count <= 2 * KEPT:
            return cls(evidence, log_prior, np.zeros(count), truth)
        order = np.argsort(-(evidence.sum(axis=0) + log_prior), kind="stable")
        drawn = rng.choice(order[KEPT:], KEPT, replace=False)
        places = np.concatenate([order[:KEPT], drawn])
        times = np.repeat([0.0, np.log((count - KEPT) / KEPT)], KEPT)
        (found,) = np.nonzero(places == truth)
        if not len(found):  # it stands for nothing: it is scored, and what stands for it counts
            places, times = np.append(places, truth), np.append(times, -np.inf)
            found = np.array([len(places) - 1])
        return cls(evidence[:, places], log_prior[places], times, int(found[0]))


def choose(samples: Sequence[Sample]) -> Weighing:
    """The weighing with the best score, by steps along one parameter at a time."""
    joined = _Joined.of(samples)
    best = Weighing()
    score = joined.score(best)
    for step in EXPONENT_STEPS:
        improved = True
        while improved:
            improved = False
            for other in _near(best, step):
                found = joined.score(other)
                if found > score + 1e-6:
                    best, score, improved = other, found, True
    return best


def _near(weighing: Weighing, step: float) -> list[Weighing]:
    exponents = weighing.exponents
    moved = [
        replace(
            weighing,
            exponents=(*exponents[:k], round(exponents[k] + change, 2), *exponents[k + 1 :]),
        )
        for k in range(len(exponents))
        for change in (-step, step)
        if exponents[k] + change > 0.05
    ]
    shares = [replace(weighing, share=share) for share in SHARES]
    return moved + shares + [replace(weighing, dulled=dulled) for dulled in DULLED]


@dataclass(frozen=True, slots=True)
class _Joined:
    """The samples end to end, so that all are scored at once."""

    evidence: Array
    log_prior: Array
    log_times: Array
    starts: NDArray[np.int64]
    scene: NDArray[np.int64]
    truth: NDArray[np.int64]

    @classmethod
    def of(cls, samples: Sequence[Sample]) -> "_Joined":
        sizes = [len(sample.log_prior) for sample in samples]
        starts = np.cumsum([0, *sizes[:-1]])
        return cls(
            np.concatenate([sample.evidence for sample in samples], axis=1).astype(float),
            np.concatenate([sample.log_prior for sample in samples]),
            np.concatenate([sample.log_times for sample in samples]),
            starts,
            np.repeat(np.arange(len(samples)), sizes),
            starts + np.array([sample.truth for sample in samples]),
        )

    def score(self, weighing: Weighing) -> float:
        said = np.tensordot(np.array(weighing.exponents), self.evidence, 1)
        found = self._normal(said + self.log_prior)
        if weighing.share > 0:
            dull = self._normal(weighing.dulled * said + self.log_prior)
            found = np.logaddexp(np.log1p(-weighing.share) + found, np.log(weighing.share) + dull)
        true = found[self.truth]
        first = np.maximum.reduceat(found, self.starts)
        sure = np.clip(np.exp(first), SURE, 1 - SURE)
        on_first = np.where(true >= first, np.log(sure), np.log1p(-sure))
        return float(np.mean(true + FIRST * on_first))

    def _normal(self, values: Array) -> Array:
        top = np.maximum.reduceat(values, self.starts)
        mass = np.exp(values - top[self.scene] + self.log_times)
        total = top + np.log(np.add.reduceat(mass, self.starts))
        return np.asarray(values - total[self.scene])
