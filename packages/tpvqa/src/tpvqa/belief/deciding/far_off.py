"""What actions cost in joint states that are hardly possible: all of them at once."""

from collections.abc import Callable, Sequence

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.deciding.by_kind import ByKind, Kinds
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.pddl import Action

Ranked = Sequence[tuple[int, float]]
"""Joint states by number, with their probabilities."""


class FarOff:
    """Costs of actions where only what holds counts, and not how it came about.

    Args:
        model: The action model.
        ahead: What lies ahead of single joint states.
        step: What an action costs with its checks.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, step: float):
        self._model, self._ahead, self._step = model, ahead, step
        self._does: dict[Action, ByKind] = {}
        self.forget()

    def forget(self) -> None:
        """Note that costs have changed."""
        self._to_go, self._idle, self._lost = ByKind(1), ByKind(1), ByKind(1)

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._does.clear()
        self.forget()

    def does(self, action: Action, ranked: Ranked, kinds: Kinds) -> Floats:
        """For each joint state whether something is left to do for an action, whether it can be
        done, and the number of the joint state that it leads to.

        Args:
            action: The action.
            ranked: The joint states.
            kinds: Their kinds.
        """
        leads_to, first = self._model.outcomes(action), self._model.first

        def done(place: int) -> tuple[float, float, float]:
            outcomes = leads_to[first(ranked[place][0])]
            there = outcomes.number if outcomes.intended is None else outcomes.intended
            return float(not outcomes.achieved), float(outcomes.intended is not None), there

        return self._does.setdefault(action, ByKind(3)).of(kinds, done)

    def costs(
        self,
        action: Action,
        ranked: Ranked,
        kinds: Kinds,
        failure: float,
        rates: Rates,
        idling: Callable[[int], float],
    ) -> Floats:
        """What is left to pay after an action.

        Args:
            action: The action.
            ranked: The joint states.
            kinds: Their kinds.
            failure: How often it fails.
            rates: How often something is undone: that costs one more action.
            idling: What it costs in a joint state to have done nothing.
        """
        model, to_go, no_way = self._model, self._ahead.to_go, self._ahead.no_way
        undone, possible, led = self.does(action, ranked, kinds).T
        numbers = led.astype(np.intp).tolist()
        there = np.array([model.kind(number) for number in numbers], np.intp)
        stays = self._to_go.of(kinds, lambda place: (to_go(ranked[place][0]),))[:, 0]
        leads = self._to_go.of(there, lambda place: (to_go(numbers[place]),))[:, 0]
        idle, waits = np.zeros(len(ranked)), np.flatnonzero((undone == 0) | (possible == 0))

        def waiting(place: int) -> tuple[float]:
            return (idling(model.first(ranked[waits[place]][0])),)

        idle[waits] = self._idle.of(kinds[waits], waiting)[:, 0]
        fails = stays + (idle + rates.disturbance * self._step)
        tried = np.where(possible > 0, (1 - failure) * leads + failure * fails, fails)
        found: Floats = np.where(undone > 0, tried, stays + idle + rates.redone * self._step)
        lost = self._lost.of(kinds, lambda place: (float(no_way(ranked[place][0])),))[:, 0]
        return np.where(lost > 0, stays, found)
