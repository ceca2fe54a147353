"""What the rest of a long plan costs unseen, roughly."""

from collections.abc import Collection, Sequence
from itertools import compress
from math import prod

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.needed import Needed
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.pddl import Action

TIMES = (1, 2, 3, 4, 6)
"""How often every step may be repeated."""
HORIZON = 14
"""Steps of a plan that are followed exactly; what comes after them is worked out here."""


class LongRests:
    """What is left to pay for what comes after the first steps of a plan.

    Every step works, or what is undone while it is tried is brought about again by the rest of the
    plan, or the task fails: so it is worked out on the way from one joint state, and taken to be as
    much on those from others.

    Args:
        model: The action model.
        ahead: How often single skills fail, what a failed task costs, how many actions are left.
        costs: What things cost.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, costs: Costs):
        self._model, self._ahead, self._costs = model, ahead, costs
        self._needed: dict[AnnotatedPlan, Needed | None] = {}
        self._walks: dict[AnnotatedPlan, dict[tuple[int, int], bytes | None]] = {}
        self._lost: dict[AnnotatedPlan, dict[int, float]] = {}
        self._repeats: dict[tuple[int, int], int] = {}
        self._working: dict[tuple[int, int, int], list[float]] = {}
        self._rests: dict[tuple[int, int], Floats] = {}

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        for by_number in (self._needed, self._walks, self._lost, self._rests):
            by_number.clear()

    def forget(self, plans: Collection[AnnotatedPlan]) -> None:
        """What was worked out holds for other rates, or joint states.

        Args:
            plans: Those that are still known.
        """
        for worked_out in (self._repeats, self._working, self._rests):
            worked_out.clear()
        for old in self._walks.keys() - {*plans}:
            for by_plan in (self._needed, self._walks, self._lost):
                by_plan.pop(old, None)

    def of(self, plan: AnnotatedPlan, place: int, numbers: Sequence[int]) -> Floats:
        """What is left to pay from a place of a plan, in some joint states, and last in others.

        Args:
            plan: It.
            place: The next step.
            numbers: The joint states; the same ones until something is forgotten.
        """
        known = self._rests.get((id(plan), place))
        if known is not None:
            return known
        walks = self._walks.setdefault(plan, {})
        for number in numbers:
            if (place, number) not in walks:
                walks[place, number] = self._walk(plan, place, number)
        right = (each for each in numbers if walks[place, each] is not None)
        self._see_what_is_lost(plan, place, next(right, None))
        times = self.repeated(plan, place)
        working = self._all_work(plan, times)[place:]
        paid = times * len(working) * self._costs.action
        rests = list[float]()
        for number in numbers:
            needed = walks[place, number]
            works = 0.0 if needed is None else prod(compress(working, needed))
            rests.append(paid + (1 - works) * self._ahead.failure)
        found = self._rests[id(plan), place] = np.array([*rests, self._ahead.failure])
        return found

    def _see_what_is_lost(self, plan: AnnotatedPlan, place: int, number: int | None) -> None:
        """Work out of the steps of a plan, on the way from a joint state, how much of what may be
        undone before them the rest of the plan does not bring about again."""
        lost = self._lost.setdefault(plan, {})
        for step in range(place, len(plan.actions)):
            if step in lost or number is None:
                break
            lost[step] = sum(
                share
                for share, other in self._model.undone(number)
                if self._walk(plan, step, other) is None
            )
            there = self._model.outcomes(plan.actions[step])[number].intended
            number = number if there is None else there

    def _all_work(self, plan: AnnotatedPlan, times: int) -> list[float]:
        """Of every step of a plan the probability that some tries do what is wanted."""
        lost = self._lost.get(plan, {})
        key = id(plan), times, len(lost)
        known = self._working.get(key)
        if known is None:
            known = self._working[key] = [
                self._works(action, times, lost.get(step, 1.0))
                for step, action in enumerate(plan.actions)
            ]
        return known

    def _works(self, action: Action, times: int, lost: float) -> float:
        """Probability that some tries do what is wanted, and nothing else that is not mended."""
        failure = self._ahead.skill(action).failure
        failed = sum(failure**each for each in range(1, times + 1))
        return float((1 - failure**times) * (1 - lost * self._ahead.rates.disturbance) ** failed)

    def repeated(self, plan: AnnotatedPlan, place: int) -> int:
        """How often every step is best repeated where the way is the right one."""
        known = self._repeats.get((id(plan), place))
        if known is None:
            steps = len(plan.actions) - place

            def paid(times: int) -> float:
                lost = 1 - prod(self._all_work(plan, times)[place:])
                return times * steps * self._costs.action + lost * self._ahead.failure

            left = self._ahead.left  # of which some go to the steps before it
            fits = [n for n in TIMES if left is None or n * (HORIZON + steps) <= left]
            known = self._repeats[id(plan), place] = min(fits or TIMES[:1], key=paid)
        return known

    def _walk(self, plan: AnnotatedPlan, place: int, number: int) -> bytes | None:
        """Which steps of a plan change something on the way from a joint state to the goal; None
        where it does not lead there."""
        if plan not in self._needed:
            self._needed[plan] = self._ahead.needed(plan)
        quick = self._needed[plan]
        if quick is not None and quick.fixed <= self._model.state(number):
            needed, holding = quick.walk(place, self._model.holding(number))
            return bytes(needed) if self._model.goal_within(holding) else None
        needed = []
        for action in plan.actions[place:]:
            there = self._model.outcomes(action)[number].intended
            needed.append(there is not None and there != number)
            number = number if there is None else there
        return bytes(needed) if self._ahead.is_goal(number) else None
