"""The monitor that believes: probabilities instead of votes, costs instead of thresholds."""

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np

from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.belief import Belief
from tpvqa.belief.calibration import Calibration
from tpvqa.belief.chances import Chances
from tpvqa.belief.choices import Choice, Chooser, Table
from tpvqa.belief.costs import Costs
from tpvqa.belief.evidence import Evidence
from tpvqa.belief.faults import FaultRules, Rates, fault_model
from tpvqa.belief.information import TIMES, Floats, gain, joint_gain
from tpvqa.belief.trust import Trust
from tpvqa.errors import PlannerError
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.requests import Ask, Look, PlanFrom, Request
from tpvqa.monitors.verdict import Decision, Verdict
from tpvqa.pddl import Action, Atom, Literal, State, Task
from tpvqa.planning import Plan
from tpvqa.planning.regression import needed
from tpvqa.questions import Question, Way
from tpvqa.vlm import Answer

TOGETHER = 4
"""Questions that are thought to be asked together, at most."""
DOUBT = 1e-3
"""Facts that are surer than this are not asked about."""


class BeliefMonitor:
    """Keeps a Bayes filter over the facts and does what is expected to cost least.

    Args:
        task: The task.
        rules: What the world file says about faults.
        calibration: What the VLM's answers are worth.
        costs: What things cost.
        views: The views that the world can be looked at from, the default one first.
        rates: What is believed about faults beforehand.
    """

    name = "belief"

    def __init__(
        self,
        task: Task,
        *,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        costs: Costs | None = None,
        views: Sequence[str] = (),
        rates: Rates | None = None,
        learn: bool = True,
    ):
        self.task, self.costs = task, costs or Costs()
        self.belief = Belief(fault_model(task, rules))
        self.chances = Chances(rates)
        self.trust = Trust() if learn else None
        self._learn = learn
        self.evidence = Evidence(
            self.belief, calibration or Calibration.default(), self.trust
        )
        self._chooser = Chooser(self.belief.model, self.costs)
        self._views = tuple(views)
        self._truths: dict[str, dict[int, float]] = {}
        self._look: int | None = None
        self._view: str | None = None
        self._looks = self._questions = self._looks_here = self._questions_here = 0
        self._settled = False
        self._action: Action | None = None
        self._effects: frozenset[Atom] = frozenset()

    @classmethod
    def from_spec(
        cls,
        arguments: str = "",
        *,
        task: Task,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        views: Sequence[str] = (),
    ) -> "BeliefMonitor":
        """Make it from `belief`, or `belief:question=0.05:failure=200` with other costs.

        Raises:
            PluginError: A cost is unknown or no number.
        """
        given: dict[str, Any] = {}
        for part in arguments.split(":") if arguments else []:
            key, _, value = part.partition("=")
            given[key.strip()] = value.strip()
        learn = given.pop("learn", "1") != "0"
        return cls(
            task, rules=rules, calibration=calibration, views=views, costs=Costs(**given),
            learn=learn,
        )

    def before(self, step: Step) -> Check:
        """Act where this is the step to take; otherwise what is."""
        yield from self._know(step)
        if self._settled:  # decided already, by this belief
            self._settled = False
            return Verdict(Decision.GO_ON, self._reason(step, None))
        choice = yield from self._choose(step)
        return self._verdict(step, choice, acted=False)

    def after(self, step: Step) -> Check:
        """Predict what the action led to, look where that is worth it, and decide what is next."""
        yield from self._know(step)
        self._acted(step)
        choice = yield from self._choose(step)
        return self._verdict(step, choice, acted=True)

    def _know(self, step: Step) -> Generator[Request, Any, None]:
        """Annotate the plan that is being followed."""
        if step.index == 0 and all(p.actions != step.plan.actions for p in self._chooser.plans):
            self._annotate(step.plan, step.state)
        return
        yield

    def _annotate(self, plan: Plan, state: State) -> None:
        try:
            needs = needed(self.task, plan.actions, state)
        except PlannerError:
            self._chooser.give_up_on(state)
            return
        self._chooser.add(AnnotatedPlan(self.task, plan.actions, needs))

    def _acted(self, step: Step) -> None:
        if self._learn:
            self.chances.learn(self.belief.outcome_shares())
        self.belief.act(step.action, self.chances.rates)
        self.evidence.acted()
        self._action = step.action
        self._effects = frozenset(effect.literal.atom for effect in step.action.effects)
        self._look = None
        self._looks_here = self._questions_here = 0

    def _choose(self, step: Step) -> Generator[Request, Any, Choice]:
        while True:
            while (state := self._chooser.unplanned(self.belief)) is not None:
                result = yield PlanFrom(state)
                if isinstance(result, Plan):
                    self._annotate(result, state)
                else:
                    self._chooser.give_up_on(state)
            table = self._chooser.table(
                self.belief, self.chances.rates, step.plan.actions
            )
            worth = self._worth_asking(step, table)
            if worth is None:
                return table.best
            question, times = worth
            for _ in range(times):
                yield from self._ask(question)

    def _worth_asking(self, step: Step, table: Table) -> tuple[Question, int] | None:
        """The question whose answers save most, less what they cost; None if none does.

        Returns:
            The question, and how often to ask it before thinking again.
        """
        costs = self.costs
        if (
            self._questions_here >= costs.questions_per_step
            or self._questions >= costs.questions_per_trial
        ):
            return None
        more_looks = (
            self._looks_here < costs.looks_per_step and self._looks < costs.looks_per_trial
        )
        weighted = table.weights[:, None] * table.costs
        total = weighted.sum(axis=0)
        now = float(total.min())
        # Q-MDP takes a mistake to be noticed at once; it is, so many answers later.
        late = self.evidence.answers_to_be_sure()
        asking, looking = costs.question / late, costs.look / late
        best, often, saving = None, 1, 1e-9
        questions = self._questions_in_doubt(step)
        truths = [self._right_of_yes(question, table) for question in questions]
        expected = [self.evidence.expect(question, self._view) for question in questions]
        most = []
        for question, true, reliability in zip(questions, truths, expected, strict=True):
            if_true = true @ weighted
            if_false = total - if_true
            most.append(now - float(if_true.min()) - float(if_false.min()))
            if most[-1] <= asking:
                continue  # even the truth would not be worth a question
            seen = self._look is not None and not self.evidence.asked_at(question.text, self._look)
            for times in TIMES:
                looks = times - 1 if seen else times
                if looks and not more_looks:
                    break
                price = times * asking + looks * looking
                value = gain(if_true, if_false, reliability, times) - price
                if value > saving:
                    best, often, saving = question, times, value
        if len(questions) > 1 and more_looks:
            doubts = [abs(float(true @ table.weights) - 0.5) for true in truths]
            order = sorted(
                range(len(questions)), key=lambda place: (-round(most[place], 6), doubts[place])
            )
            first = order[:TOGETHER]
            for times in TIMES:
                price = times * (len(first) * asking + looking)
                value = -price + joint_gain(
                    weighted,
                    np.array([truths[place] for place in first]),
                    [expected[place] for place in first],
                    times,
                )
                if value > saving:
                    best, often, saving = questions[first[0]], 1, value
        return None if best is None else (best, max(1, often // 4))

    def _right_of_yes(self, question: Question, table: Table) -> Floats:
        """In which joint states yes is right: ones and zeros."""
        known = self._truths.setdefault(question.text, {})
        assert question.atom is not None
        for number in table.numbers:
            if number not in known:
                atoms = (question.atom, *question.alike)
                known[number] = float(not self.belief.model.state(number).isdisjoint(atoms))
        return np.array([known[number] for number in table.numbers])

    def _questions_in_doubt(self, step: Step) -> list[Question]:
        """Questions about facts that the plans need, and that are in doubt."""
        atoms: set[Atom] = set()
        for plan in self._chooser.plans:
            atoms |= plan.atoms()
        questions: dict[str, Question] = {}
        for atom in sorted(atoms):
            if DOUBT < self.belief.probability(atom) < 1 - DOUBT:
                action = self._action if self._way(atom) is Way.EFFECT else None
                if not step.book.asked(Literal(atom), action):
                    continue
                question = step.book.fact(Literal(atom), way=self._way(atom), action=action)
                if question.text not in self.evidence.silent:
                    questions.setdefault(question.text, question)
        return list(questions.values())

    def _way(self, atom: Atom) -> Way:
        return Way.EFFECT if atom in self._effects else Way.PRECONDITION

    def _ask(self, question: Question) -> Generator[Request, Any, None]:
        if self._look is None or self.evidence.asked_at(question.text, self._look):
            self._view = self._views[self._looks_here % len(self._views)] if self._views else None
            observation = yield Look(self._view)
            self._look = observation.look
            self._looks += 1
            self._looks_here += 1
        answers: list[Answer] = yield Ask((question,))
        self._questions += 1
        self._questions_here += 1
        self.evidence.take(answers[0], self._look, self._view)

    def _verdict(self, step: Step, choice: Choice, *, acted: bool) -> Verdict:
        state = choice.state
        reason = self._reason(step, choice)
        if choice.action is None:
            if self.belief.where(self.task.goal_holds) < 0.5:
                return Verdict(Decision.GIVE_UP, reason, state)
            return Verdict(Decision.DONE, reason, state)
        self._settled = True
        same = self.belief.model.same_skill
        if acted and same(choice.action, step.action, state):
            return Verdict(Decision.REPEAT, reason, state)
        places = [
            place
            for place, action in enumerate(step.plan.actions)
            if same(action, choice.action, state)
        ]
        if not places:
            return Verdict(Decision.REPLAN, reason, state)
        place = min(places, key=lambda each: abs(each - step.index))
        if not acted and place == step.index:
            self._settled = False
        return Verdict(Decision.GO_ON, reason, state, step=place)

    def _reason(self, step: Step, choice: Choice | None) -> str:
        return "by the belief"
