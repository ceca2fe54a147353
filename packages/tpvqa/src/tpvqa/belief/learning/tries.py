"""Tries of an action, one after the other, and how probable they are at every rate of failure."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from operator import is_not

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.pddl import Action

RATES: Floats = np.array([*np.linspace(0.01, 0.99, 50), 1.0])
"""Rates of failure that are told apart; the last is that of what never works."""
EDGE = 1e-9


class Run:
    """Tries of one action, one after the other.

    Whether one of them has worked is judged once, by all that was seen until now: that the last
    one was seen to fail says so of those before it, too.

    Attributes:
        tries: How many.
        needed: How many of them could have worked: none after the one that has.
        worked: Probability that one of them has.
        likelihood: Of what was seen, for every rate, shape (rates,).
    """

    def __init__(self, action: Action):
        self.action = action
        self.tries, self._all_fail = 0, 1.0
        self.needed = self.worked = 0.0
        self._until = self._until_last = 0.0
        self.likelihood: Floats = np.ones_like(RATES)

    def again(self, predicted: float) -> None:
        """Note one more try, of which a failure was predicted with some probability."""
        self.tries, self._all_fail = self.tries + 1, self._all_fail * predicted
        self._until_last = self._until  # the one that has worked, if one of those before has

    def judge(self, shares: Mapping[str, float]) -> None:
        """Take in how the last try came out, as far as it was seen until now."""
        failed, succeeded = shares.get("failure", 0.0), shares.get("success", 0.0)
        # What an earlier try of the run has done is its success.
        earlier = shares.get("achieved", 0.0) if self.tries > 1 else 0.0
        self.worked = succeeded + earlier
        until = succeeded * self.tries + earlier * self._until_last
        self._until = until / self.worked if self.worked > EDGE else float(self.tries)
        self.needed, possible = failed * self.tries + until, failed + self.worked
        # By how much what was seen speaks for a success, the belief in it beforehand taken out.
        speaks = (self.worked / (1 - self._all_fail)) / max(failed / self._all_fail, EDGE)
        none = self.none
        likely = none + (1 - none) * speaks
        likely /= self._all_fail + (1 - self._all_fail) * speaks
        self.likelihood = max(0.0, 1 - possible) + possible * likely

    @property
    def none(self) -> Floats:
        """How probable it is at every rate that none of them works."""
        found: Floats = RATES**self.tries
        return found


@dataclass(slots=True)
class Tried:
    """How often an action was tried.

    Attributes:
        runs: Its tries, as they followed one another.
    """

    runs: list[Run]
    _told: list[Floats] = field(default_factory=list)
    _likelihood: Floats = field(default_factory=lambda: np.ones_like(RATES))

    @property
    def times(self) -> float:
        """Tries that could have worked."""
        return sum(run.needed for run in self.runs)

    @property
    def failed(self) -> float:
        """How many of them are thought to have failed."""
        return self.times - sum(run.worked for run in self.runs)

    @property
    def works(self) -> bool:
        """Whether one of them is thought to have worked."""
        return self.failed < self.times - 0.5

    @property
    def likelihood(self) -> Floats:
        """Of what was seen, for every rate, shape (rates,)."""
        told = [run.likelihood for run in self.runs]  # another array after every judgement
        if len(told) != len(self._told) or any(map(is_not, told, self._told)):
            found: Floats = np.ones_like(RATES)
            for each in told:
                found = found * each
            self._told, self._likelihood = told, found / found.max()
        return self._likelihood

    def as_if_failed(self) -> "Tried":
        """The same if all tries of the last run have failed."""
        last = Run(self.runs[-1].action)
        last.tries = self.runs[-1].tries
        last.needed = float(last.tries)
        last.likelihood = last.none
        return Tried([*self.runs[:-1], last])
