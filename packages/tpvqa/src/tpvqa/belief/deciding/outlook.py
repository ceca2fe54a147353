"""What lies ahead of a joint state: the rest of the cheapest known plan, and what it costs."""

from collections.abc import Callable, Sequence
from math import inf

import numpy as np

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan, Standing
from tpvqa.belief.deciding.needed import Needed
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.skills import DOUBTED, FOREGONE, GIVEN_UP, NAMED, SHOWN, SkillState
from tpvqa.belief.states.hopeless import Hopeless
from tpvqa.pddl import Action, State, Task

CHECKS = 2.0
"""Questions that a step of a plan is thought to take, for the cost of what lies ahead."""
UNSEEN = 80.0
"""Actions a step that a task done unseen is worth: as thoroughly done as by blind repetition."""
LEVELS = 4
"""How finely it is told apart how far a task may have to be done unseen."""
PLANS = 16
"""Plans that are kept, the latest ones."""
LONG = 25
"""Steps of a plan from which on a task is long, and more than usual is at stake."""
TWICE = 14, 22
"""Steps of a plan up to which a failed task costs what is said, and from which on twice as much: so
much more was done in vain."""
FURTHER = 14
"""So many steps a state without a known way is farther away than the likeliest one, at most."""
KNOWN = 64
"""Plans of which it is kept where in them states stand."""

SkillOf = Callable[[Action], SkillState]


class Outlook:
    """Costs of the way to the goal from single joint states, as if they were known.

    A step whose effects can be seen is repeated until they are there. One whose effects nothing
    shows is repeated as often as the risk that is left is worth another time, and then left.

    Args:
        model: The action model.
        costs: What things cost.
        sight: What can be seen.
        task: Says what the goal is; by default the model's task.

    Attributes:
        left: Actions that the trial still allows; None for any number. Where they are fewer than
            what a state needs, the task fails there.
        hopeless: States that no plan leads out of.
        version: Grows whenever costs change.
    """

    def __init__(self, model: FaultModel, costs: Costs, sight: Sight, task: Task | None = None):
        self._model, self._costs, self._sight = model, costs, sight
        self._task = task or model.task
        self.plans: list[AnnotatedPlan] = []
        self._most_steps = 0
        self._near: int | None = None
        self.hopeless = Hopeless(self._task)
        self.left: int | None = None
        self._skill: SkillOf = lambda _: SkillState(0.25, 0.0, 1 / 0.75)
        self._rates = Rates()
        self._lost: float | None = None
        self._blind = 0.0
        self._most_repeated: float | None = None
        self._standing: list[tuple[AnnotatedPlan, Standing]] | None = None
        self._places: dict[AnnotatedPlan, Standing] = {}
        self.version = 0
        self._goals: dict[int, bool] = {}
        self._forget()

    def add(self, plan: AnnotatedPlan) -> None:
        """Take in a plan; the latest is preferred among equals."""
        if plan in self.plans:
            self.plans.remove(plan)
        self.plans.insert(0, plan)
        self._most_steps = max(self._most_steps, len(plan.actions))
        del self.plans[PLANS:]
        for old in list(self._places)[: len(self._places) - KNOWN]:  # others may come again soon
            if old not in self.plans:
                del self._places[old]
        self._forget()

    def learned(self, skill: SkillOf, rates: Rates) -> None:
        """Take in new rates of faults.

        Args:
            skill: Those of single actions.
            rates: Those of actions in general.
        """
        self._skill, self._rates = skill, rates
        self._forget()

    def allow(self, actions: int | None) -> None:
        """Note how many actions the trial still allows."""
        if actions != self.left:
            self.left = actions
            self._to_go.clear()
            self.version += 1

    def may_be_blind(self, settles: float) -> None:
        """Note how far the task may have to be done unseen: it is worth its while then, too.

        Args:
            settles: How far answers settle what is in doubt.
        """
        blind = round((1 - settles) * LEVELS) / LEVELS
        if blind != self._blind:
            self._blind = blind
            self._forget()

    def stands_at(self, number: int) -> None:
        """Note which joint state is the likeliest one."""
        found, before = self.best(number), self._unplanned()
        self._near = None if found is None else len(found[1].actions) - found[0]
        self.hopeless.near = None if found is None else self._model.state(number)
        if self._unplanned() != before:
            self._to_go.clear()
            self.version += 1

    def give_up_on(self, state: State) -> None:
        """Note that no plan exists from a state."""
        self.hopeless.add(state)
        self._to_go.clear()
        self.version += 1

    def renumbered(self, model: FaultModel) -> None:
        """Go on with a model that gives joint states other numbers."""
        self._model = model
        for known in (self._places, self._goals):
            known.clear()
        self._forget()

    def best(self, number: int) -> tuple[int, AnnotatedPlan] | None:
        """The cheapest known way from a joint state: a place in a plan, and that plan."""
        kind = self._model.kind(number)
        if kind not in self._best:
            self._best[kind] = self._cheapest(kind, number)
        return self._best[kind]

    def _cheapest(self, kind: int, number: int) -> tuple[int, AnnotatedPlan] | None:
        found, least, holding = None, inf, self._model.holding(number)
        goal = self.is_goal(number)
        for plan, places in self._known():
            place = places.get(kind, -1)
            if place == -1:
                place = places[kind] = len(plan.actions) if goal else places.wanted.latest(holding)
            if place is not None and (rest := self.rest(place, plan)) < least:
                found, least = (place, plan), rest
        return found

    def _known(self) -> Sequence[tuple[AnnotatedPlan, Standing]]:
        if self._standing is None:
            for plan in self.plans:
                if plan not in self._places:
                    self._places[plan] = Standing(plan.wanted(self._model.bits))
            self._standing = [(plan, self._places[plan]) for plan in self.plans]
        return self._standing

    def next(self, number: int) -> Action | None:
        """The first action of that way; None at the goal, or where no way is known."""
        found = self.best(number)
        if found is None or found[0] >= len(found[1].actions):
            return None
        return found[1].actions[found[0]]

    def given_up(self, action: Action) -> bool:
        """Whether an action that seems never to work is not worth one more try."""
        skill = self.skill(action)
        won = (1 - skill.failure) * self._lost_seen
        hopeless = skill.dead >= NAMED and won < self._costs.action
        # Where it is doubtful throughout whether it could have worked, no tries ever show it.
        tried = self._tried_enough(skill, 1 if skill.shown >= SHOWN else 2)
        return tried and (skill.dead >= GIVEN_UP or hopeless)

    def _tried_enough(self, skill: SkillState, times: float = 1) -> bool:
        """Whether so much was spent on tries in vain that it may be given up."""
        return skill.vain * self._costs.action >= times * FOREGONE * self._lost_seen

    def blocked(self, number: int) -> bool:
        """Whether the way from a joint state leads through a skill that is given up."""
        found = self.best(number)
        if found is None:
            return False
        place, plan = found
        known = self._blocks.get(id(plan))
        if known is None:
            dead = [self.given_up(action) for action in plan.actions]
            known = max((n + 1 for n, d in enumerate(dead) if d), default=0)
            self._blocks[id(plan)] = known
        return place < known

    def reached(self, state: State) -> bool:
        """Whether the goal holds in a state."""
        return self._task.goal_holds(state)

    def is_goal(self, number: int) -> bool:
        """Whether the goal holds in a joint state."""
        kind = self._model.kind(number)
        if kind not in self._goals:
            own = self._task is self._model.task
            self._goals[kind] = (
                self._model.goal_holds(number) if own else self.reached(self._model.state(number))
            )
        return self._goals[kind]

    def needed(self, plan: AnnotatedPlan) -> Needed | None:
        """The steps of a plan as masks; None where these do not tell all of it, or of the goal."""
        masks = None if self._task is not self._model.task else self._model.masks(plan.actions)
        return None if masks is None else Needed(masks)

    def rest(self, place: int, plan: AnnotatedPlan) -> float:
        """What a plan costs from a place on."""
        known = self._rests.get(id(plan))
        if known is None:
            known = self._rests[id(plan)] = self._rests_of(plan.actions)
        return known[place]

    def step(self, action: Action) -> float:
        """What a step of a plan costs, its checks and its repeats counted in."""
        known = self._steps.get(action)
        if known is None:
            skill = self.skill(action)
            if self._sight.hidden(action):
                known = sum(self.unseen(action))
            else:
                checks = CHECKS * (self._costs.question + self._costs.look)
                known = min(skill.tries, 20.0) * (self._costs.action + checks)
            self._steps[action] = known
        return known

    def unseen(self, action: Action, needed: float = 1.0) -> tuple[float, float]:
        """What a step costs of which nothing shows whether it did anything.

        Args:
            action: The step.
            needed: How probable it is that it still has something to do.

        Returns:
            What its tries cost, as many as the risk that is left is worth; and that risk, where it
            had something to do.
        """
        failure, cost, lost = self.skill(action).failure, self._costs.action, self.failure
        tries, risk = 1, failure
        while needed * risk * (1 - failure) * lost > cost and tries < 20:
            tries, risk = tries + 1, risk * failure
        return tries * cost, risk * lost

    def dead(self, action: Action) -> float:
        """How probable it is that the way ends at a step, as its skill never works."""
        known = self._dead.get(action)
        if known is None:
            skill = self.skill(action)
            likely = skill.dead >= NAMED or skill.at_worst >= GIVEN_UP
            known = skill.at_worst if likely and not self._sight.hidden(action) else 0.0
            if not self._tried_enough(skill):
                known = min(known, DOUBTED)
            self._dead[action] = known
        return known

    def skill(self, action: Action) -> SkillState:
        """What is known of how often an action fails."""
        known = self._skills.get(action)
        if known is None:
            known = self._skills[action] = self._skill(action)
        return known

    def no_way(self, number: int) -> bool:
        """Whether no plan leads on from a joint state, so that no action does."""
        return self.best(number) is None and self._model.state(number) in self.hopeless

    def to_go(self, number: int) -> float:
        """What is left to pay from a joint state, if it is known."""
        kind = self._model.kind(number)
        known = self._to_go.get(kind)
        if known is None:
            known = self._to_go[kind] = self._worked_out(number)
        return known

    def _worked_out(self, number: int) -> float:
        found = self.best(number)
        if self.no_way(number):
            return self.failure
        if found is None:
            steps = self._unplanned()
            works = 1 - self._rates.failure
            unchecked = steps * self._costs.action + (1 - works**steps) * self.failure
            cost = min(steps * self._usual_step() + self._repeated(), unchecked)
        else:
            place, plan = found
            steps = len(plan.actions) - place
            cost = self.rest(place, plan)
        if self.left is not None and steps >= self.left:  # the action at hand is one of them
            return self.failure
        return cost

    def _rests_of(self, actions: Sequence[Action]) -> list[float]:
        """What a plan costs from each of its places: repeated where checks say so, or unchecked."""
        if not actions:
            return [0.0]
        steps, fails, dead = np.array([self._price(action) for action in reversed(actions)]).T
        unchecked = np.cumsum(np.full(len(actions), self._costs.action))
        unchecked += (1 - np.cumprod(1 - fails)) * self.failure
        rests, dead = np.minimum(np.cumsum(steps), unchecked), np.maximum.accumulate(dead)
        rests = (1 - dead) * rests + dead * self.failure  # steps are dead together, or none
        return [*rests[::-1].tolist(), 0.0]

    def _price(self, action: Action) -> tuple[float, float, float]:
        """What a step of a plan costs, how often it fails, and how probable it is to be dead."""
        known = self._priced.get(id(action))  # of a plan, which keeps it
        if known is None:
            priced = self.step(action), self.skill(action).failure, self.dead(action)
            known = self._priced[id(action)] = priced
        return known

    @property
    def failure(self) -> float:
        """What a failed task costs: always more than it takes to do it, so that long plans are
        worth their while; whether one more try is worth it is asked try by try."""
        if self._lost is None:
            self._lost = self._lost_where(self._blind)
        return self._lost

    def _lost_where(self, unseen: float) -> float:
        steps, works = self._most_steps, 1 - self._rates.failure
        twice = 2 * steps * self._costs.action / self.progress
        unchecked = steps * self._costs.action / max(works, 0.05) ** steps
        blind = UNSEEN * unseen * steps * self._costs.action
        checked = 1.5 * min(steps * self._usual_step(), unchecked)
        said = float(np.interp(steps, TWICE, (1, 2))) * self._costs.failure
        return max(said, blind, twice, checked)

    @property
    def dearer(self) -> float:
        """How many times as much a failed task costs as it would if all could be seen."""
        return self.failure / self._lost_seen

    @property
    def _lost_seen(self) -> float:
        """What a failed task costs where all can be seen, and tries are seen to be in vain."""
        return self._lost_where(0.0)

    @property
    def rates(self) -> Rates:
        """The rates of actions in general."""
        return self._rates

    def _usual_step(self) -> float:
        checks = CHECKS * (self._costs.question + self._costs.look)
        return (self._costs.action + checks) / max(1 - self._rates.failure, 0.05)

    def _repeated(self) -> float:
        """What the repeats of steps that nothing shows cost in a plan, above steps that are seen.

        Where no plan is known they are as many as in the dearest known one: otherwise what nobody
        has a plan for would look better than what everything is planned for.
        """
        if self._most_repeated is None:
            usual, hidden = self._usual_step(), self._sight.hidden
            more = (
                sum(self.step(action) - usual for action in plan.actions if hidden(action))
                for plan in self.plans
            )
            self._most_repeated = max(0.0, *more) if self.plans else 0.0
        return self._most_repeated

    @property
    def progress(self) -> float:
        """Steps of a plan that a try brings nearer to the goal: successes less what is undone."""
        rates = self._rates
        return float(max(1 - rates.failure * (1 + rates.disturbance), 0.02))

    @property
    def stake(self) -> float:
        """How many times as much as in a short task is at stake, by the longest plan alone."""
        return max(1.0, self._most_steps / LONG)

    def _unplanned(self) -> int:
        """How many steps the goal is away where no way is known."""
        most = self._most_steps + 2
        return most if self._near is None else min(most, self._near + FURTHER)

    def _forget(self) -> None:
        """What was worked out holds for other plans or rates."""
        self.version += 1
        self._best: dict[int, tuple[int, AnnotatedPlan] | None] = {}
        self._rests: dict[int, list[float]] = {}
        self._steps: dict[Action, float] = {}
        self._skills: dict[Action, SkillState] = {}
        self._priced: dict[int, tuple[float, float, float]] = {}
        self._dead: dict[Action, float] = {}
        self._blocks: dict[int, int] = {}
        self._to_go: dict[int, float] = {}
        self._lost = self._most_repeated = None
        self._standing = None
