"""What can be done next, and what each is expected to cost."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.by_kind import Kinds
from tpvqa.belief.commitment import Commitments
from tpvqa.belief.costs import Costs
from tpvqa.belief.falls import fallen
from tpvqa.belief.far_off import FarOff
from tpvqa.belief.faults import FaultModel, JointState, Rates
from tpvqa.belief.information import Floats
from tpvqa.belief.outlook import CHECKS, Outlook
from tpvqa.belief.rounds import Rounds
from tpvqa.belief.settling import SETTLED
from tpvqa.belief.sight import Sight
from tpvqa.belief.table import Choice, Table
from tpvqa.belief.unseen import Unseen
from tpvqa.pddl import Action, State, Task

LIKELY = 0.02
"""Joint states of at least this probability get a plan of their own."""
UNLIKELY = 4
"""Plans between two actions from joint states that are less probable than that."""
ENDS = 2
"""Plans between two actions from where a way may end as nothing shows that it is not the way."""
CHOICES = 6
"""Choices that are compared, at most."""
IDLE = 0.97
"""An action that changes nothing with this probability is no choice."""
HIDDEN_IDLE = 0.99
"""The same where nothing shows what it does: what it costs tells how often it is worth doing."""
FLOOR = 0.1
"""An action is no choice whose preconditions hold with less than this, where it is not done."""
SEVERAL = 40
"""Joint states of which it is worked out what they cost unseen; the rest is lost."""
DISTURBED = 0.02
"""In joint states of at least this probability it is worked out what disturbances would cost."""


class Chooser:
    """Compares what can be done next (Q-MDP: Littman, Cassandra and Kaelbling 1995).

    The cost of an action is its own, plus that of the plan from where it leads, as if all that can
    be seen were known from then on. What nothing shows stays as unsure as it is: joint states that
    look alike are gone on from by one and the same way (`Commitments`). What it would cost to find
    out the rest is not in it: what answers are worth is added by `information`.

    Args:
        model: The action model.
        costs: What things cost.
        sight: What can be seen; by default everything.
        task: Says what the goal is; by default the model's task.

    Attributes:
        ahead: What lies ahead of single joint states.
        changes_left: Changes of plan that the trial still allows; None for any number.
        rounds: What was done where.
    """

    def __init__(
        self,
        model: FaultModel,
        costs: Costs,
        sight: Sight | None = None,
        task: Task | None = None,
    ):
        self._model, self._costs = model, costs
        self._sight = sight or Sight(model)
        self.ahead = Outlook(model, costs, self._sight, task)
        self._commitments = Commitments(model, self.ahead, self._sight)
        self._unseen = Unseen(model, self.ahead, costs)
        self.settles, self.finding = 1.0, 0.0
        self._going: dict[tuple[int, bool], float] = {}
        self._led: dict[Action, dict[tuple[int, bool], list[tuple[float, int, float]]]] = {}
        self._near: dict[Action, dict[int, float]] = {}
        checks = CHECKS * (costs.question + costs.look)
        self._step = costs.action + min(checks, 0.1 * costs.action)
        self._far = FarOff(model, self.ahead, self._step)
        self._worked_out_for: tuple[int, Rates] | None = None
        self._sought: set[State] = set()
        self._unlikely = self._ends = 0
        self.rounds = Rounds(costs.action)
        self.changes_left: int | None = None

    @property
    def plans(self) -> Sequence[AnnotatedPlan]:
        """The known plans."""
        return self.ahead.plans

    def acted(self, belief: Belief, action: Action) -> None:
        """Note that an action is executed, before the belief predicts what it leads to."""
        self._sought.clear()
        self._unlikely = self._ends = 0
        self.rounds.acted(belief.ranked()[0][0], action)

    def renumbered(self, model: FaultModel, numbers: Mapping[int, int]) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._sight.renumbered(model)
        self.ahead.renumbered(model)
        self._commitments.renumbered(model)
        self._unseen.renumbered(model)
        self._near.clear()
        self._far.renumbered(model)
        self.rounds.renumbered(numbers)

    def way(self, state: State) -> tuple[int, AnnotatedPlan] | None:
        """The cheapest known way from a state: a place in a plan, and that plan."""
        return self.ahead.best(self._model.number(JointState(state)))

    def unplanned(self, belief: Belief) -> State | None:
        """The most probable joint state that no known plan helps; None if none is likely.

        Many that are unlikely each are likely together: then the first few of them count too. For
        none is a plan sought twice between two actions.
        """
        found: State | None = None
        together = 0.0
        for number, weight in belief.ranked():
            if weight < LIKELY / 10:
                break
            state = self._model.state(number)
            if state in self.ahead.hopeless or state in self._sought:
                continue
            if self.ahead.best(number) is None:
                if weight >= LIKELY:
                    self._sought.add(state)
                    return state
                found = found or state
                together += weight
        if together < LIKELY or self._unlikely >= UNLIKELY:
            return self._foreseen()
        self._unlikely += 1
        if found is not None:
            self._sought.add(found)
        return found

    def foresees(self) -> bool:
        """Whether a way on may end where no plan is known, so that one is worth having."""
        return self._foreseen(sought=False) is not None

    def _foreseen(self, *, sought: bool = True) -> State | None:
        """The most probable such end; noted as one for which a plan is sought, or not."""
        ends = self._commitments.unplanned
        if not ends or self._ends >= ENDS:
            return None
        state = max(ends, key=ends.__getitem__)
        if ends[state] < LIKELY or state in self._sought or state in self.ahead.hopeless:
            return None
        if sought:
            self._ends += 1
            self._sought.add(state)
        return state

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
            rates: Of disturbances; how often single skills fail is known to `ahead`.
            current: The plan that is being followed; other actions cost a change of plan.
            barred: An action that the trial does not allow now: it was repeated too often.
        """
        self.ahead.may_be_blind(self.settles < SETTLED)
        if (self.ahead.version, rates) != self._worked_out_for:
            self._worked_out_for = self.ahead.version, rates
            for known in (self._going, self._led, self._near):
                known.clear()
            self._far.forget()
        ranked = belief.ranked()
        kinds = np.array([self._model.kind(number) for number, _ in ranked], np.intp)
        self._commitments.unplanned.clear()
        choices = [
            each
            for each in self._choices(ranked)
            if self._allowed(each, current, barred) and self._worth_a_try(each)
        ]
        weights = np.array([weight for _, weight in ranked])
        work = {each: self._work(each, ranked, kinds) for each in choices}
        acts = any(
            each.action is not None and (work[each] @ weights >= 0).all() for each in choices
        )
        if not acts and not self._goal_likely(ranked):  # to try is better than to end
            for limits in work.values():
                limits[1] = 1.0
        if self._stuck(ranked):
            choices = [each for each in choices if each.action is None]
        found: list[tuple[Choice, Floats, Floats]] = []
        for each in choices:
            if each.action is None:
                end, unseen = self._end(ranked), self.settles < SETTLED
                found += self._unseen.ends(each, end) if unseen else [(each, end, work[each])]
                continue
            more = 0.0 if self._in(each, current) else self._costs.replan
            more += self.rounds.dearer(each.action, ranked[0][0], self.ahead.progress)
            seen = self._column(each.action, ranked, kinds, rates) + more
            if self.settles >= SETTLED:
                found.append((each, seen, work[each]))
                continue
            for blind in self._blind(each.action, ranked, rates):
                found_out = self.settles * seen + (1 - self.settles) * (blind + more)
                for column in (found_out + self.finding, blind + more):
                    found.append((each, column, work[each]))
        told, numbers = tuple(each[0] for each in found), tuple(number for number, _ in ranked)
        costs = np.stack([each[1] for each in found], axis=1)
        return Table(told, numbers, weights, costs, np.stack([each[2] for each in found], axis=2))

    def _blind(
        self, action: Action, ranked: Sequence[tuple[int, float]], rates: Rates
    ) -> list[Floats]:
        """The expected costs of an action in the joint states, where nothing is seen after it, for
        every way to go on."""
        led = [
            (weight, self._successors(action, number, weight, rates))
            for number, weight in ranked[:SEVERAL]
        ]
        return [self._step + column for column in self._unseen.columns(action, led, len(ranked))]

    def _end(self, ranked: Sequence[tuple[int, float]]) -> Floats:
        lost = self.ahead.failure
        return np.array([0.0 if self.ahead.is_goal(number) else lost for number, _ in ranked])

    def _column(
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
            far, failure = ranked[many:], self.ahead.skill(action).failure
            idle = partial(self._idling, rates=rates, near=False)
            left = self._far.costs(action, far, kinds[many:], failure, rates.disturbance, idle)
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
                for share, other, _ in self._successors(action, number, weight, rates)
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
        to_go = self.ahead.to_go
        return self._step + sum(
            share * ((together[other] if other in together else to_go(other)) + more)
            for share, other, more in self._successors(action, number, weight, rates)
        )

    def _successors(
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
        outcomes = self._model.outcomes(action)[number]
        if outcomes.achieved:
            return [(1.0, number, self._idling(number, rates, near=near))]
        possible, failure = outcomes.intended is not None, self.ahead.skill(action).failure
        failed = failure if possible else 1.0
        more = 0.0 if possible else self._idling(number, rates, near=near)
        found: list[tuple[float, int, float]] = []
        if outcomes.intended is not None:
            after = outcomes.undone_after if near else ()
            found += fallen(1 - failure, outcomes.intended, after, rates.spontaneous)
        if near:
            found += fallen(failed, number, outcomes.undone, rates.disturbance, more)
        else:
            found.append((failed, number, more + rates.disturbance * self._step))
        return found

    def _idling(self, number: int, rates: Rates, *, near: bool) -> float:
        """What it costs besides to have done nothing: the risks of the next action remain.

        The way ahead knows no disturbances. If it were taken here, an action that changes nothing
        would look better than one that may go wrong.
        """
        known = self._going.get((number, near))
        if known is None:
            known, action = 0.0, self.ahead.next(number)
            if action is not None:
                outcomes = self._model.outcomes(action)[number]
                if outcomes.intended is not None and not outcomes.achieved:
                    scale = DISTURBED if near else 0.0  # only shares of it count
                    together = self._together(action, [(number, scale)], rates)
                    cost = self._paid(action, number, float(near), rates, together)
                    known = max(0.0, cost - self.ahead.to_go(number))
            self._going[number, near] = known
        return known

    def _choices(self, ranked: Sequence[tuple[int, float]]) -> list[Choice]:
        found: dict[Action | None, Choice] = {}
        least, left = 0.1 * self._costs.action / self._costs.failure, 1.0
        for number, weight in ranked:
            if found and (left < least or len(found) >= CHOICES):
                break
            left -= weight
            if self.ahead.best(number) is None:
                continue
            action = self.ahead.next(number)
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

    def _worth_a_try(self, choice: Choice) -> bool:
        """Whether what one more try may win is worth an action."""
        return choice.action is None or not self.ahead.given_up(choice.action)

    def _goal_likely(self, ranked: Sequence[tuple[int, float]]) -> bool:
        return sum(weight for number, weight in ranked if self.ahead.is_goal(number)) >= 0.5

    def _stuck(self, ranked: Sequence[tuple[int, float]]) -> bool:
        """Whether all ways that are known lead through something that does not work any more."""
        return sum(weight for number, weight in ranked if self.ahead.blocked(number)) > 0.5

    def _in(self, choice: Choice, plan: Sequence[Action]) -> bool:
        same, action = self._model.same_skill, choice.action
        return action is not None and any(same(action, each, choice.state) for each in plan)

    def _work(self, choice: Choice, ranked: Sequence[tuple[int, float]], kinds: Kinds) -> Floats:
        """What a choice has to do in the joint states: what it would change, and what it can, each
        less how probable that has to be; shape (2, states).

        Q-MDP, which takes everything to be known after the next action, would wait for ever.
        """
        found = np.ones((2, len(ranked)))
        if choice.action is not None:
            # Who does in vain what nothing shows never learns that it is in vain.
            hidden = self._sight.hidden(choice.action)
            works = 1 - self.ahead.skill(choice.action).failure if hidden else 1.0
            idle = HIDDEN_IDLE if hidden else IDLE
            undone, possible = self._done_by(choice.action, ranked, kinds)
            found[0] = works * undone * possible - (1 - idle)
            found[1] = undone * (possible - FLOOR)
        return found

    def _done_by(self, action: Action, ranked: Sequence[tuple[int, float]], kinds: Kinds) -> Floats:
        """Where something is left to do for an action, and where it can be done; shape (2,
        states)."""
        return self._far.does(action, ranked, kinds).T[:2]
