"""Which ways to the goal a belief monitor knows, and where it has others planned."""

from collections.abc import Generator, Sequence
from itertools import groupby
from typing import Any

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.deciding.outlook import KNOWN
from tpvqa.belief.deciding.seeking import LIKELY
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.learning.learned import Learned
from tpvqa.belief.learning.skills import CLOSELY, NAMED, SUSPECT
from tpvqa.errors import PlannerError
from tpvqa.monitors.inspection import Inspection
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.requests import PlanFrom, Request
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.regression import regress

SEVERAL = 4.0
"""Tries in vain after which what an action needs is doubted again."""
UNSEEN = "followed unseen"
"""Who has planned what is followed without a look, whatever is true."""


class Ways:
    """Has plans made where none is known, or none without a skill that seems to be dead.

    Args:
        task: The task.
        chooser: Compares the plans.
        chances: Says which skills fail.
        costs: What things cost.
        towards: The facts that are the task's goal, where it is another than the trial's.

    Attributes:
        chooser: Compares the plans.
    """

    def __init__(
        self,
        task: Task,
        chooser: Chooser,
        chances: Learned,
        costs: Costs,
        towards: frozenset[Atom] = frozenset(),
    ):
        self._towards = towards
        self.chooser, self._task, self._chances = chooser, task, chances
        self._costs = costs
        self._ahead = 0
        self._plans: dict[State, Plan] = {}
        self._annotated: dict[State, AnnotatedPlan] = {}
        self._followed: Plan | None = None
        self._dead: tuple[tuple[int, int], frozenset[Action]] = ((0, 0), frozenset())
        self._suspected: dict[Action, float] = {}
        self._sought: set[tuple[State, frozenset[Action]]] = set()

    def follow(self, step: Step) -> None:
        """Note which plan is being followed."""
        if step.plan is self._followed:
            return
        self._followed = step.plan
        if step.plan.planner == UNSEEN:  # it need not lead to the goal from there
            return
        self._plans[step.state] = step.plan
        if self.annotated(step) is None:
            self._annotate(step.plan, step.state)

    def knows(self, plan: Plan) -> bool:
        """Whether a plan is one of those that were made here."""
        return any(plan.actions == known.actions for known in self._plans.values())

    @property
    def atoms(self) -> frozenset[Atom]:
        """The facts that the known plans need."""
        return frozenset[Atom]().union(*(plan.atoms() for plan in self.chooser.plans))

    def ahead(self, belief: Belief) -> int:
        """How many steps the goal is away from the most probable joint state; where no way is known
        from there, as many as when one was."""
        way = self.chooser.ahead.best(belief.ranked()[0][0])
        if way is not None:
            self._ahead = len(way[1].actions) - way[0]
        return self._ahead

    def annotated(self, step: Step) -> AnnotatedPlan | None:
        """The plan that is followed, with what its steps need; None where it was not valid."""
        actions = step.plan.actions
        return next((plan for plan in self.chooser.plans if plan.actions == actions), None)

    def plan(self, state: State, action: Action) -> Plan | None:
        """A plan from a state that begins with an action; None where no way is known from there."""
        if self.chooser.follows(action, state):
            return known_plan([each for each, _ in groupby(self.chooser.following)], UNSEEN)
        found = self._plans.get(state)
        if found is not None and found.actions[:1] == (action,):
            return found
        way = self.chooser.way(state)
        if way is None:
            return None
        rest = way[1].actions[way[0] :]
        if rest and not self.chooser.same_skill(rest[0], action, state):
            return known_plan((action, *rest), UNSEEN)  # by a way on to where it is the step
        return known_plan(rest)

    def seek(self, belief: Belief) -> Generator[Request, Any, None]:
        """Have plans made for what is likely, and without what does not work."""
        while (state := self.chooser.seeking.unplanned(belief)) is not None:
            if state in self._plans:  # other plans have taken its place meanwhile
                self._annotate(self._plans[state], state)
                continue
            result = yield PlanFrom(state, towards=self._towards)
            if isinstance(result, Plan):
                self.take(result, state)
            elif isinstance(result, Unsolvable):
                self.chooser.ahead.give_up_on(state)
        dead = self.dead()
        if self._towards:  # an errand is not worth another way
            return
        for state, weight in belief.states() if dead else ():
            if weight < LIKELY:
                break
            if (state, dead) not in self._sought and self._through(state, dead):
                self._sought.add((state, dead))
                result = yield PlanFrom(state, without=dead)
                if isinstance(result, Plan):
                    self.take(result, state)

    def _through(self, state: State, dead: frozenset[Action]) -> bool:
        """Whether the best known way from a state leads through what is dead."""
        way = self.chooser.way(state)
        return way is not None and not dead.isdisjoint(way[1].actions[way[0] :])

    def suspects(self, action: Action) -> float:
        """How probable it is that an action never works, said where it begins to look like that,
        and again after several tries in vain and each time twice as many; else 0."""
        skill = self._chances.skill(action)
        if skill.dead <= SUSPECT or skill.vain < self._suspected.get(action, 0.0):
            return 0.0
        self._suspected[action] = max(2 * skill.vain, SEVERAL)
        return skill.dead

    def learns_now(self, now: Inspection) -> bool:
        """Whether what the last action came to counts for what is decided now, as it may never
        work; otherwise it does from the next action on."""
        return now.action is not None and not now.learned and self._suspicious(now.action)

    def closely(self, now: Inspection) -> bool:
        """Whether how the last action came out should be known, as it may never work.

        No more is asked than one more try is worth.
        """
        if now.action is None or now.learned:
            return False
        asked = (now.questions + 1) * (self._costs.question + self._costs.look)
        return asked <= self._costs.action and self._suspicious(now.action)

    def _suspicious(self, action: Action) -> bool:
        return self._chances.skill(action).at_worst >= CLOSELY

    def dead(self) -> frozenset[Action]:
        """The actions that seem never to work, whatever they were tried with."""
        learned = self._chances.learned
        if self._dead[0] != learned:
            self._dead = learned, self._found_dead()
        return self._dead[1]

    def _found_dead(self) -> frozenset[Action]:
        skill = self._chances.skill
        names = {each.name for each in self._chances.tried() if skill(each).dead >= NAMED}
        if not names:
            return frozenset()
        actions = self._task.ground_actions()
        return frozenset(
            each for each in actions if each.name in names and skill(each).dead >= NAMED
        )

    def failing(self, step: Step) -> str:
        """The skill of a step where it seems to be dead, in words: of no try is it known for sure
        that it could have worked, or failed."""
        if self._chances.skill(step.action).shown < NAMED:
            return ""
        able, failed = self._chances.times(step.action)
        tries = self._chances.tries(step.action)
        said = f"{step.book.say(step.action)} failed in about {round(failed)} of {tries} tries"
        in_vain = tries - able >= 1  # as far as is known
        return f"{said}, of which about {round(able)} could have worked" if in_vain else said

    def take(self, plan: Plan, state: State) -> None:
        """Know a plan from a state."""
        self._plans[state] = plan
        self._annotate(plan, state)

    def _annotate(self, plan: Plan, state: State) -> None:
        known = self._annotated.get(state)
        if known is None or known.actions != plan.actions:
            try:
                needs = regress(self._task, plan.actions, state)
            except PlannerError:
                self.chooser.ahead.give_up_on(state)
                return
            known = self._annotated[state] = AnnotatedPlan(self._task, plan.actions, needs)
        self.chooser.ahead.add(known)
        for old in list(self._annotated)[: len(self._annotated) - KNOWN]:  # worked out anew if need
            if self._annotated[old] not in self.chooser.plans:
                del self._annotated[old]


def known_plan(actions: Sequence[Action], named: str = "a known plan") -> Plan:
    """What is known already, as a plan."""
    return Plan(tuple(actions), sum(each.cost for each in actions), named, 0.0)
