"""How often each skill fails, and which seem not to work at all.

Every skill has its own rate, alike among skills as far as the common rate says; with some objects a
skill may not work although it does with others. What came of an action is only probable, so each
try adds a likelihood over rates, not a count.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from tpvqa.belief.information import Floats
from tpvqa.pddl import Action

ALIKE = 12.0
"""How many tries of a skill the rates of the others are worth."""
DEAD = 0.02
"""Chance that a skill never works."""
DEAD_WITH = 0.005
"""Chance that a skill never works with one object in one place, and that it never does with just
these objects together."""
SUSPECT = 0.1
"""Where an action is dead with this probability, what it needs is doubted first."""
NAMED = 0.6
"""A skill that is dead with this probability is named, and a way without it is looked for."""
GIVEN_UP = 0.95
"""One that is dead with this probability is not tried any more."""

_RATES: Floats = np.array([*np.linspace(0.01, 0.99, 50), 1.0])
_EDGE = 1e-9


@dataclass(frozen=True, slots=True)
class SkillState:
    """What is known of one skill with its objects.

    Attributes:
        failure: Expected probability that the next try fails.
        dead: Probability that every try fails.
        tries: Expected number of tries that one success takes, if it works at all.
    """

    failure: float
    dead: float
    tries: float


@dataclass(slots=True)
class Tried:
    """How often an action was tried.

    Attributes:
        times: Tries that could have worked.
        failed: How many of them are thought to have failed.
        likelihood: Of what was seen, for every rate, shape (rates,).
    """

    times: float
    failed: float
    likelihood: Floats


class _Run:
    """Tries of one action, one after the other.

    Whether one of them has worked is judged once, by all that was seen until now: that the last
    one was seen to fail says so of those before it, too.
    """

    def __init__(self, action: Action, before: Tried):
        self.action, self.before = action, replace(before)
        self.tries, self.all_fail = 0, 1.0


class Skills:
    """The failure rates of single skills under a common one.

    Attributes:
        learned: How often something was learned.
    """

    def __init__(self) -> None:
        self.learned = 0
        self._tried: dict[str, dict[Action, Tried]] = {}
        self._known: dict[tuple[Action | str, float, float], SkillState] = {}
        self._causes: dict[tuple[str, float, float], dict[Cause, float]] = {}
        self._run: _Run | None = None

    def of(self, action: Action, mean: float, strength: float) -> SkillState:
        """What is known of an action.

        Args:
            action: The skill with its objects.
            mean: The common rate of failure.
            strength: How many cases that is known from.
        """
        own = self._tried.get(action.name, {})
        key = (action if own else action.name, round(mean, 3), round(strength, 1))
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = self._worked_out(action, own, mean, strength)
        return found

    def _worked_out(
        self, action: Action, own: "Mapping[Action, Tried]", mean: float, strength: float
    ) -> SkillState:
        causes = self._causes.get((action.name, mean, strength))
        if causes is None:
            causes = self._causes[action.name, mean, strength] = _causes(own, mean, strength)
        dead = min(sum(causes.get(each, 0.0) for each in _covering(action)), 1.0)
        if not own:
            dead = DEAD
        others = [tried for other, tried in own.items() if other != action]
        weights = _prior(mean, strength)
        for tried in others:
            weights *= tried.likelihood[:-1]
        weights /= max(weights.sum(), _EDGE)
        if action in own:
            # Alike as skills are, with other objects it may be easier or harder.
            known = 1 / (1 / ALIKE + 1 / (strength + sum(tried.times for tried in others)))
            weights = _prior(float(weights @ _RATES[:-1]), known) * own[action].likelihood[:-1]
            weights /= max(weights.sum(), _EDGE)
        failure = float(weights @ _RATES[:-1])
        tries = float((weights / (1 - _RATES[:-1])).sum())
        return SkillState(dead + (1 - dead) * failure, dead, tries)

    def tried(self, action: Action) -> Tried | None:
        """How often an action was tried; None where it never was."""
        return self._tried.get(action.name, {}).get(action)

    def times(self, action: Action) -> tuple[float, float]:
        """How often a skill was tried, whatever with, and failed; with what it fails at alone
        where it works with others."""
        own = self._tried.get(action.name, {})
        if any(other.failed < other.times - 0.5 for other in own.values()):
            own = {each: tried for each, tried in own.items() if each == action}
        return sum(each.times for each in own.values()), sum(each.failed for each in own.values())

    def all(self) -> list[Action]:
        """The actions that were tried."""
        return [action for own in self._tried.values() for action in own]

    def learn(self, action: Action, shares: Mapping[str, float], predicted: float) -> None:
        """Learn from how an action came out, see `Belief.outcome_shares`.

        Args:
            action: What was done.
            shares: How it came out.
            predicted: The probability of failure with which that was predicted.
        """
        again = self._run is not None and self._run.action == action
        if not again:
            self._run = None
        failed, worked = shares.get("failure", 0.0), shares.get("success", 0.0)
        if again:  # what an earlier try of the run has done is its success
            worked += shares.get("achieved", 0.0)
        possible = failed + worked
        if possible < 0.05 or not 0 < predicted < 1:
            return
        tried = self._tried.setdefault(action.name, {}).setdefault(
            action, Tried(0.0, 0.0, np.ones_like(_RATES))
        )
        if self._run is None:
            self._run = _Run(action, tried)
        run = self._run
        run.tries, run.all_fail = run.tries + 1, run.all_fail * predicted
        # By how much what was seen speaks for a success, the belief in it beforehand taken out.
        speaks = (worked / (1 - run.all_fail)) / max(failed / run.all_fail, _EDGE)
        none = _RATES**run.tries
        likely = none + (1 - none) * speaks
        likely /= run.all_fail + (1 - run.all_fail) * speaks
        tried.times = run.before.times + run.tries * possible
        tried.failed = run.before.failed + run.tries * possible - worked
        tried.likelihood = run.before.likelihood * (max(0.0, 1 - possible) + possible * likely)
        tried.likelihood /= tried.likelihood.max()
        self.learned += 1
        self._known.clear()
        self._causes.clear()


Cause = tuple[object, ...]


def _covering(action: Action) -> list[Cause]:
    """What may be the cause that an action never works: the skill, one object, all together."""
    single: list[Cause] = list(enumerate(action.arguments))
    return [(), *single, *([action.arguments] if len(single) > 1 else [])]


def _causes(own: "Mapping[Action, Tried]", mean: float, strength: float) -> dict[Cause, float]:
    """How probable each cause is, one at most of a skill, by what its tries came to."""
    logs = {action: np.log(np.maximum(tried.likelihood, 1e-300)) for action, tried in own.items()}
    total = sum(logs.values(), np.zeros_like(_RATES))
    prior = np.log(np.maximum(_prior(mean, strength), 1e-300))
    of: dict[Cause, list[Action]] = {}
    for action in own:
        for cause in _covering(action):
            of.setdefault(cause, []).append(action)
    chances = {cause: DEAD_WITH if cause else DEAD for cause in of}
    none = np.log(max(1 - sum(chances.values()), 0.5)) + np.logaddexp.reduce(prior + total[:-1])
    found = {}
    for cause, actions in of.items():
        dead = sum((logs[action] for action in actions), np.zeros_like(_RATES))
        alive = np.logaddexp.reduce(prior + (total - dead)[:-1])
        found[cause] = float(np.log(chances[cause]) + dead[-1] + alive)
    most = max(float(none), *found.values()) if found else 0.0
    weights = {cause: float(np.exp(value - most)) for cause, value in found.items()}
    whole = sum(weights.values()) + float(np.exp(none - most))
    return {cause: weight / whole for cause, weight in weights.items()}


def _prior(mean: float, strength: float) -> Floats:
    """Of a skill's rate, if it works: as far from the common one as skills are from each other
    and as the common one is unsure; shape (rates - 1,)."""
    alike = max(1 / (1 / (ALIKE + 1) + 1 / (strength + 1)) - 1, 1.0)
    mean = min(max(mean, 0.005), 0.995)
    a, b = alike * mean, alike * (1 - mean)
    logs = (a - 1) * np.log(_RATES[:-1]) + (b - 1) * np.log1p(-_RATES[:-1])
    weights = np.exp(logs - logs.max())
    found: Floats = weights / weights.sum()
    return found
