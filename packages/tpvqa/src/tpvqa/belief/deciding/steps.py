"""What single steps do unseen, over many joint states at once."""

from collections.abc import Collection, Iterable, Mapping
from heapq import heapify, heappop, heappush
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.filtering.faults import FaultModel, Outcomes, Rates
from tpvqa.pddl import Action

MOST = 600
"""Joint states that are told apart besides those that are begun from: those that are reached most
probably. The rest is lost."""
LEAST = 1e-4
"""What is reached less probably is not told apart."""
TRIES = 4
"""So many tries of a step may each undo something, where it is reckoned what is reached."""
VAIN = 0.1
"""How probable it is then that a step is left without having been done."""
AGAIN = 0.5
"""How much what is reached by a second way counts, beside what the first leads to."""

Way = tuple[Action, ...]
"""Actions that are done one after the other."""
_END, _CUT = 0, 1
"""The rests of ways of which nothing is left: another way may follow; more of its own does."""

Places = NDArray[np.intp]
Bools = NDArray[np.bool_]


class _Leads(NamedTuple):
    """Where an action leads from every joint state; where it cannot be done, and where it has
    nothing to do."""

    there: Places
    impossible: Bools
    achieved: Bools


class _Falls(NamedTuple):
    """What undoing leads to: from which joint states, to which, with which shares; and where the
    falls of each begin."""

    rows: Places
    columns: Places
    shares: Floats
    starts: Places


class Steps:
    """Steps backward: what is left to pay before an action, from what is left to pay after it.

    Args:
        model: The action model.

    Attributes:
        numbers: The joint states that are told apart. All others come last, as one, and are lost.
        place: The place of each.
        version: Grows whenever there are others.
    """

    def __init__(self, model: FaultModel):
        self._model = model
        self.numbers: list[int] = []
        self.place: dict[int, int] = {}
        self.version = 0
        self._rests: dict[tuple[Action, int], int] = {}
        self._covered = set[int]()
        self._leads: dict[Action, _Leads] = {}
        self._falls: _Falls | None = None

    def cover(
        self,
        masses: Mapping[int, float],
        ways: Collection[Way],
        rates: Rates,
        *,
        cut: Collection[Way] = (),
        followed: Way = (),
    ) -> None:
        """Tell apart what some ways may lead to.

        Nothing is done where all joint states are told apart and all ways were, or are what is left
        of one that was: what is improbable there and may lead elsewhere is left out until then.

        Args:
            masses: From where, with probabilities.
            ways: They; another one may follow each.
            rates: How often they undo something.
            cut: The beginnings of longer ones.
            followed: What was decided for, which nothing follows.
        """
        ends = [self._rest(way, _END) for way in ways]
        again = [*ends, *(self._rest(way, _CUT) for way in cut)]
        begun = [*again, self._rest(followed, _CUT)] if followed else again
        if masses.keys() <= self.place.keys() and self._covered.issuperset(begun):
            return
        self.version += 1
        often = max(rates.undone, rates.redone)
        self.numbers = self._reached(masses, begun, again, min(1.0, TRIES * often))
        self.place = {number: place for place, number in enumerate(self.numbers)}
        self._leads.clear()
        self._falls = None

    def _rest(self, way: Way, end: int) -> int:
        """The number of a way that ends so; what is left of it has one, too."""
        rest = end
        for action in reversed(way):
            rest = self._rests.setdefault((action, rest), len(self._rests) + 2)
        return rest

    def _reached(
        self, masses: Mapping[int, float], begun: list[int], again: list[int], undone: float
    ) -> list[int]:
        """The joint states that are met on the ways, the most probable ones."""
        told, steps = [*self._rests], dict[int, tuple[Mapping[int, Outcomes], int]]()
        for rest in begun:
            while rest > _CUT and rest not in steps:
                action, later = told[rest - 2]
                steps[rest] = self._model.outcomes(action), later
                rest = later
        self._covered = set(steps)
        found, done = dict.fromkeys(masses), set[tuple[int, int]]()
        queue = [(-mass, number, rest) for number, mass in masses.items() for rest in begun]
        best = {(number, rest): mass for mass, number, rest in queue}
        heapify(queue)
        while queue and len(found) < MOST + len(masses):
            mass, number, rest = heappop(queue)
            if (number, rest) in done:
                continue
            done.add((number, rest))
            found.setdefault(number)
            met: list[tuple[float, int, int]] = []
            if rest in steps:
                outcomes, later = steps[rest]
                there = outcomes[number].intended
                met.append((mass, number if there is None else there, later))
                if there is not None and there != number:
                    met.append((mass * VAIN, number, later))
            elif rest == _END:
                met += [(mass * AGAIN, number, each) for each in again]
            if mass * undone <= -LEAST:
                fallen = self._model.undone(number)
                met += [(mass * undone * share, each, rest) for share, each in fallen]
            for reached, other, each in met:
                if reached <= -LEAST and reached < best.get((other, each), 0.0):
                    best[other, each] = reached
                    heappush(queue, (reached, other, each))
        return list(found)

    def places(self, numbers: Iterable[int]) -> Places:
        """Where some joint states stand."""
        return np.array([self.place[number] for number in numbers], np.intp)

    def back(self, action: Action, after: Floats, failure: float, rates: Rates) -> Floats:
        """What is left to pay before an action.

        Args:
            action: It.
            after: What is left to pay after it, in every joint state that is told apart (rows), and
                last in all others.
            failure: How often it fails.
            rates: How often something is undone.
        """
        leads = self._leads.get(action) or self._led(action)
        fallen = self._fallen(after)
        failed = _mixed(after, fallen, rates.disturbance)
        worked = _mixed(after, fallen, rates.spontaneous) if rates.spontaneous else after
        found = _mixed(worked[leads.there], failed, failure)
        np.copyto(found, failed, where=leads.impossible)
        kept = _mixed(after, fallen, rates.redone) if rates.redone else after
        np.copyto(found, kept, where=leads.achieved)
        return found

    def forth(self, action: Action, masses: Floats, failure: float, rates: Rates) -> Floats:
        """How probable the joint states are after an action; `back` the other way round.

        Args:
            action: It.
            masses: How probable each is before it, and last all others.
            failure: How often it fails.
            rates: How often something is undone.
        """
        leads = self._leads.get(action) or self._led(action)
        achieved = leads.achieved[:, 0]
        kept, tried = np.where(achieved, masses, 0.0), np.where(achieved, 0.0, masses)
        failed = np.where(leads.impossible[:, 0], tried, failure * tried)
        worked = _gathered(leads.there, tried - failed, len(masses))
        parts = (kept, rates.redone), (failed, rates.disturbance), (worked, rates.spontaneous)
        return sum((self._fell(each, often) for each, often in parts), np.zeros(len(masses)))

    def _fell(self, masses: Floats, often: float) -> Floats:
        """How probable the joint states are after something may have been undone."""
        if not often:
            return masses
        falls = self._falls_known()
        if not len(falls.rows):
            return masses
        stays, falling = masses.copy(), masses[falls.rows] * falls.shares[:, 0]
        stays[falls.rows[falls.starts]] = 0.0
        fallen = stays + _gathered(falls.columns, falling, len(masses))
        return _mixed(masses, fallen, often)

    def _led(self, action: Action) -> _Leads:
        outcomes, last = self._model.outcomes(action), len(self.numbers)
        each = [outcomes[number] for number in self.numbers]
        there = [last if o.intended is None else self.place.get(o.intended, last) for o in each]
        impossible = [*(o.intended is None for o in each), False]
        achieved = [*(o.achieved for o in each), True]
        found = self._leads[action] = _Leads(
            np.array([*there, last], np.intp),
            np.array(impossible)[:, None],
            np.array(achieved)[:, None],
        )
        return found

    def _falls_known(self) -> _Falls:
        if self._falls is None:
            last = len(self.numbers)
            falls = [
                (place, self.place.get(other, last), share)
                for place, number in enumerate(self.numbers)
                for share, other in self._model.undone(number)
            ]
            rows = np.array([each[0] for each in falls], np.intp)
            columns = np.array([each[1] for each in falls], np.intp)
            shares = np.array([each[2] for each in falls])[:, None]
            self._falls = _Falls(rows, columns, shares, np.flatnonzero(np.diff(rows, prepend=-1)))
        return self._falls

    def _fallen(self, after: Floats) -> Floats:
        """What is left to pay where something was undone."""
        found, (rows, columns, shares, starts) = after.copy(), self._falls_known()
        if len(rows):
            parts = after.take(columns, axis=0)
            parts *= shares
            found[rows[starts]] = np.add.reduceat(parts, starts, axis=0)
        return found


def _mixed(first: Floats, second: Floats, share: float) -> Floats:
    """A share of the second, the rest of the first."""
    found: Floats = (1 - share) * first
    found += share * second
    return found


def _gathered(places: Places, masses: Floats, number: int) -> Floats:
    """What comes together at each of so many places."""
    return np.bincount(places, weights=masses, minlength=number).astype(np.float64)
