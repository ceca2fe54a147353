"""What can be done next, and what each is expected to cost."""

from collections.abc import Mapping, Sequence

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.by_kind import Kinds
from tpvqa.belief.deciding.commitment import Commitments
from tpvqa.belief.deciding.doing import BARELY, IDLE, Doing, moved
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.deciding.rounds import Rounds
from tpvqa.belief.deciding.seeking import Seeking
from tpvqa.belief.deciding.seen import Seen
from tpvqa.belief.deciding.table import Choice, Table
from tpvqa.belief.deciding.unseen import Unseen
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, JointState, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.weighing.settling import SETTLED
from tpvqa.pddl import Action, State, Task

CHOICES = 6
"""Choices that are compared, at most."""
SEVERAL = 40
"""Joint states of which it is worked out what they cost unseen; the rest is lost."""
NEWS = 0.3
"""What is followed unseen is decided anew where so much of the belief has moved since."""


class Chooser:
    """Compares what can be done next.

    An action costs what it costs where all that can be seen is seen after it (`Seen`), as far as
    answers settle what is in doubt, and what it costs where nothing is (`Unseen`), as far as they
    do not. What it costs to find out is not in it: what answers are worth is added by
    `information`.

    Args:
        model: The action model.
        costs: What things cost.
        sight: What can be seen; by default everything.
        task: Says what the goal is; by default the model's task.

    Attributes:
        ahead: What lies ahead of single joint states.
        changes_left: Changes of plan that the trial still allows; None for any number.
        rounds: What was done where.
        seeking: From where plans are wanted.
        settles: How far answers settle what is in doubt.
        finding: What it costs to ask so much.
        blind: Whether answers say nothing, so that what was decided is followed to its end.
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
        self.settles, self.finding, self.blind = 1.0, 0.0, False
        self._decided: Mapping[int, float] | None = None
        self._seen = Seen(model, self.ahead, self._sight, self._commitments, costs)
        self._worked_out_for: tuple[int, Rates] | None = None
        self._doing = Doing(model, self.ahead, self._seen.far, self._sight)
        self.seeking = Seeking(model, self.ahead, self._commitments)
        self.rounds = Rounds(costs.action)
        self.changes_left: int | None = None

    @property
    def plans(self) -> Sequence[AnnotatedPlan]:
        """The known plans."""
        return self.ahead.plans

    def acted(self, belief: Belief, action: Action) -> None:
        """Note that an action is executed, before the belief predicts what it leads to."""
        self._decided = None
        self.seeking.acted()
        self._doing.acted(action, belief.ranked())
        number = belief.ranked()[0][0]
        self.rounds.acted(action, belief.ranked(), self._model.outcomes(action)[number].intended)
        state = self._model.state(number)
        if self.settles < SETTLED and not self.follows(action, state):
            self._unseen.follow(action)
        self._unseen.acted(action, state)

    def renumbered(self, model: FaultModel, numbers: Mapping[int, int]) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        self._sight.renumbered(model)
        self.ahead.renumbered(model)
        self._commitments.renumbered(model)
        self.seeking.renumbered(model)
        self._unseen.renumbered(model)
        self._seen.renumbered(model)
        self._doing.renumbered(model)
        self.rounds.renumbered(numbers)

    def way(self, state: State) -> tuple[int, AnnotatedPlan] | None:
        """The cheapest known way from a state: a place in a plan, and that plan."""
        return self.ahead.best(self._model.number(JointState(state)))

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
        self.ahead.may_be_blind(self.settles)
        self.ahead.stands_at(belief.ranked()[0][0])
        if (self.ahead.version, rates) != self._worked_out_for:
            self._worked_out_for = self.ahead.version, rates
            self._seen.forget()
        ranked = belief.ranked()
        kinds = np.array([self._model.kind(number) for number, _ in ranked], np.intp)
        self._doing.predicted(belief.predicted)
        news = moved(ranked, belief.predicted if self._decided is None else self._decided)
        followed = self._followed_now(ranked, kinds, current, barred, news)
        if followed is not None:
            return followed
        self._commitments.unplanned.clear()
        open_to = self._open(ranked, kinds, current, barred)
        found = self._priced(open_to, ranked, kinds, current, barred, rates)
        told, numbers = tuple(each[0] for each in found), tuple(number for number, _ in ranked)
        costs = np.stack([each[1] for each in found], axis=1)
        works = np.stack([each[2] for each in found], axis=2)
        table = Table(told, numbers, np.array([weight for _, weight in ranked]), costs, works)
        if self.blind and table.best.action is not None:
            self._unseen.follow(table.best.action)
            self._unseen.improve(ranked)
            self._decided = dict(ranked)
            return self._followed_now(ranked, kinds, current, barred) or table
        return table

    def _open(
        self,
        ranked: Sequence[tuple[int, float]],
        kinds: Kinds,
        current: Sequence[Action],
        barred: Action | None,
    ) -> dict[Choice, Floats]:
        """What may be chosen, and where each has something to do and can be done."""
        choices = [
            each
            for each in self._choices(ranked)
            if self._allowed(each, current, barred) and self._worth_a_try(each)
        ]
        weights = np.array([weight for _, weight in ranked])
        work = {each: self._doing.of(each, ranked, kinds) for each in choices}
        able = (each for each in choices if each.action is not None)
        acts = any((work[each] @ weights >= 0).all() for each in able)
        likely = sum(weight for number, weight in ranked if self.ahead.is_goal(number)) >= 0.5
        if not (acts or likely or self.changes_left == 0):  # trying beats ending
            for limits in work.values():
                limits[1] = 1.0
        if self._stuck(ranked) or self.ahead.left == 0:
            return {each: own for each, own in work.items() if each.action is None}
        return work

    def _priced(
        self,
        open_to: Mapping[Choice, Floats],
        ranked: Sequence[tuple[int, float]],
        kinds: Kinds,
        current: Sequence[Action],
        barred: Action | None,
        rates: Rates,
    ) -> list[tuple[Choice, Floats, Floats]]:
        """Every choice with what it costs, once for each way to go on from it, and with where it
        has something to do and can be done."""
        found: list[tuple[Choice, Floats, Floats]] = []
        undone = self.ahead.rates.undone
        blind = self._blind([*open_to], ranked, rates) if self.settles < SETTLED else {}
        for each, own in open_to.items():
            if each.action is None:
                found += [(each, column, own) for column in self._ends(ranked)]
                continue
            more = 0.0 if self._in(each, current) else self._costs.replan
            more += self.rounds.dearer(each.action, ranked, self.ahead.progress, undone)
            seen = self._seen.column(each.action, ranked, kinds, rates) + more
            if self.settles >= SETTLED:
                found.append((each, seen, own))
                continue
            for unseen in blind.pop(each.action):
                found_out = self.settles * seen + (1 - self.settles) * (unseen + more)
                columns = (found_out + self.finding, unseen + more)
                found += [(each, column, own) for column in columns]
        for action, further in blind.items():
            each = Choice(action, self._model.state(ranked[0][0]))
            if self._allowed(each, current, barred) and self._worth_a_try(each):
                more = 0.0 if self._in(each, current) else self._costs.replan
                own = self._doing.of(each, ranked, kinds)
                found += [(each, column + more, own) for column in further]
        return found

    def _followed_now(
        self,
        ranked: Sequence[tuple[int, float]],
        kinds: Kinds,
        current: Sequence[Action],
        barred: Action | None,
        news: float = 0.0,
    ) -> Table | None:
        """What is being followed unseen, as the only choice; None where nothing is, or where it
        need not, or may not, be followed any more."""
        sure = sum(weight for number, weight in ranked if self.ahead.is_goal(number)) > IDLE
        if self.settles >= SETTLED or sure or news > NEWS or self._unseen.more_at_stake:
            self._unseen.drop()
        weights, numbers = np.array([w for _, w in ranked]), tuple(n for n, _ in ranked)
        state = self._model.state(ranked[0][0])
        while following := self._unseen.following:
            choice = Choice(following[0], state)
            allowed = self.ahead.left != 0 and self._allowed(choice, current, barred)
            if not allowed or not self._worth_a_try(choice):
                self._unseen.drop()
            elif self._doing.of(choice, ranked, kinds, floor=BARELY)[1] @ weights >= 0:
                break
            else:
                self._unseen.skip()
        if not self.blind or not self._unseen.following:
            return None
        ones = np.ones((len(ranked), 1))
        return Table((choice,), numbers, weights, ones, ones[None])

    @property
    def following(self) -> tuple[Action, ...]:
        """What is left of what is followed unseen, and is meant to come after it in a long plan."""
        return (*self._unseen.following, *self._unseen.onward)

    def follows(self, action: Action, state: State) -> bool:
        """Whether an action is the next one of what is being followed."""
        return any(self.same_skill(e, action, state) for e in self._unseen.following[:1])

    def same_skill(self, action: Action, other: Action, state: State) -> bool:
        """Whether the robot does the same in two actions."""
        return self._model.same_skill(action, other, state)

    def _blind(
        self, choices: Sequence[Choice], ranked: Sequence[tuple[int, float]], rates: Rates
    ) -> dict[Action, list[Floats]]:
        """The expected costs of actions in the joint states, where nothing is seen after them, for
        every way to go on."""
        actions = [each.action for each in choices if each.action is not None]
        led = [
            [
                (weight, self._seen.successors(action, number, weight, rates))
                for number, weight in ranked[:SEVERAL]
            ]
            for action in actions
        ]
        told = list(zip(actions, led, strict=True))
        return self._unseen.columns(told, ranked) if told else {}

    def _ends(self, ranked: Sequence[tuple[int, float]]) -> tuple[Floats, Floats]:
        """The costs of an end with the goal reported reached, and of one with it reported not."""
        reached = np.array([self.ahead.is_goal(number) for number, _ in ranked])
        lost, wrong = np.where(reached, 0.0, self.ahead.failure), self._costs.misreport
        return lost + wrong * ~reached, lost + wrong * reached

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

    def _stuck(self, ranked: Sequence[tuple[int, float]]) -> bool:
        """Whether all ways that are known lead through something that does not work any more."""
        return sum(weight for number, weight in ranked if self.ahead.blocked(number)) > 0.5

    def _in(self, choice: Choice, plan: Sequence[Action]) -> bool:
        same, action = self._model.same_skill, choice.action
        return action is not None and any(same(action, each, choice.state) for each in plan)
