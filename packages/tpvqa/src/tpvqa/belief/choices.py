"""What can be done next, and what each is expected to cost."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import FaultModel, Rates
from tpvqa.belief.information import Floats
from tpvqa.pddl import Action, State

LIKELY = 0.02
"""Joint states of at least this probability get a plan of their own."""
CHOICES = 6
"""Choices that are compared, at most."""
IDLE = 0.97
"""An action that changes nothing with this probability is no choice."""
CHECKS = 2.0
"""Questions that a step of a plan is thought to take, for the cost of what lies ahead."""


@dataclass(frozen=True, slots=True)
class Choice:
    """Something that can be done now.

    Attributes:
        action: The action to execute; None to end the trial here.
        state: The most probable joint state in which this is the step to take.
    """

    action: Action | None
    state: State


@dataclass(frozen=True, slots=True)
class Table:
    """The choices with their costs.

    Attributes:
        choices: What can be done.
        numbers: The joint states.
        weights: Their probabilities, shape (states,).
        costs: Expected cost of each choice in each joint state, shape (states, choices).
    """

    choices: tuple[Choice, ...]
    numbers: tuple[int, ...]
    weights: Floats
    costs: Floats

    @property
    def expected(self) -> Floats:
        """The expected cost of every choice, shape (choices,)."""
        return self.weights @ self.costs

    @property
    def best(self) -> Choice:
        """The choice that is expected to cost least; of equal ones the first."""
        return self.choices[int(np.argmin(np.round(self.expected, 9)))]


class Chooser:
    """Compares what can be done next (Q-MDP: Littman, Cassandra and Kaelbling 1995).

    The cost of an action is its own, plus that of the plan from where it leads, as if the state
    were known from then on. What it would cost to find that out is not in it: what answers are
    worth is added by `information`.

    Args:
        model: The action model.
        costs: What things cost.

    Attributes:
        left: Actions that the trial still allows; None for any number. Where they are fewer than
            what a state needs, the task fails there.
        changes_left: Changes of plan that it still allows; None for any number.
    """

    def __init__(self, model: FaultModel, costs: Costs):
        self._model, self._costs = model, costs
        self.plans: list[AnnotatedPlan] = []
        self.hopeless: set[State] = set()
        self._found: dict[int, tuple[int, AnnotatedPlan] | None] = {}
        self._goals: dict[int, bool] = {}
        self._cost_of: dict[Action | None, dict[int, float]] = {}
        self._rest: dict[int, float] = {}
        self._ahead_of: dict[int, float] = {}
        self._lost: float | None = None
        self._rates = Rates()
        checks = CHECKS * (costs.question + costs.look)
        self._step = costs.action + min(checks, 0.1 * costs.action)
        self._postponed: set[State] = set()
        self.left: int | None = None
        self.changes_left: int | None = None

    def add(self, plan: AnnotatedPlan) -> None:
        """Take in a plan; the latest is preferred among equals."""
        if plan in self.plans:
            self.plans.remove(plan)
        self.plans.insert(0, plan)
        self._found.clear()
        self._forget()

    def give_up_on(self, state: State) -> None:
        """Note that no plan exists from a state."""
        self.hopeless.add(state)
        self._forget()

    def postpone(self, state: State) -> None:
        """Note that the planner found no plan in time; it may be asked after the next action."""
        self._postponed.add(state)

    def acted(self) -> None:
        """Note that an action was executed."""
        self._postponed.clear()

    def allow(self, actions: int | None, changes: int | None) -> None:
        """Note what the trial still allows.

        Args:
            actions: Actions; None for any number.
            changes: Changes of plan; None for any number.
        """
        if actions != self.left:
            self.left = actions
            self._forget()
        self.changes_left = changes

    def shortest(self, number: int) -> tuple[int, AnnotatedPlan] | None:
        """The fewest actions to the goal by a known plan, and that plan."""
        if number in self._found:
            return self._found[number]
        state, best = self._model.state(number), None
        for plan in self.plans:
            remaining = plan.remaining(state)
            if remaining is not None and (best is None or remaining < best[0]):
                best = remaining, plan
        self._found[number] = best
        return best

    def unplanned(self, belief: Belief) -> State | None:
        """The most probable joint state that no known plan helps; None if none is likely."""
        for number, weight in belief.ranked():
            if weight < LIKELY:
                return None
            state = self._model.state(number)
            if state in self.hopeless or state in self._postponed:
                continue
            if self.shortest(number) is None:
                return state
        return None

    def table(
        self,
        belief: Belief,
        rates: Rates,
        current: Sequence[Action],
        barred: Action | None = None,
    ) -> Table:
        """All choices and their costs in every joint state.

        Args:
            belief: What is believed.
            rates: Of faults.
            current: The plan that is being followed; other actions cost a change of plan.
            barred: An action that the trial does not allow now: it was repeated too often.
        """
        if rates != self._rates:
            self._rates = rates
            self._forget()
        ranked = belief.ranked()
        choices = [
            each
            for each in self._choices(ranked)
            if self._allowed(each, current, barred) and not self._idle(each, ranked)
        ]
        numbers = tuple(number for number, _ in ranked)
        changes = [
            self._costs.replan if each.action is not None and not self._in(each, current) else 0.0
            for each in choices
        ]
        columns = [self._column(each.action, numbers) for each in choices]
        return Table(
            tuple(choices),
            numbers,
            np.array([weight for _, weight in ranked]),
            np.array(columns).reshape(len(choices), len(ranked)).T + changes,
        )

    def _column(self, action: Action | None, numbers: Sequence[int]) -> list[float]:
        """The expected costs of a choice in some joint states."""
        known = self._cost_of.setdefault(action, {})
        for number in numbers:
            if number not in known:
                known[number] = self._cost(action, number)
        return [known[number] for number in numbers]

    def _cost(self, action: Action | None, number: int) -> float:
        """The expected cost of a choice in one joint state."""
        if action is None:
            return 0.0 if self._is_goal(number) else self._failure()
        f, d, s = self._rates.failure, self._rates.disturbance, self._rates.spontaneous
        outcomes = self._model.outcomes(action)[number]
        failed = self._to_go(number)
        if outcomes.achieved or outcomes.intended is None:
            failed = self._going_on(number)
        if outcomes.achieved:
            return self._step + failed
        if outcomes.undone:
            falls = sum(share * self._to_go(other) for share, other in outcomes.undone)
            failed = (1 - d) * failed + d * falls
        if outcomes.intended is None:
            return self._step + failed
        done = self._to_go(outcomes.intended)
        if outcomes.undone_after and s:
            falls = sum(share * self._to_go(other) for share, other in outcomes.undone_after)
            done = (1 - s) * done + s * falls
        return self._step + (1 - f) * done + f * failed

    def _going_on(self, number: int) -> float:
        """What is left after an action that could do nothing: the next one with its risks.

        `_to_go` knows no disturbances. If it were taken here, an action that changes nothing would
        look better than one that may go wrong.
        """
        known = self._ahead_of.get(number)
        if known is None:
            known, found = self._to_go(number), self.shortest(number)
            if found is not None and found[0]:
                action = found[1].actions[len(found[1].actions) - found[0]]
                outcomes = self._model.outcomes(action)[number]
                if outcomes.intended is not None and not outcomes.achieved:
                    known = max(known, self._cost(action, number))
            self._ahead_of[number] = known
        return known

    def _to_go(self, number: int) -> float:
        """What the rest of the shortest plan costs: repeated where checks say so, or unchecked."""
        known = self._rest.get(number)
        if known is None:
            known = self._rest[number] = self._worked_out(number)
        return known

    def _worked_out(self, number: int) -> float:
        found = self.shortest(number)
        if found is not None:
            steps: float = found[0]
        elif self._model.state(number) in self.hopeless:
            return self._failure()
        else:
            steps = self._longest() + 2
        if self.left is not None and steps >= self.left:  # the action at hand is one of them
            return self._failure()
        works: float = 1 - self._rates.failure
        unchecked = steps * self._costs.action + (1 - works**steps) * self._failure()
        return float(min(steps * self._ahead(), unchecked))

    def _ahead(self) -> float:
        """What a step of a plan costs, its checks and its repeats counted in."""
        step = self._costs.action + CHECKS * (self._costs.question + self._costs.look)
        return step / max(1 - self._rates.failure, 0.05)

    def _longest(self) -> int:
        return max((len(plan.actions) for plan in self.plans), default=0)

    def _failure(self) -> float:
        """What a failed task costs: at least twice what it takes to do it, so that long plans
        are worth their while."""
        if self._lost is None:
            acting = self._longest() * self._costs.action / max(1 - self._rates.failure, 0.05)
            self._lost = max(self._costs.failure, 2 * acting)
        return self._lost

    def _forget(self) -> None:
        """What was worked out holds for other plans, rates or limits."""
        self._cost_of.clear()
        self._rest.clear()
        self._ahead_of.clear()
        self._lost = None

    def _choices(self, ranked: Sequence[tuple[int, float]]) -> list[Choice]:
        found: dict[Action | None, Choice] = {}
        least = 0.1 * self._costs.action / self._costs.failure
        for number, weight in ranked:
            known = self.shortest(number)
            if known is None:
                continue
            if found and (weight < least or len(found) >= CHOICES):
                break
            remaining, plan = known
            place = len(plan.actions) - remaining
            action = plan.actions[place] if remaining else None
            if action not in found:
                found[action] = Choice(action, self._model.state(number))
        if None not in found:
            found[None] = Choice(None, self._model.state(ranked[0][0]))
        return list(found.values())

    def _allowed(self, choice: Choice, current: Sequence[Action], barred: Action | None) -> bool:
        """Whether the trial's limits allow a choice."""
        if choice.action is None:
            return True
        if barred is not None and self._model.same_skill(choice.action, barred, choice.state):
            return False
        return self.changes_left != 0 or self._in(choice, current)

    def _in(self, choice: Choice, plan: Sequence[Action]) -> bool:
        same, action = self._model.same_skill, choice.action
        return action is not None and any(same(action, each, choice.state) for each in plan)

    def _idle(self, choice: Choice, ranked: Sequence[tuple[int, float]]) -> bool:
        """Whether an action would almost surely change nothing.

        Q-MDP, which takes everything to be known after the next action, would wait for ever.
        """
        action = choice.action
        if action is None:
            return False
        leads_to, at_work = self._model.outcomes(action), 0.0
        for number, weight in ranked:
            if not leads_to[number].achieved:
                at_work += weight
                if at_work >= 1 - IDLE:
                    return False
        return True

    def _is_goal(self, number: int) -> bool:
        if number not in self._goals:
            self._goals[number] = self._model.task.goal_holds(self._model.state(number))
        return self._goals[number]
