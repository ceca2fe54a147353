"""How often each skill fails, and which seem not to work at all.

Every skill has its own rate, alike among skills as far as the common rate says; with some objects a
skill may not work although it does with others. What came of an action is only probable, so each
try adds a likelihood over rates, not a count.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from tpvqa.belief.information import Floats
from tpvqa.pddl import Action

ALIKE = 12.0
"""How many tries of a skill the rates of the others are worth."""
DEAD = 0.015
"""Chance that a skill never works."""
DEAD_WITH = 0.005
"""Chance that a skill that works never does with certain objects."""
NAMED = 0.6
"""A skill that is dead with this probability is named, and a way without it is looked for."""
GIVEN_UP = 0.85
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


class Skills:
    """The failure rates of single skills under a common one."""

    def __init__(self) -> None:
        self._tried: dict[str, dict[Action, Tried]] = {}
        self._known: dict[tuple[Action | str, float, float], SkillState] = {}

    def of(self, action: Action, mean: float, strength: float) -> SkillState:
        """What is known of an action.

        Args:
            action: The skill with its objects.
            mean: The common rate of failure.
            strength: How many cases that is known from.
        """
        own = self._tried.get(action.name, {})
        key = (action if action in own else action.name, round(mean, 3), round(strength, 1))
        found = self._known.get(key)
        if found is None:
            found = self._known[key] = _state(action, own, mean, strength)
        return found

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
        failed, worked = shares.get("failure", 0.0), shares.get("success", 0.0)
        if failed + worked < 0.05 or not 0 < predicted < 1:
            return
        rest = max(0.0, 1 - failed - worked)
        if_failed, if_worked = failed / predicted, worked / (1 - predicted)
        likelihood = rest + _RATES * if_failed + (1 - _RATES) * if_worked
        tried = self._tried.setdefault(action.name, {}).setdefault(
            action, Tried(0.0, 0.0, np.ones_like(_RATES))
        )
        tried.times += failed + worked
        tried.failed += failed
        tried.likelihood = tried.likelihood * likelihood
        tried.likelihood /= tried.likelihood.max()
        self._known.clear()


def _state(action: Action, own: Mapping[Action, Tried], mean: float, strength: float) -> SkillState:
    weights = _prior(mean, strength)
    for other, tried in own.items():
        if other != action:
            weights *= (1 - DEAD_WITH) * tried.likelihood + DEAD_WITH * tried.likelihood[-1]
    weights /= weights.sum()
    dead = weights[-1] + (1 - weights[-1]) * DEAD_WITH
    weights[-1] = 0.0
    weights *= (1 - dead) / max(weights.sum(), _EDGE)
    weights[-1] = dead
    if action in own:
        weights *= own[action].likelihood
        weights /= weights.sum()
    alive = weights[:-1].sum()
    tries = (weights[:-1] / (1 - _RATES[:-1])).sum() / max(alive, _EDGE)
    return SkillState(float(weights @ _RATES), float(weights[-1]), float(tries))


def _prior(mean: float, strength: float) -> Floats:
    """Of a skill's rate: as far from the common one as skills are from each other and as the
    common one is unsure."""
    alike = max(1 / (1 / (ALIKE + 1) + 1 / (strength + 1)) - 1, 1.0)
    mean = min(max(mean, 0.005), 0.995)
    a, b = alike * mean, alike * (1 - mean)
    logs = (a - 1) * np.log(_RATES[:-1]) + (b - 1) * np.log1p(-_RATES[:-1])
    weights = np.exp(logs - logs.max())
    found: Floats = np.append(weights * (1 - DEAD) / weights.sum(), DEAD)
    return found
