"""What actions cost where all that can be seen is seen after them."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.by_kind import Kinds
from tpvqa.belief.deciding.commitment import Commitments
from tpvqa.belief.deciding.falls import fallen
from tpvqa.belief.deciding.far_off import FarOff
from tpvqa.belief.deciding.outlook import CHECKS, Outlook
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.pddl import Action

DISTURBED = 0.02
"""In joint states of at least this probability it is worked out what disturbances would cost."""


class Seen:
    """Costs of actions by Q-MDP (Littman, Cassandra and Kaelbling 1995).

    The cost of an action is its own, plus that of the plan from where it leads, as if all that can
    be seen were known from then on. What nothing shows stays as unsure as it is: joint states that
    look alike are gone on from by one and the same way (`Commitments`).

    Args:
        model: The action model.
        ahead: What lies ahead of single joint states.
        sight: What can be seen.
        commitments: The ways on from joint states that look alike.
        costs: What things cost.

    Attributes:
        far: The costs in joint states that are hardly possible.
    """

    def __init__(
        self,
        model: FaultModel,
        ahead: Outlook,
        sight: Sight,
        commitments: Commitments,
        costs: Costs,
    ):
        self._model, self._ahead, self._sight = model, ahead, sight
        self._commitments = commitments
        checks = CHECKS * (costs.question + costs.look)
        self._step = costs.action + min(checks, 0.1 * costs.action)
        self.far = FarOff(model, ahead, self._step)
        self._going: dict[tuple[int, bool], float] = {}
        self._led: dict[Action, dict[tuple[int, bool], list[tuple[float, int, float]]]] = {}
        self._near: dict[Action, dict[int, float]] = {}

    def forget(self) -> None:
        """Note that costs have changed."""
        for known in (self._going, self._led, self._near):
            known.clear()
        self.far.forget()

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self.forget()
        self.far.renumbered(model)

    def column(
        self, action: Action, ranked: Sequence[tuple[int, float]], kinds: Kinds, rates: Rates
    ) -> Floats:
        """The expected costs of an action in the joint states."""
        together = self._together(action, ranked, rates)
        if together:
            return np.array([self._paid(action, *each, rates, together) for each in ranked])
        near, column = self._near.setdefault(action, {}), np.empty(len(ranked))
        many = sum(weight >= DISTURBED for _, weight in ranked)  # the first ones
        for place, (number, _) in enumerate(ranked[:many]):
            if number not in near:
                near[number] = self._paid(action, number, 1.0, rates, {})
            column[place] = near[number]
        if many < len(ranked):
            far, failure = ranked[many:], self._ahead.skill(action).failure
            idle = partial(self._idling, rates=rates, near=False)
            left = self.far.costs(action, far, kinds[many:], failure, rates, idle)
            column[many:] = self._step + left
        return column

    def _together(
        self, action: Action, ranked: Sequence[tuple[int, float]], rates: Rates
    ) -> dict[int, float]:
        """What is left to pay after an action where joint states look alike."""
        if self._sight.complete:
            return {}
        return self._commitments.made(
            action,
            (
                (other, weight * share)
                for number, weight in ranked
                for share, other, _ in self.successors(action, number, weight, rates)
            ),
        )

    def _paid(
        self,
        action: Action,
        number: int,
        weight: float,
        rates: Rates,
        together: Mapping[int, float],
    ) -> float:
        """What an action costs in a joint state, with all that lies ahead."""
        if self._ahead.no_way(number):
            return self._step + self._ahead.failure
        return self._step + sum(
            share * ((together[other] if other in together else self._ahead.to_go(other)) + more)
            for share, other, more in self.successors(action, number, weight, rates)
        )

    def successors(
        self, action: Action, number: int, weight: float, rates: Rates
    ) -> list[tuple[float, int, float]]:
        """What an action leads to from a joint state: shares, joint states, and what each costs
        besides."""
        near = weight >= DISTURBED
        led = self._led.setdefault(action, {})
        found = led.get((number, near))
        if found is None:
            found = led[number, near] = self._followed(action, number, rates, near=near)
        return found

    def _followed(
        self, action: Action, number: int, rates: Rates, *, near: bool
    ) -> list[tuple[float, int, float]]:
        outcomes, undone = self._model.outcomes(action)[number], self._sight.undone
        if outcomes.achieved:
            more = self._idling(number, rates, near=near)
            if near:
                return fallen(1.0, number, undone(number), rates.redone, more)
            return [(1.0, number, more + rates.redone * self._step)]
        there, failure = outcomes.intended, self._ahead.skill(action).failure
        idle = there is None or self._leads_away(action, number, there)
        more = self._idling(number, rates, near=near) if idle else 0.0
        failed = 1.0 if there is None else failure
        found: list[tuple[float, int, float]] = []
        if there is not None:
            after = undone(there) if near else ()
            found += fallen(1 - failure, there, after, rates.spontaneous, more)
        if near:
            found += fallen(failed, number, undone(number), rates.disturbance, more)
        else:
            found.append((failed, number, more + rates.disturbance * self._step))
        return found

    def _leads_away(self, action: Action, number: int, there: int) -> bool:
        """Whether an action of a long task leads away from the goal: so the risks of the next step
        are put off, too."""
        ahead = self._ahead
        if ahead.stake == 1.0 or action == ahead.next(number):
            return False
        return ahead.to_go(there) > ahead.to_go(number)

    def _idling(self, number: int, rates: Rates, *, near: bool) -> float:
        """What it costs besides to have done nothing: the risks of the next action remain.

        The way ahead knows no disturbances. If it were taken here, an action that changes nothing
        would look better than one that may go wrong.
        """
        known = self._going.get((number, near))
        if known is None:
            known, action = 0.0, self._ahead.next(number)
            if action is not None:
                outcomes = self._model.outcomes(action)[number]
                if outcomes.intended is not None and not outcomes.achieved:
                    scale = DISTURBED if near else 0.0  # only shares of it count
                    together = self._together(action, [(number, scale)], rates)
                    cost = self._paid(action, number, float(near), rates, together)
                    known = max(0.0, cost - self._ahead.to_go(number))
            self._going[number, near] = known
        return known
