"""The monitor that believes: probabilities instead of votes, costs instead of thresholds."""

from collections.abc import Generator, Sequence
from copy import deepcopy
from typing import Any

from pydantic import ValidationError

from tpvqa.belief.ablations import PARTS, belief_without
from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.calibration import Calibration
from tpvqa.belief.chances import Chances
from tpvqa.belief.choices import Choice, Chooser, Table
from tpvqa.belief.costs import Costs
from tpvqa.belief.evidence import Evidence, Picture
from tpvqa.belief.experience import Experience
from tpvqa.belief.faults import FaultRules, Rates, fault_model
from tpvqa.belief.inquiry import Budget, Inquirer, Inquiry
from tpvqa.belief.trust import Trust
from tpvqa.errors import PlannerError, PluginError
from tpvqa.monitors.protocol import Check, Limits, Step
from tpvqa.monitors.reasons import Moment, Told, reason
from tpvqa.monitors.requests import Ask, AskPerson, Look, PlanFrom, Request
from tpvqa.monitors.verdict import Decision, Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Literal, State, Task
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.regression import regress
from tpvqa.questions import FactQuestion, FactWay, FactWords, QuestionBook, Way
from tpvqa.vlm import Answer, Reply

SAME = 3
"""Looks in a row that may show a picture which the question was asked of already."""
_RATES = ("failure_rate", "disturbance_rate", "spontaneous_rate")


class BeliefMonitor:
    """Keeps a Bayes filter over the facts and does what is expected to cost least.

    After every action it predicts what that may have led to, asks as long as an answer is worth
    its price, and goes on from the step of a known plan that then costs least: the next one, an
    earlier or a later one, another plan's, or none, where the goal holds.

    Args:
        task: The task.
        rules: What the world file says about faults.
        calibration: What the VLM's answers are worth.
        costs: What things cost.
        views: The views that the world can be looked at from, the default one first.
        rates: What is believed about faults beforehand.
        experience: What was learned in earlier trials; goes before `rates`.
        without: One of `belief.ablations.PARTS`, to be left out.
        limits: When the trial is ended without success; None for never.
        noise_model: Whether answers do not depend on the picture, but on the look.

    Example:
        >>> BeliefMonitor.from_spec("question=0.05", task=task).costs.question  # doctest: +SKIP
        0.05
    """

    def __init__(
        self,
        task: Task,
        *,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        costs: Costs | None = None,
        views: Sequence[str] = (),
        rates: Rates | None = None,
        experience: Experience | None = None,
        without: str | None = None,
        noise_model: bool = False,
        limits: Limits | None = None,
        name: str = "belief",
    ):
        self.task, self.costs, self.name = task, costs or Costs(), name
        self.belief = belief_without(without, fault_model(task, rules))
        self.chances = Chances(rates) if experience is None else experience.chances(rates)
        if calibration is None or without == "calibration":
            calibration = Calibration.default()
        self._learn = without != "learning"
        self._all_facts = without == "relevance"
        self.trust: Trust | None = None
        if self._learn:
            learned = None if experience is None else experience.trusting()
            self.trust = learned or Trust.after(calibration.rows)
        self._trials = 0 if experience is None else experience.trials
        self.evidence = Evidence(self.belief, calibration, self.trust)
        self._chooser = Chooser(self.belief.model, self.costs)
        self._repeats = None if limits is None else limits.repeats
        if limits is not None:
            self._chooser.left, self._chooser.changes_left = limits.actions, limits.replans
        self._inquirer = Inquirer(self.belief.model, self.evidence, self.costs)
        self._views, self._blind = tuple(views), noise_model
        self._view = self._views[0] if self._views else None
        self._picture: Picture | None = None
        self._looks = self._questions = self._looks_here = self._questions_here = 0
        self._told: dict[str, Told] = {}
        self._words: FactWords | None = None
        self._person = self.costs.person is not None
        self._action: Action | None = None
        self._effects: frozenset[Atom] = frozenset()
        self._settled: Action | None = None
        self._stepped: Step | None = None
        self._asked_about: dict[frozenset[Atom], list[FactQuestion]] = {}

    @classmethod
    def from_spec(
        cls,
        arguments: str = "",
        *,
        task: Task,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        views: Sequence[str] = (),
        experience: Experience | None = None,
        noise_model: bool = False,
        limits: Limits | None = None,
    ) -> "BeliefMonitor":
        """Make it from `belief`, or `belief:question=0.05:failure=200` with other costs.

        Also understood: `failure_rate`, `disturbance_rate` and `spontaneous_rate`, believed
        beforehand; `without=PART`.

        Raises:
            PluginError: Something is unknown, or no fitting number.
        """
        given: dict[str, Any] = {}
        for part in arguments.split(":") if arguments else []:
            key, _, value = part.partition("=")
            if key.strip() in given:
                raise PluginError(f"'belief:{arguments}': {key.strip()} is given twice")
            given[key.strip()] = value.strip()
        without = given.pop("without", None)
        if without is not None and without not in PARTS:
            raise PluginError(
                f"'belief:{arguments}': what can be left out is {', '.join(PARTS)}, not {without!r}"
            )
        try:
            believed = {
                key.removesuffix("_rate"): float(given.pop(key)) for key in _RATES if key in given
            }
            if not all(0 <= rate <= 1 for rate in believed.values()):
                raise ValueError("a rate lies between 0 and 1")
            costs = Costs.model_validate(given)
        except ValidationError as error:
            first = error.errors()[0]
            where = ".".join(map(str, first["loc"]))
            what = (
                f"there is no cost {where!r}" if where not in Costs.model_fields else first["msg"]
            )
            raise PluginError(
                f"'belief:{arguments}' is not understood: {where}: {what}. Costs are "
                f"{', '.join(Costs.model_fields)}; write belief:question=0.05:look=0.01, say, "
                f"or without={'|'.join(PARTS)}."
            ) from None
        except ValueError as error:
            raise PluginError(f"'belief:{arguments}' is not understood: {error}") from None
        return cls(
            task,
            rules=rules,
            calibration=calibration,
            views=views,
            costs=costs,
            rates=Rates(**believed),
            experience=experience,
            without=without,
            noise_model=noise_model,
            limits=limits,
            name=f"belief:{arguments}" if arguments else "belief",
        )

    @property
    def experience(self) -> Experience | None:
        """What is known now, for the next trial; None where nothing is learned."""
        if self.trust is None:
            return None
        chances = deepcopy(self.chances)
        chances.learn(self.belief.outcome_shares())  # of the last action
        return Experience.of(chances, self.trust, self._trials + 1)

    def before(self, step: Step) -> Check:
        """Act where this is the step to take; otherwise go to what is."""
        self._know(step)
        settled, self._settled = self._settled, None
        if settled is not None and self.belief.model.same_skill(settled, step.action, step.state):
            return Verdict(Decision.GO_ON, "as decided")  # by this very belief, a moment ago
        choice = yield from self._choose(step)
        return self._verdict(step, choice, acted=False)

    def after(self, step: Step) -> Check:
        """Predict what the action led to, look where that is worth it, and decide what is next."""
        self._know(step)
        if step is not self._stepped:  # a check that is done again predicts nothing again
            self._stepped = step
            self._acted(step)
        worn = self._repeats is not None and step.attempt >= self._repeats
        choice = yield from self._choose(step, barred=step.action if worn else None)
        return self._verdict(step, choice, acted=True)

    def _know(self, step: Step) -> None:
        """Annotate the plan that is being followed."""
        if step.index == 0 and self._annotated(step) is None:
            self._annotate(step.plan, step.state)

    def _annotated(self, step: Step) -> AnnotatedPlan | None:
        actions = step.plan.actions
        return next((plan for plan in self._chooser.plans if plan.actions == actions), None)

    def _annotate(self, plan: Plan, state: State) -> None:
        try:
            needs = regress(self.task, plan.actions, state)
        except PlannerError:
            self._chooser.give_up_on(state)
            return
        self._chooser.add(AnnotatedPlan(self.task, plan.actions, needs))

    def _acted(self, step: Step) -> None:
        if self._learn:
            self.chances.learn(self.belief.outcome_shares())
        self.belief.act(step.action, self.chances.rates)
        self.evidence.acted(troubled=bool(step.trouble))
        self._chooser.acted()
        self._action = step.action
        self._effects = frozenset(effect.literal.atom for effect in step.action.effects)
        self._picture, self._view = None, self._views[0] if self._views else None
        self._looks_here = self._questions_here = 0
        self._told.clear()
        self._asked_about.clear()

    def _choose(self, step: Step, barred: Action | None = None) -> Generator[Request, Any, Choice]:
        while True:
            while (state := self._chooser.unplanned(self.belief)) is not None:
                result = yield PlanFrom(state)
                if isinstance(result, Plan):
                    self._annotate(result, state)
                elif isinstance(result, Unsolvable):
                    self._chooser.give_up_on(state)
                else:
                    self._chooser.postpone(state)
            table = self._chooser.table(self.belief, self.chances.rates, step.plan.actions, barred)
            inquiry = self._inquire(step, table)
            if inquiry is None:
                return table.best
            for _ in range(inquiry.times):
                yield from self._ask(inquiry.question, person=inquiry.person)
                if not inquiry.person and not self._open_views(inquiry.question):
                    break

    def _inquire(self, step: Step, table: Table) -> Inquiry | None:
        budget = self._budget()
        questions = self._about_needs(step.book)
        if self._all_facts and budget.questions > 0:
            fresh = [q for q in questions if q.text not in self._told and self._open_views(q)]
            doubted = [each for each in fresh if 1e-3 < self._likely(each) < 1 - 1e-3]
            if doubted:
                return Inquiry(doubted[0], 1, 0.0)
        return self._inquirer.best(
            questions,
            table,
            budget,
            picture=self._picture,
            views=self._open_views,
            person=self._person,
        )

    def _budget(self) -> Budget:
        costs = self.costs
        return Budget(
            min(
                costs.questions_per_step - self._questions_here,
                costs.questions_per_trial - self._questions,
            ),
            min(costs.looks_per_step - self._looks_here, costs.looks_per_trial - self._looks),
        )

    def _likely(self, question: FactQuestion) -> float:
        return self.belief.probability(question.atom, question.alike)

    def _about_needs(self, book: QuestionBook) -> list[FactQuestion]:
        """Questions about what the plans need: nothing else can change a decision."""
        atoms: frozenset[Atom] = frozenset().union(*(p.atoms() for p in self._chooser.plans))
        if self._all_facts:
            atoms |= {a for n in self.belief.weights for a in self.belief.model.state(n)}
        if atoms not in self._asked_about:
            questions: dict[str, FactQuestion] = {}
            for atom in sorted(atoms):
                effect = atom in self._effects
                action = self._action if effect else None
                if book.asked(Literal(atom), action):
                    way: FactWay = Way.EFFECT if effect else Way.PRECONDITION
                    question = book.fact(Literal(atom), way=way)
                    questions.setdefault(question.text, question)
            self._asked_about[atoms] = list(questions.values())
        return self._asked_about[atoms]

    def _open_views(self, question: FactQuestion) -> list[str | None]:
        """From where a question may still find an answer, the next one first.

        They go round: another view repeats the last answer less than the same one does.
        """
        turn = self._looks_here % len(self._views) if self._views else 0
        views: list[str | None] = [*self._views[turn:], *self._views[:turn]]
        return [view for view in views or [None] if not self.evidence.silent(question.text, view)]

    def _ask(self, question: FactQuestion, *, person: bool) -> Generator[Request, Any, None]:
        before = self._likely(question)
        if person:
            answer: Answer = yield AskPerson(question)
            self._person = answer.reply is not Reply.UNKNOWN
            self.evidence.take_from_person(question, answer.reply)
        else:
            looks = 0
            while not self._shows_something_new(question):
                if looks == SAME:  # there is no other picture of it to be had
                    self.evidence.silence(question.text, self._view)
                    looks = 0
                open_views = self._open_views(question)
                if not open_views:
                    return
                self._view = open_views[0]
                observation: Observation = yield Look(self._view)
                self._picture = observation.look if self._blind else _picture(observation)
                self._looks += 1
                self._looks_here += 1
                looks += 1
            answers: list[Answer] = yield Ask((question,))
            answer = answers[0]
            self._questions += 1
            self._questions_here += 1
            self.evidence.take(question, answer, self._picture, self._view)
        if answer.reply in (Reply.YES, Reply.NO):
            told = Told(question.atoms, before)
            self._told.setdefault(question.text, told).replies.append(answer.reply)

    def _shows_something_new(self, question: FactQuestion) -> bool:
        """Whether the latest picture may tell more than what a question was answered before."""
        return (
            self._picture is not None
            and not self.evidence.asked_of(question.text, self._picture)
            and not self.evidence.silent(question.text, self._view)
        )

    def _verdict(self, step: Step, choice: Choice, *, acted: bool) -> Verdict:
        state, action, place = choice.state, choice.action, None
        same = self.belief.model.same_skill
        if action is None:
            likely = self.belief.where(self.task.goal_holds) >= 0.5
            decision = Decision.DONE if likely else Decision.GIVE_UP
        elif acted and same(action, step.action, state):
            decision = Decision.REPEAT
        else:
            places = [
                number for number, each in enumerate(step.plan.actions) if same(each, action, state)
            ]
            decision = Decision.GO_ON if places else Decision.REPLAN
            if not places and self._chooser.changes_left is not None:
                self._chooser.changes_left -= 1
            place = min(places, key=lambda each: abs(each - step.index), default=None)
        if self._words is None:
            self._words = FactWords(step.book)
        moment = Moment(
            step,
            self._words,
            self.belief,
            self._told,
            self._annotated(step),
            acted,
            unseen=self.evidence.unseen,
            questions_left=self._budget().questions > 0,
            actions_left=self._chooser.left,
        )
        why = reason(moment, decision, action, state, place)
        if decision in (Decision.GO_ON, Decision.REPEAT, Decision.REPLAN) and (
            acted or place != step.index
        ):
            self._settled = action
        return Verdict(decision, why, state, step=place, belief=self._marginals())

    def _marginals(self) -> dict[Atom, float]:
        atoms = {atom for plan in self._chooser.plans for atom in plan.atoms()}
        return {atom: self.belief.probability(atom) for atom in sorted(atoms)}


def _picture(observation: Observation) -> Picture:
    """What tells one look from another: the pictures, or else the look's number."""
    return tuple(frame.data for frame in observation.frames.values()) or observation.look
