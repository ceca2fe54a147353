"""Going on where nothing tells joint states apart: by one and the same way for all of them."""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from enum import Enum, auto
from itertools import islice
from typing import NamedTuple

from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.filtering.sight import Sight
from tpvqa.pddl import Action, State

WAYS = 4
"""Ways that are compared for joint states that look alike, those of the most probable ones."""


class Commitments:
    """What it costs to go on from joint states that look alike.

    Which of them is true will not be known. Each of them has a way that would be the cheapest if
    it were; the one that costs least over all of them is followed. Where a step of it cannot be
    done and shows that, the way is changed there; where nothing shows it, the task fails. A step
    that nothing shows, and that only some of them still need, is done again as often as these are
    probable enough for it.

    Args:
        model: The action model.
        ahead: The cheapest ways from single joint states.
        sight: Tells which look alike.

    Attributes:
        unplanned: Where ways may end that cannot be followed further, and no plan is known to go on
            from there, with how probable that is in the joint states that were asked for.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, sight: Sight):
        self._model, self._ahead, self._sight = model, ahead, sight
        self._walks: dict[AnnotatedPlan, dict[tuple[int, int], _Walk]] = {}
        self._spendings: dict[tuple[int, int, int], tuple[float, float]] = {}
        self._worked_out_for = self._shown_by = -1
        self.unplanned: dict[State, float] = defaultdict(float)

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._walks.clear()

    def made(self, action: Action, predicted: Iterable[tuple[int, float]]) -> dict[int, float]:
        """What is left to pay from each joint state that looks like another one.

        Args:
            action: What was done.
            predicted: Joint states that an action leads to, with their probabilities.
        """
        if self._sight.complete:
            return {}
        if self._shown_by != self._sight.version:
            self._shown_by = self._sight.version
            self._walks.clear()
        for old in self._walks.keys() - {*self._ahead.plans}:
            del self._walks[old]
        masses: dict[int, float] = defaultdict(float)
        for number, mass in predicted:
            masses[number] += mass
        alike: dict[int, list[int]] = defaultdict(list)
        for number in masses:
            alike[self._sight.look(number, action)].append(number)
        costs: dict[int, float] = {}
        for numbers in alike.values():
            if len({self._model.state(number) for number in numbers}) > 1:
                costs |= self._together(numbers, masses)
        return costs

    def _together(self, numbers: list[int], masses: dict[int, float]) -> dict[int, float]:
        ranked = [number for number, _ in self._model.ranked({n: masses[n] for n in numbers})]
        ways = dict.fromkeys(way for way in map(self._ahead.best, ranked) if way is not None)
        found = [self._costs(*way, ranked, masses) for way in islice(ways, WAYS)]
        if not found:
            return {}
        return min(found, key=lambda costs: sum(masses[n] * cost for n, cost in costs.items()))

    def _costs(
        self, place: int, plan: AnnotatedPlan, ranked: Sequence[int], masses: Mapping[int, float]
    ) -> dict[int, float]:
        """What a way costs from each of the joint states that look alike."""
        costs = {number: self._along((place, plan), number, masses[number]) for number in ranked}
        walks = {number: self._walk(plan, place, number) for number in ranked}
        for step in sorted(set[int]().union(*(walk.idle for walk in walks.values()))):
            there = [number for number, walk in walks.items() if step < walk.stop]
            needed = {number for number in there if step not in walks[number].idle}
            action, whole = plan.actions[step], sum(masses[number] for number in there)
            likely = sum(masses[number] for number in needed) / whole if whole > 0 else 0.0
            tries, risk = self._ahead.unseen(action, likely)
            for number in there:  # instead of as many tries as if it were needed for certain
                costs[number] += tries + (risk if number in needed else 0.0)
                costs[number] -= self._ahead.step(action)
        return costs

    def _along(self, way: tuple[int, AnnotatedPlan], number: int, mass: float) -> float:
        """What a way costs from a joint state that it need not be the right one for."""
        place, plan = way
        ahead = self._ahead
        if ahead.best(number) == way:
            return ahead.to_go(number)
        stop, end, _, there = self._walk(plan, place, number)
        paid, alive = self._spent(plan, place, stop)
        if end is _End.SEEN:
            if ahead.best(there) is None:
                self.unplanned[self._model.state(there)] += mass
            return paid + alive * (ahead.step(plan.actions[stop]) + ahead.to_go(there))
        return paid if end is _End.GOAL else paid + alive * ahead.failure

    def _walk(self, plan: AnnotatedPlan, place: int, number: int) -> "_Walk":
        """How a way goes from a joint state."""
        walks = self._walks.setdefault(plan, {})
        known = walks.get((place, number))
        if known is None:
            known = walks[place, number] = self._walked(plan, place, number)
        return known

    def _walked(self, plan: AnnotatedPlan, place: int, number: int) -> "_Walk":
        task, state = self._model.task, self._model.state(number)
        idle = list[int]()
        for stop in range(place, len(plan.actions)):
            action = plan.actions[stop]
            after: State = task.apply(state, action)
            if after == state:
                if self._sight.hidden(action):
                    idle.append(stop)
            elif not self._model.applicable(action, state):
                if not self._sight.hidden(action):
                    there = self._model.become(number, state)
                    return _Walk(stop, _End.SEEN, frozenset(idle), there)
                after = state
            state = after
        end = _End.GOAL if self._ahead.reached(state) else _End.LOST
        return _Walk(len(plan.actions), end, frozenset(idle), number)

    def _spent(self, plan: AnnotatedPlan, place: int, stop: int) -> tuple[float, float]:
        """What the steps of a plan cost up to another, and how probable it is to get there."""
        if self._worked_out_for != self._ahead.version:
            self._worked_out_for = self._ahead.version
            self._spendings.clear()
        known = self._spendings.get((id(plan), place, stop))
        if known is None:
            paid, alive = 0.0, 1.0
            for action in plan.actions[place:stop]:
                dead = self._ahead.dead(action)
                paid += alive * (self._ahead.step(action) + dead * self._ahead.failure)
                alive *= 1 - dead
            known = self._spendings[id(plan), place, stop] = paid, alive
        return known


class _End(Enum):
    """How a way ends: at the goal, where a step shows that it was not the way, or unnoticed."""

    GOAL = auto()
    SEEN = auto()
    LOST = auto()


class _Walk(NamedTuple):
    """How a way goes from a joint state.

    Attributes:
        stop: The step at which it ends.
        end: How.
        idle: Steps of which nothing shows whether they did anything, and which had nothing to do.
        there: The joint state in which it is seen that the way cannot be followed further.
    """

    stop: int
    end: _End
    idle: frozenset[int]
    there: int
