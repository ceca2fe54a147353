"""How far the tries of a skill are alike: whether one that has failed fails again oftener.

A common rate says how often a skill fails in the mean. What a failure says of the next try depends
on how the rates of its actions, by object and trial, spread about that mean. Trials of which it is
known what came of each try tell it.
"""

from functools import lru_cache
from math import exp, lgamma, log, log1p

from tpvqa.belief.calibrating.counted import SkillCount
from tpvqa.belief.learning.skills import ALIKE, DEAD, DEAD_WITH

TRIES = (ALIKE, 25.0, 50.0)
"""How many tries of an action in a trial the mean of its skill may be worth."""
SURE = 40.0
"""Cases that the mean is known from at most: a robot is not for ever what it was."""


@lru_cache(maxsize=256)
def alike(count: SkillCount) -> float | None:
    """How many tries of an action in a trial the mean of its skill is worth, in the mean over what
    is possible; None where tries were not told apart.

    Args:
        count: How often it failed and worked, with what in which trial.
    """
    if not count.together:
        return None
    told = {tries: _likelihood(count, tries) for tries in TRIES}
    most = max(told.values())
    weights = {tries: exp(found - most) for tries, found in told.items()}
    apart = sum(weight / (tries + 1) for tries, weight in weights.items())
    return sum(weights.values()) / apart - 1


def _likelihood(count: SkillCount, tries: float) -> float:
    """The logarithm of how probable what came of it is: a mixture of what never works and of rates
    from a Beta distribution."""
    never, mean = DEAD + DEAD_WITH, (count.failed + 0.5) / (count.tries + 1)
    rate = min(max((mean - never) / (1 - never), 0.005), 0.995)
    a, b = tries * rate, tries * (1 - rate)
    found = 0.0
    for failed, worked, trials in count.together:
        works = log1p(-never) + _beta(a + failed, b + worked) - _beta(a, b)
        found += trials * (works if worked else log(never + exp(works)))
    return found


def _beta(a: float, b: float) -> float:
    """The logarithm of the Beta function."""
    return lgamma(a) + lgamma(b) - lgamma(a + b)
