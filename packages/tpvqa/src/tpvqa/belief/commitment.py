"""Going on where nothing tells joint states apart: by one and the same way for all of them."""

from collections import defaultdict
from collections.abc import Iterable

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.faults import FaultModel
from tpvqa.belief.outlook import Outlook
from tpvqa.belief.sight import Sight
from tpvqa.pddl import Action, State

WAYS = 4
"""Ways that are compared for joint states that look alike, those of the most probable ones."""


class Commitments:
    """What it costs to go on from joint states that look alike.

    Which of them is true will not be known. Each of them has a way that would be the cheapest if
    it were; the one that costs least over all of them is followed. Where a step of it cannot be
    done and shows that, the way is changed there; where nothing shows it, the task fails.

    Args:
        model: The action model.
        ahead: The cheapest ways from single joint states.
        sight: Tells which look alike.
    """

    def __init__(self, model: FaultModel, ahead: Outlook, sight: Sight):
        self._model, self._ahead, self._sight = model, ahead, sight

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model

    def made(self, action: Action, predicted: Iterable[tuple[int, float]]) -> dict[int, float]:
        """What is left to pay from each joint state that looks like another one.

        Args:
            action: What was done.
            predicted: Joint states that an action leads to, with their probabilities.
        """
        if self._sight.complete:
            return {}
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
        ways = [self._ahead.best(number) for number in ranked[:WAYS]]
        found = [
            {number: self._along(way, number) for number in ranked}
            for way in dict.fromkeys(ways)
            if way is not None
        ]
        if not found:
            return {}
        return min(found, key=lambda costs: sum(masses[n] * cost for n, cost in costs.items()))

    def _along(self, way: tuple[int, AnnotatedPlan], number: int) -> float:
        """What a way costs from a joint state that it need not be the right one for."""
        place, plan = way
        if self._ahead.best(number) == way:
            return self._ahead.to_go(number)
        task, state, paid, alive = self._model.task, self._model.state(number), 0.0, 1.0
        ahead = self._ahead
        for action in plan.actions[place:]:
            after: State = task.apply(state, action)
            if after != state and not self._model.applicable(action, state):
                if not self._sight.hidden(action):  # it shows that this was not the way
                    return paid + alive * (ahead.step(action) + ahead.to_go(number))
                after = state
            paid += alive * ahead.step(action)
            paid += alive * ahead.dead(action) * ahead.failure
            alive *= 1 - ahead.dead(action)
            state = after
        return paid if task.goal_holds(state) else paid + alive * ahead.failure
