"""What single steps do unseen, over many joint states at once."""

from collections.abc import Callable, Collection, Iterable, Mapping
from heapq import heapify, heappop, heappush
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.faults import FaultModel, Rates
from tpvqa.belief.information import Floats
from tpvqa.pddl import Action

MOST = 260
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
        self._covered: frozenset[Way] = frozenset()
        self._leads: dict[Action, _Leads] = {}
        self._falls: _Falls | None = None

    def cover(
        self,
        masses: Mapping[int, float],
        ways: Collection[Way],
        rates: Rates,
        reached: Callable[[int], bool],
    ) -> None:
        """Tell apart what some ways may lead to.

        Args:
            masses: From where, with probabilities.
            ways: They; where one has not led to the goal, another one may follow.
            rates: How often they undo something.
            reached: Whether a joint state is one of the goal.
        """
        if masses.keys() <= self.place.keys() and self._covered.issuperset(ways):
            return
        self.version += 1
        self._covered = frozenset(way[n:] for way in ways for n in range(len(way)))
        often = max(rates.undone, rates.redone)
        self.numbers = self._reached(masses, ways, min(1.0, TRIES * often), reached)
        self.place = {number: place for place, number in enumerate(self.numbers)}
        self._leads.clear()
        self._falls = None

    def _reached(
        self,
        masses: Mapping[int, float],
        ways: Collection[Way],
        undone: float,
        reached: Callable[[int], bool],
    ) -> list[int]:
        """The joint states that are met on the ways, the most probable ones."""
        rests: dict[Way, int] = {}
        for way in ways:
            for step in range(len(way) + 1):
                rests.setdefault(way[step:], len(rests))
        leads_to = [self._model.outcomes(rest[0]) if rest else None for rest in rests]
        later, begun = [rests[rest[1:]] for rest in rests], [rests[way] for way in ways]
        found, done = dict.fromkeys(masses), set[tuple[int, int]]()
        queue = [(-mass, number, rest) for number, mass in masses.items() for rest in begun]
        heapify(queue)
        while queue and len(found) < MOST + len(masses):
            mass, number, rest = heappop(queue)
            if (number, rest) in done:
                continue
            done.add((number, rest))
            found.setdefault(number)
            outcomes = leads_to[rest]
            met = [(share * undone, each, rest) for share, each in self._model.undone(number)]
            if outcomes is not None:
                there = outcomes[number].intended
                met.append((1.0, number if there is None else there, later[rest]))
                if there is not None and there != number:
                    met.append((VAIN, number, later[rest]))
            elif not reached(number):
                met += [(AGAIN, number, each) for each in begun]
            for share, other, each in met:
                if -mass * share >= LEAST and (other, each) not in done:
                    heappush(queue, (mass * share, other, each))
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

    def _fallen(self, after: Floats) -> Floats:
        """What is left to pay where something was undone."""
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
        found, (rows, columns, shares, starts) = after.copy(), self._falls
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
