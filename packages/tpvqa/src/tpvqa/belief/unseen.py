"""What it costs to go on without seeing: one way is followed whatever is true.

Q-MDP takes all to be known after the next action. Where the answers that can be had do not settle a
doubt, that is not so; a plan is then worth what it does unseen, every step repeated so often as the
risk that is left is worth another time.
"""

from collections.abc import Iterable, Sequence
from math import prod

import numpy as np

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import FaultModel
from tpvqa.belief.information import Floats
from tpvqa.belief.outlook import Outlook
from tpvqa.belief.table import Choice
from tpvqa.pddl import Action

Way = tuple[int, AnnotatedPlan] | None
"""A place in a plan, and that plan; None to end."""
Led = tuple[float, Sequence[tuple[float, int, float]]]
"""The probability of a joint state, and what an action leads to from it: shares, joint states, and
what each costs besides."""
WAYS = 4
"""Ways that are compared, those of the most probable joint states, besides ending."""
TIMES = (1, 2, 3, 4, 6, 8)
"""How often every step may be repeated."""


class Unseen:
    """What ways cost that are followed without a look.

    Args:
        model: The action model.
        ahead: The cheapest ways from single joint states.
        costs: What things cost.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, costs: Costs):
        self._model, self._ahead, self._costs = model, ahead, costs
        self._walks: dict[AnnotatedPlan, dict[tuple[int, int], tuple[int, ...] | None]] = {}
        self._paid: dict[tuple[int, int], dict[int, float]] = {}
        self._worked_out_for = -1

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._walks.clear()
        self._paid.clear()

    def columns(self, done: Action, led: Sequence[Led], states: int) -> list[Floats]:
        """What is left to pay after an action, for every way worth comparing.

        Args:
            done: The action.
            led: Of the most probable joint states, their probabilities and what it leads to.
            states: How many joint states there are; of the others the task fails.
        """
        ways = self.ways(
            (other, share * weight) for weight, after in led for share, other, _ in after
        )
        found = []
        for way in ways:
            column = np.full(states, self._ahead.failure)
            column[: len(led)] = [
                sum(share * (self.cost(way, other, done) + more) for share, other, more in after)
                for _, after in led
            ]
            found.append(column)
        return found

    def ends(self, choice: Choice, end: Floats) -> list[tuple[Choice, Floats, Floats]]:
        """To say that the goal is reached, where that is likely, or to give up: what each costs in
        the joint states, and what it has to do there (see `Table.work`).

        Args:
            choice: To end.
            end: What it costs where the goal is not reached.
        """
        likely = np.tile(np.where(end > 0, -0.5, 0.5), (2, 1))
        lost = np.full_like(end, self._ahead.failure)
        return [(choice, end, likely), (choice, lost, np.ones_like(likely))]

    def ways(self, predicted: Iterable[tuple[int, float]]) -> list[Way]:
        """The ways worth comparing.

        Args:
            predicted: Joint states with their probabilities.
        """
        masses: dict[Way, float] = {}
        for number, mass in predicted:
            way = self._ahead.best(number)
            if way is not None and way[0] < len(way[1].actions):
                masses[way] = masses.get(way, 0.0) + mass
        ranked = sorted(masses, key=lambda way: -masses[way])
        return [None, *ranked[:WAYS]]

    def cost(self, way: Way, number: int, done: Action) -> float:
        """What a way costs from a joint state, with the risk that it ends elsewhere.

        Args:
            way: The way.
            number: Of the joint state.
            done: The action before it; where the way begins with it, that counts.
        """
        if way is None:
            return 0.0 if self._ahead.is_goal(number) else self._ahead.failure
        if self._worked_out_for != self._ahead.version:
            self._worked_out_for = self._ahead.version
            self._paid.clear()
            for old in self._walks.keys() - {*self._ahead.plans}:
                del self._walks[old]
        place, plan = way
        known = self._paid.setdefault((id(plan), place), {})
        kind = self._model.kind(number)
        if kind not in known:
            known[kind] = self._worked_out(plan, place, number)
        begun = self._costs.action if plan.actions[place] == done else 0.0
        return known[kind] - begun

    def _worked_out(self, plan: AnnotatedPlan, place: int, number: int) -> float:
        steps = len(plan.actions) - place
        needed = self._walk(plan, place, number)
        times = self._times(plan, place)
        paid = times * steps * self._costs.action
        if needed is None:
            return paid + self._ahead.failure
        works = prod(self._works(plan.actions[step], times) for step in needed)
        return paid + (1 - works) * self._ahead.failure

    def _works(self, action: Action, times: int) -> float:
        """Probability that some tries do what is wanted, and nothing else."""
        failure = self._ahead.skill(action).failure
        failed = sum(failure**each for each in range(1, times + 1))
        return float((1 - failure**times) * (1 - self._ahead.disturbance) ** failed)

    def _times(self, plan: AnnotatedPlan, place: int) -> int:
        """How often every step is best repeated where the way is the right one."""
        known = self._paid[id(plan), place]
        if -1 not in known:
            rest = plan.actions[place:]

            def paid(times: int) -> float:
                lost = 1 - prod(self._works(each, times) for each in rest)
                return times * len(rest) * self._costs.action + lost * self._ahead.failure

            known[-1] = min(TIMES, key=paid)
        return int(known[-1])

    def _walk(self, plan: AnnotatedPlan, place: int, number: int) -> tuple[int, ...] | None:
        """The steps of a plan that change something on the way from a joint state to the goal;
        None where it does not lead there."""
        walks = self._walks.setdefault(plan, {})
        key = place, self._model.kind(number)
        if key not in walks:
            needed: list[int] = []
            for step in range(place, len(plan.actions)):
                there = self._model.outcomes(plan.actions[step])[number].intended
                if there is not None and there != number:
                    needed.append(step)
                    number = there
            walks[key] = tuple(needed) if self._ahead.is_goal(number) else None
        return walks[key]
