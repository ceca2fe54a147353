"""How often each skill fails, and which seem not to work at all.

Every skill has its own rate, alike among skills as far as the common rate says; with some objects a
skill may not work although it does with others. What came of an action is only probable, so each
try adds a likelihood over rates, not a count.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from math import inf

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.filtering.belief import LOOKED_BACK
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.tries import EDGE, RATES, Run, Tried
from tpvqa.pddl import Action

ALIKE = 12.0
"""How many tries of a skill the rates of the others are worth."""
DEAD = 0.02
"""Chance that a skill never works."""
DEAD_WITH = 0.02
"""Chance that a skill never works with what it is tried with: with one of the objects in its place,
or with just these together, one as probable as the other."""
SUSPECT = 0.1
"""Where an action is dead with this probability, what it needs is doubted first."""
SUSPECTED = 0.02
"""Chance beforehand of each of these that it is not so."""
CLOSELY = 0.3
"""Where an action is dead with this probability, should it have failed until now, it is looked more
closely at how it comes out."""
NAMED = 0.82
"""A skill that is dead with this probability is named, and a way without it is looked for."""
GIVEN_UP = 0.95
"""One that is dead with this probability is not tried any more."""
SHOWN = 0.7
"""Nor is it before its own tries have shown it with this probability."""

FOREGONE = 0.4
"""What may be spent on trying a skill in vain, of what a failed task costs, before it is given up:
how hard skills can be is known worse than what it costs to be wrong about it (a ski rental)."""
DOUBTED = 0.9
"""As how dead it counts at most until then."""


@dataclass(frozen=True, slots=True)
class SkillState:
    """What is known of one skill with its objects.

    Attributes:
        failure: Expected probability that the next try fails, where those right before it did.
        dead: Probability that every try fails.
        tries: Expected number of tries that one success takes, if it works at all.
        shown: Probability that every try fails, by its own tries: what those with other objects
            came to makes it suspected, and no more.
        at_worst: The probability of `dead` if its latest tries in a row have all failed.
        vain: Tries in vain that may have the same cause: with just these objects, or of the skill
            or with one of them as far as none has worked.
    """

    failure: float
    dead: float
    tries: float
    shown: float = 0.0
    at_worst: float = 0.0
    vain: float = 0.0

    def rates(self, common: Rates) -> Rates:
        """The expected rates where it is executed: one that never works does nothing at all, and
        disturbs nothing."""
        dead, often = max(self.dead, self.at_worst), common.disturbance
        failed = often * (1 - min(dead / max(self.failure, EDGE), 1.0))
        return replace(common, failure=self.failure, disturbance=failed, in_vain=often * (1 - dead))


class Skills:
    """The failure rates of single skills under a common one.

    Attributes:
        learned: How often something was learned.
    """

    def __init__(self) -> None:
        self.learned = 0
        self._tried: dict[str, dict[Action, Tried]] = {}
        self._known: dict[tuple[Action | str, float, float], SkillState] = {}
        self._shared: dict[tuple[str, float, float], _Shared] = {}
        self._run: Run | None = None
        self._latest: list[Run | None] = []

    def of(self, action: Action, mean: float, strength: float, alike: float = ALIKE) -> SkillState:
        """What is known of an action.

        Args:
            action: The skill with its objects.
            mean: The rate of failure that is expected of the skill.
            strength: How many cases that is known from.
            alike: How many of its own tries that is worth, the same whenever it is asked about.
        """
        own = self._tried.get(action.name, {})
        key = (action if own else action.name, round(mean, 3), round(strength, 1))
        found = self._known.get(key)
        if found is None:
            shared = self._shared.get((action.name, mean, strength))
            if shared is None:
                shared = _Shared(own, mean, strength, alike)
                self._shared[action.name, mean, strength] = shared
            found = shared.of(action)
            if self._run is not None and self._run.action == action:
                # Where there still is something to do, all tries of the run have failed.
                own = {**own, action: own[action].as_if_failed()}
                worst = _Shared(own, mean, strength, alike).of(action)
                found = replace(found, failure=worst.failure, at_worst=worst.dead)
            self._known[key] = found
        return found

    def tried(self, action: Action) -> Tried | None:
        """How often an action was tried; None where it never was."""
        return self._tried.get(action.name, {}).get(action)

    def times(self, action: Action) -> tuple[float, float]:
        """How often a skill was tried where it could have worked, whatever with, and failed; with
        what it fails at alone where it works with others."""
        told = self._told_of(action)
        return sum(each.times for each in told), sum(each.failed for each in told)

    def tries(self, action: Action) -> int:
        """How often a skill was tried in all, see `times`."""
        return sum(run.tries for each in self._told_of(action) for run in each.runs)

    def _told_of(self, action: Action) -> list[Tried]:
        own = self._tried.get(action.name, {})
        if any(each.works for each in own.values()):
            own = {each: tried for each, tried in own.items() if each == action}
        return [*own.values()]

    def all(self) -> list[Action]:
        """The actions that were tried."""
        return [action for own in self._tried.values() for action in own]

    def learn(
        self,
        action: Action,
        shares: Mapping[str, float],
        predicted: float,
        earlier: Sequence[Mapping[str, float]] = (),
    ) -> None:
        """Learn from how an action came out, see `Belief.outcome_shares`.

        Args:
            action: What was done.
            shares: How it came out.
            predicted: The probability of failure with which that was predicted.
            earlier: How the actions before it came out, as is known now, the latest first.
        """
        for run, now in zip(self._latest, earlier, strict=False):
            if run is not None and run is not self._run:
                run.judge(now)
        if self._run is not None and self._run.action != action:
            self._run = None
        possible = shares.get("failure", 0.0) + shares.get("success", 0.0)
        if self._run is not None:
            possible += shares.get("achieved", 0.0)
        counted = possible >= 0.05 and 0 < predicted < 1
        if counted:
            if self._run is None:
                self._run = Run(action)
                tried = self._tried.setdefault(action.name, {}).setdefault(action, Tried([]))
                tried.runs.append(self._run)
            self._run.again(predicted)
            self._run.judge(shares)
            # Of a run only its last try tells how it came out.
            self._latest = [None if run is self._run else run for run in self._latest]
        self._latest = [self._run if counted else None, *self._latest][:LOOKED_BACK]
        self.learned += 1
        self._known.clear()
        self._shared.clear()


Cause = tuple[object, ...]


def _covering(action: Action) -> list[Cause]:
    """What may be the cause that an action never works: the skill, one object, all together."""
    single: list[Cause] = list(enumerate(action.arguments))
    return [(), *single, *([action.arguments] if len(single) > 1 else [])]


class _Shared:
    """What the tries of a skill, with whatever objects, say of each of them.

    Args:
        own: Those tries.
        mean: The rate of failure that is expected of it.
        strength: How many cases that is known from.
        alike: How many tries of one action that is worth.
    """

    def __init__(self, own: "Mapping[Action, Tried]", mean: float, strength: float, alike: float):
        self._own, self._prior, self._alike = own, _prior(mean, strength, alike), alike
        self._causes = _causes(own, self._prior) if own else {}
        self._strength, self._times = strength, sum(tried.times for tried in own.values())
        self._vain: dict[Cause, float] = {}
        for action, tried in own.items():
            for cause in _covering(action):
                vain = -inf if tried.works else tried.failed
                self._vain[cause] = self._vain.get(cause, 0.0) + vain
        told = [tried.likelihood[:-1] for tried in own.values()]
        before, after = [self._prior], [np.ones_like(self._prior)]
        for each, last in zip(told, reversed(told), strict=True):
            before.append(before[-1] * each)
            after.append(after[-1] * last)
        self._all = before[-1]
        others = (a * b for a, b in zip(before, after[-2::-1], strict=False))
        self._others: dict[Action, Floats] = dict(zip(own, others, strict=True))

    def of(self, action: Action) -> SkillState:
        """What is known of the skill with its objects."""
        dead, own = DEAD, self._own
        if own:
            dead = min(sum(self._causes.get(each, 0.0) for each in _covering(action)), 1.0)
        weights = self._others.get(action, self._all)
        weights = weights / max(weights.sum(), EDGE)
        if action in own:
            # Alike as skills are, with other objects it may be easier or harder.
            others = self._times - own[action].times
            known = 1 / (1 / self._alike + 1 / (self._strength + others))
            common = _prior(float(weights @ RATES[:-1]), known, self._alike)
            weights = common * own[action].likelihood[:-1]
            weights /= max(weights.sum(), EDGE)
        failure, tries = float(weights @ RATES[:-1]), float((weights / (1 - RATES[:-1])).sum())
        shown = 0.0
        if action in own:
            likelihood = own[action].likelihood
            works = (1 - SUSPECT) * float(self._prior @ likelihood[:-1])
            shown = SUSPECT * likelihood[-1] / (SUSPECT * likelihood[-1] + works)
        tried = own[action].failed if action in own else 0.0
        vain = max(tried, *(self._vain.get(cause, 0.0) for cause in _covering(action)))
        failed = dead + (1 - dead) * failure
        return SkillState(failed, dead, tries, min(dead, shown), dead, vain)


def _chance(cause: Cause, action: Action) -> float:
    """The chance of a cause beforehand."""
    return DEAD_WITH / (len(_covering(action)) - 1) if cause else DEAD


def _causes(own: "Mapping[Action, Tried]", prior: Floats) -> dict[Cause, float]:
    """How probable each cause is, one at most of a skill, by what its tries came to."""
    logs = np.log(np.maximum([tried.likelihood for tried in own.values()], 1e-300))
    total, prior = logs.sum(axis=0), np.log(np.maximum(prior, 1e-300))
    of: dict[Cause, list[int]] = {}
    chances: dict[Cause, float] = {}
    for place, action in enumerate(own):
        for cause in _covering(action):
            of.setdefault(cause, []).append(place)
            chances.setdefault(cause, _chance(cause, action))
    covered = np.zeros((len(of), len(own)))
    for row, places in enumerate(of.values()):
        covered[row, places] = 1.0
    dead = covered @ logs
    alive = _summed(prior + (total - dead)[:, :-1])
    none = np.log(max(1 - sum(chances.values()), 0.5)) + _summed(prior + total[:-1])
    found = np.log(list(chances.values())) + dead[:, -1] + alive
    most = max(float(none), float(found.max()))
    weights = np.exp(found - most)
    weights /= weights.sum() + np.exp(none - most)
    return dict(zip(of, weights.tolist(), strict=True))


def _summed(logs: Floats) -> Floats:
    """The logarithm of a sum along the last axis, of logarithms."""
    most = logs.max(axis=-1)
    found: Floats = most + np.log(np.exp(logs - most[..., None]).sum(axis=-1))
    return found


@lru_cache(maxsize=1024)
def _prior(mean: float, strength: float, alike: float) -> Floats:
    """Of a skill's rate, if it works: as far from the common one as skills are from each other
    and as the common one is unsure; shape (rates - 1,)."""
    cases = max(1 / (1 / (alike + 1) + 1 / (strength + 1)) - 1, 1.0)
    mean = min(max(mean, 0.005), 0.995)
    a, b = cases * mean, cases * (1 - mean)
    logs = (a - 1) * np.log(RATES[:-1]) + (b - 1) * np.log1p(-RATES[:-1])
    weights = np.exp(logs - logs.max())
    found: Floats = weights / weights.sum()
    return found
