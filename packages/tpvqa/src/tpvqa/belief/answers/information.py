"""What an answer is worth: how much less the best decision is expected to cost with it.

The value of information (Howard 1966) of asking the same question once or several times in a row
("blinkered": Tolpin and Shimony 2012): where one poor answer could not change the decision, eight
can.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import comb, log

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Mixture = tuple[tuple[float, float], ...]
TIMES = (1, 3, 8, 20, 60)
"""How often a question is thought to be asked in a row."""

LATE = 1.5
"""A mistake is noticed so many times as late as a calibration says, at most: else the less were
known of a VLM, the more it would be asked."""
CLOSED = 1e-12
"""A sum that is less negative than this is nought."""


@dataclass(frozen=True, slots=True)
class Reliability:
    """What is expected of the next answer to a question.

    Attributes:
        yes_if_true: P(yes | yes is right), among answers that do not abstain.
        yes_if_false: P(yes | no is right), among them.
        abstains: P(no answer).
        if_true: Several answers where yes is right, as a mixture: weights, and P(yes) of each
            answer; empty where they are independent.
        if_false: The same where no is right.
    """

    yes_if_true: float
    yes_if_false: float
    abstains: float = 0.0
    if_true: Mixture = ()
    if_false: Mixture = ()

    @staticmethod
    def mixed(if_true: Mixture, if_false: Mixture, abstains: float) -> "Reliability":
        """Of answers that depend on each other."""
        means = [sum(weight * each for weight, each in mix) for mix in (if_true, if_false)]
        return Reliability(means[0], means[1], abstains, if_true, if_false)

    @property
    def mixtures(self) -> tuple[Mixture, Mixture]:
        """What comes where yes is right, and where no is."""
        return self.if_true or ((1.0, self.yes_if_true),), self.if_false or (
            (1.0, self.yes_if_false),
        )


def answers_to_be_sure(right: float, repeat: float = 0.0) -> float:
    """How many answers it takes to be as sure of a likely outcome as to act on it.

    Wald's (1945) sequential test from odds of 3 to 1 to odds of 50 to 1: about one for answers
    that are right in .95 of all cases, 34 for .6.

    Args:
        right: Probability that an answer is right.
        repeat: Probability that a further look repeats the last answer.
    """
    return max(1.0, (log(50) - log(3)) / _drift(right) / max(1 - repeat, 0.05))


def answers_to_know(likely: float, doubt: float, each: Reliability) -> float:
    """How many answers it takes until a fact is in doubt no more, by Wald's (1945) test.

    Args:
        likely: Probability of the fact.
        doubt: So improbable the contrary has to become.
        each: What is expected of one answer.
    """
    surer = max(likely, 1 - likely)
    way = log(1 / doubt - 1) - log(surer / (1 - surer))
    right = (1 + each.yes_if_true - each.yes_if_false) / 2
    return max(1.0, way / _drift(right) / (1 - each.abstains))


@lru_cache(maxsize=4096)
def settled(each: Reliability) -> float:
    """How far many answers tell a fact from its contrary, both as probable before: 1 less twice the
    probability that the likelier one is not true in the end."""
    true, false = (_mixed(mixture, TIMES[-1:]) for mixture in each.mixtures)
    return 1 - float(np.minimum(true, false).sum())


def _drift(right: float) -> float:
    right = min(max(right, 0.51), 0.99)
    return (2 * right - 1) * log(right / (1 - right))


@lru_cache(maxsize=4096)
def _counts(probability: float, times: int) -> Floats:
    """P(n yeses in so many answers), for n from 0."""
    return np.array(
        [
            comb(times, n) * probability**n * (1 - probability) ** (times - n)
            for n in range(times + 1)
        ]
    )


@lru_cache(maxsize=4096)
def _all_counts(probability: float, times: tuple[int, ...]) -> Floats:
    """`_counts` of several numbers of answers behind one another."""
    return np.concatenate([_counts(probability, each) for each in times])


def _mixed(mixture: Mixture, times: tuple[int, ...]) -> Floats:
    """`_all_counts` of a mixture."""
    weights = np.array([weight for weight, _ in mixture])
    counts: Floats = np.array([_all_counts(round(each, 3), times) for _, each in mixture])
    return weights @ counts


@lru_cache(maxsize=64)
def _begins(times: tuple[int, ...]) -> NDArray[np.intp]:
    """Where each of them begins there."""
    return np.cumsum([0, *(each + 1 for each in times[:-1])])


def opened(costs: Floats, work: Floats) -> Floats:
    """The costs of decisions, infinite where one is closed: something it has to do, along the first
    axis, is negative."""
    if not work.size or work.min() >= 0:
        return costs
    return np.where(work.min(axis=0) < -CLOSED, np.inf, costs)


def gains(
    if_true: Floats,
    if_false: Floats,
    work_if_true: Floats,
    work_if_false: Floats,
    reliabilities: Sequence[Reliability],
    times: tuple[int, ...],
) -> Floats:
    """How much less the best decision costs when one of some questions is answered some times.

    Args:
        if_true: Of every decision its expected cost where yes is right, times the probability
            of that; shape (questions, decisions).
        if_false: The same where no is right.
        work_if_true: What every decision then has to do, see `opened`, shape (limits, questions,
            decisions).
        work_if_false: The same where no is right.
        reliabilities: Of each answer to each question; answers are independent.
        times: How many answers; several numbers are compared.

    Returns:
        The expected saving, shape (questions, times), never negative.
    """
    now = opened(if_true + if_false, work_if_true + work_if_false).min(axis=1)
    true = np.array([_mixed(each.mixtures[0], times) for each in reliabilities])
    false = np.array([_mixed(each.mixtures[1], times) for each in reliabilities])
    answers = np.array([1 - each.abstains for each in reliabilities])
    true, false = true[:, :, None], false[:, :, None]
    costs = opened(
        true * if_true[:, None] + false * if_false[:, None],
        true * work_if_true[:, :, None] + false * work_if_false[:, :, None],
    )
    then = np.add.reduceat(costs.min(axis=2), _begins(times), axis=1)
    saved: Floats = np.maximum(0.0, answers[:, None] * (now[:, None] - then))
    return saved


def joint_gains(
    weighted: Floats,
    work: Floats,
    truths: Floats,
    reliabilities: Sequence[Reliability],
    times: tuple[int, ...],
) -> Floats:
    """How much less the best decision costs when several questions are answered some times each.

    Two answers together can change a decision that neither changes alone. An answer repeated is
    taken as the one that most of the answers give.

    Args:
        weighted: Probability of every joint state times the cost of every choice in it, shape
            (states, choices).
        work: The same of what every choice has to do in it, see `opened`.
        truths: Where yes is right, ones and zeros, shape (questions, states).
        reliabilities: Of one answer to each question.
        times: How many answers to each; several numbers are compared.

    Returns:
        The expected saving for each of `times`, never negative.
    """
    chances = np.ones((len(times), 1, weighted.shape[0]))
    for truth, each in zip(truths, reliabilities, strict=True):
        right = 1 - each.abstains
        if_true, if_false = (
            np.add.reduce([w * _majorities(round(p, 3), times) for w, p in mixture])
            for mixture in each.mixtures
        )
        yes = 0.5 + right * (if_true * truth + if_false * (1 - truth) - 0.5)
        chances = np.concatenate([chances * yes, chances * (1 - yes)], axis=1)
    now = opened(weighted.sum(axis=0), work.sum(axis=1)).min()
    then = opened(chances @ weighted, chances @ work[:, None]).min(axis=2).sum(axis=1)
    saved: Floats = np.maximum(0.0, now - then)
    return saved


def known_gain(weighted: Floats, work: Floats, truths: Floats) -> float:
    """How much less the best decision costs once all of some facts are known; arguments as those
    of `joint_gains`."""
    _, alike = np.unique(np.packbits(truths > 0, axis=0).T, axis=0, return_inverse=True)
    order = np.argsort(alike, kind="stable")
    starts = np.flatnonzero(np.diff(alike[order], prepend=-1))
    costs = np.add.reduceat(weighted[order], starts, axis=0)
    then = opened(costs, np.add.reduceat(work[:, order], starts, axis=1))
    now = opened(weighted.sum(axis=0), work.sum(axis=1)).min()
    return max(0.0, float(now - then.min(axis=1).sum()))


@lru_cache(maxsize=4096)
def _majorities(probability: float, times: tuple[int, ...]) -> Floats:
    """P(most of so many answers are yes), half of it where as many are no; shape (times, 1, 1)."""

    def majority(number: int) -> float:
        counts, half = _counts(probability, number), number // 2
        tie = counts[half] / 2 if number % 2 == 0 else 0.0
        return float(counts[half + 1 :].sum() + tie)

    return np.array([majority(each) for each in times])[:, None, None]
