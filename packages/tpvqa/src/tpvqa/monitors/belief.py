"""The monitor that believes: probabilities instead of votes, costs instead of thresholds."""

from collections.abc import Generator, Sequence
from copy import deepcopy
from typing import Any

from tpvqa.belief.ablations import belief_without
from tpvqa.belief.annotated import AnnotatedPlan
from tpvqa.belief.calibration import Calibration
from tpvqa.belief.chances import Chances
from tpvqa.belief.choices import Choice, Chooser, Table
from tpvqa.belief.doubts import Doubts
from tpvqa.belief.evidence import Evidence, Picture
from tpvqa.belief.experience import Experience
from tpvqa.belief.faults import FaultModel, FaultRules
from tpvqa.belief.first import Prior
from tpvqa.belief.inquiry import Budget, Inquirer, Inquiry
from tpvqa.belief.priors import Priors
from tpvqa.belief.trust import Trust
from tpvqa.errors import PlannerError
from tpvqa.events.decision import Decision
from tpvqa.monitors.belief_settings import BeliefSettings
from tpvqa.monitors.capabilities import Learning
from tpvqa.monitors.first_look import first_look, first_verdict
from tpvqa.monitors.inspection import Inspection, Replies
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.reasons import Grounds, reason
from tpvqa.monitors.requests import Ask, AskPerson, Look, PlanFrom, Request
from tpvqa.monitors.verdict import Verdict
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Literal, State, Task
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.regression import regress
from tpvqa.plugins import PlainArguments
from tpvqa.questions import FactQuestion, FactWay, FactWords, QuestionBook, Way
from tpvqa.vlm import Answer, Reply

SAME = 3
"""Looks in a row that may show a picture which the question was asked of already."""


class BeliefMonitor(Learning, PlainArguments):
    """Keeps a Bayes filter over the facts and does what is expected to cost least.

    After every action it predicts what that may have led to, asks as long as an answer is worth
    its price, and goes on from the step of a known plan that then costs least: the next one, an
    earlier or a later one, another plan's, or none, where the goal holds.

    Args:
        task: The task.
        settings: What things cost, what is believed of faults, what is left out.
        rules: What the world file says about faults.
        calibration: What the VLM's answers are worth.
        views: The views that the world can be looked at from, the default one first.
        experience: What was learned in earlier trials; goes before the rates of `settings`.
        noise_model: Whether answers do not depend on the picture, but on the look.
        priors: How probable facts are at first, besides what the problem says.
        model: The action model, where trials one after the other share it.
        name: What the log calls it.

    Example:
        >>> BeliefMonitor.from_spec("question=0.05", task=task).costs.question  # doctest: +SKIP
        0.05
    """

    def __init__(
        self,
        task: Task,
        settings: BeliefSettings | None = None,
        *,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        views: Sequence[str] = (),
        experience: Experience | None = None,
        noise_model: bool = False,
        priors: Priors | None = None,
        model: FaultModel | None = None,
        name: str = "belief",
    ):
        settings = settings or BeliefSettings()
        self.task, self.costs, self.name = task, settings.costs, name
        self.belief = belief_without(settings.without, model or FaultModel(task, rules))
        rates = settings.rates
        self.chances = Chances(rates) if experience is None else experience.chances(rates)
        if calibration is None or settings.without == "calibration":
            calibration = Calibration.default()
        self._learns = settings.without != "learning"
        self._asks_all = settings.without == "relevance"
        self.trust: Trust | None = None
        if self._learns:
            learned = None if experience is None else experience.trusting()
            self.trust = learned or Trust.after(calibration.rows)
        self._trials = 0 if experience is None else experience.trials
        self._priors, elsewhere = priors or Priors(), None if priors is None else priors.elsewhere
        doubts = Doubts(task, elsewhere) if elsewhere else None
        self.evidence = Evidence(self.belief, calibration, self.trust, doubts=doubts)
        self._chooser = Chooser(self.belief.model, self.costs)
        self._inquirer = Inquirer(self.belief.model, self.evidence, self.costs)
        self._views, self._blind = tuple(views), noise_model
        self._looks = self._questions = 0
        self._words: FactWords | None = None
        self._person = self.costs.person is not None
        self._plans: dict[State, Plan] = {}
        self._followed: Plan | None = None
        self._settled: Action | None = None
        self._undo = () if rules is None else rules.undo
        self._stepped: Step | None = None
        self._now = self._begin(None)

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
        priors: Priors | None = None,
        model: FaultModel | None = None,
    ) -> "BeliefMonitor":
        """Make it from `belief`, or `belief:question=0.05:failure=200`; see `BeliefSettings`.

        Raises:
            PluginError: Something is unknown, or no fitting number.
        """
        return cls(
            task,
            BeliefSettings.parse(arguments),
            rules=rules,
            calibration=calibration,
            views=views,
            experience=experience,
            noise_model=noise_model,
            priors=priors,
            model=model,
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

    @property
    def unsure(self) -> bool:
        """Whether the problem or the priors leave open how the world is at first."""
        return bool(self.task.left_open) or self._priors.opens

    def first(self, book: QuestionBook) -> Check:
        """Look, where there are too many initial states to weigh; and plan from a likely one."""
        prior = Prior(self.task, self._priors, self._undo)
        now = self._now = self._begin(None)
        self.evidence.weigh(prior)
        yield from first_look(
            prior,
            self.evidence,
            book,
            now,
            views=self._open_views,
            budget=self._budget,
            picture=lambda seen: seen.look if self._blind else _picture(seen),
        )
        self._looks, self._questions = now.looks, now.questions
        self.evidence.weigh(self.belief)
        self.belief.begin(prior.states())
        return (yield from first_verdict(self.belief, prior, FactWords(book), now))

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
        worn = step.repeats_left is not None and step.repeats_left <= 0
        choice = yield from self._choose(step, barred=step.action if worn else None)
        return self._verdict(step, choice, acted=True)

    def _know(self, step: Step) -> None:
        """Annotate the plan that is being followed, and know what the trial still allows."""
        self._chooser.allow(step.actions_left, step.replans_left)
        if step.plan is not self._followed:
            self._followed = step.plan
            self._plans[step.state] = step.plan
            if self._annotated(step) is None:
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
        if self._learns:
            self.chances.learn(self.belief.outcome_shares())
        self.belief.act(step.action, self.chances.rates)
        self.evidence.acted(troubled=bool(step.trouble))
        self._chooser.acted()
        self._now = self._begin(step.action)

    def _begin(self, action: Action | None) -> Inspection:
        return Inspection(action, self._views[0] if self._views else None)

    def _choose(self, step: Step, barred: Action | None = None) -> Generator[Request, Any, Choice]:
        while True:
            while (state := self._chooser.unplanned(self.belief)) is not None:
                result = yield PlanFrom(state)
                if isinstance(result, Plan):
                    self._plans[state] = result
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
        if self._asks_all and budget.questions > 0:
            fresh = [
                q for q in questions if q.text not in self._now.replies and self._open_views(q)
            ]
            doubted = [each for each in fresh if 1e-3 < self._likely(each) < 1 - 1e-3]
            if doubted:
                return Inquiry(doubted[0], 1, 0.0)
        return self._inquirer.best(
            questions,
            table,
            budget,
            picture=self._now.picture,
            views=self._open_views,
            person=self._person,
        )

    def _budget(self) -> Budget:
        costs = self.costs
        return Budget(
            min(
                costs.questions_per_step - self._now.questions,
                costs.questions_per_trial - self._questions,
            ),
            min(costs.looks_per_step - self._now.looks, costs.looks_per_trial - self._looks),
        )

    def _likely(self, question: FactQuestion) -> float:
        return self.belief.probability(question.atom, question.alike)

    def _about_needs(self, book: QuestionBook) -> list[FactQuestion]:
        """Questions about what the plans need: nothing else can change a decision."""
        atoms: frozenset[Atom] = frozenset().union(*(p.atoms() for p in self._chooser.plans))
        if self._asks_all:
            atoms |= {a for n in self.belief.weights for a in self.belief.model.state(n)}
        known = self._now.about
        if atoms not in known:
            questions: dict[str, FactQuestion] = {}
            effects = self._now.effects
            for atom in sorted(atoms):
                effect = atom in effects
                action = self._now.action if effect else None
                if book.asked(Literal(atom), action):
                    way: FactWay = Way.EFFECT if effect else Way.PRECONDITION
                    question = book.fact(Literal(atom), way=way)
                    questions.setdefault(question.text, question)
            known[atoms] = list(questions.values())
        return known[atoms]

    def _open_views(self, question: FactQuestion) -> list[str | None]:
        """From where a question may still find an answer, the next one first.

        They go round: another view repeats the last answer less than the same one does.
        """
        turn = self._now.looks % len(self._views) if self._views else 0
        views: list[str | None] = [*self._views[turn:], *self._views[:turn]]
        return [view for view in views or [None] if not self.evidence.silent(question.text, view)]

    def _ask(self, question: FactQuestion, *, person: bool) -> Generator[Request, Any, None]:
        now, before = self._now, self._likely(question)
        if person:
            answer: Answer = yield AskPerson(question)
            self._person = answer.reply is not Reply.UNKNOWN
            self.evidence.take_from_person(question, answer.reply)
        else:
            looks = 0
            while not self._shows_something_new(question):
                if looks == SAME:  # there is no other picture of it to be had
                    self.evidence.silence(question.text, now.view)
                    looks = 0
                open_views = self._open_views(question)
                if not open_views:
                    return
                now.view = open_views[0]
                observation: Observation = yield Look(now.view)
                now.picture = observation.look if self._blind else _picture(observation)
                self._looks += 1
                now.looks += 1
                looks += 1
            answers: list[Answer] = yield Ask((question,))
            answer = answers[0]
            self._questions += 1
            now.questions += 1
            self.evidence.take(question, answer, now.picture, now.view)
        if answer.reply in (Reply.YES, Reply.NO):
            told = Replies(question.atoms, before)
            now.replies.setdefault(question.text, told).replies.append(answer.reply)

    def _shows_something_new(self, question: FactQuestion) -> bool:
        """Whether the latest picture may tell more than what a question was answered before."""
        now = self._now
        return (
            now.picture is not None
            and not self.evidence.asked_of(question.text, now.picture)
            and not self.evidence.silent(question.text, now.view)
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
            place = min(places, key=lambda each: abs(each - step.index), default=None)
        if self._words is None:
            self._words = FactWords(step.book)
        grounds = Grounds(
            step,
            self._words,
            self.belief,
            self._now.replies,
            self._annotated(step),
            acted,
            unseen=self.evidence.unseen,
            questions_left=self._budget().questions > 0,
            actions_left=step.actions_left,
        )
        why = reason(grounds, decision, action, state, place)
        if decision in (Decision.GO_ON, Decision.REPEAT, Decision.REPLAN) and (
            acted or place != step.index
        ):
            self._settled = action
        plan = self._plans.get(state) if decision is Decision.REPLAN else None
        return Verdict(decision, why, state, step=place, belief=self._marginals(), plan=plan)

    def _marginals(self) -> dict[Atom, float]:
        atoms = {atom for plan in self._chooser.plans for atom in plan.atoms()}
        return {atom: self.belief.probability(atom) for atom in sorted(atoms)}


def _picture(observation: Observation) -> Picture:
    """What tells one look from another: the pictures, or else the look's number."""
    return tuple(frame.data for frame in observation.frames.values()) or observation.look
