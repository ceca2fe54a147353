"""The monitor that believes: probabilities instead of votes, costs instead of thresholds."""

from collections.abc import Collection, Generator, Sequence
from copy import deepcopy
from typing import Any

from tpvqa.belief.ablations import belief_without
from tpvqa.belief.calibration import Calibration
from tpvqa.belief.chances import Chances
from tpvqa.belief.choices import Chooser
from tpvqa.belief.doubts import Doubts
from tpvqa.belief.evidence import Evidence, Picture
from tpvqa.belief.experience import Experience
from tpvqa.belief.faults import FaultModel, FaultRules
from tpvqa.belief.first import Prior
from tpvqa.belief.inquiry import DOUBT, Budget, Inquirer, Inquiry
from tpvqa.belief.priors import Priors
from tpvqa.belief.sight import Sight
from tpvqa.belief.table import Choice, Table
from tpvqa.belief.trust import Trust
from tpvqa.events.decision import Decision
from tpvqa.monitors.belief_settings import BeliefSettings
from tpvqa.monitors.capabilities import Learning
from tpvqa.monitors.feeling import Feeling
from tpvqa.monitors.first_look import first_look, first_verdict
from tpvqa.monitors.inspection import REPORTED, SENSED, Inspection, Replies
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.reasons import Grounds, reason
from tpvqa.monitors.requests import Ask, AskPerson, Look, Request
from tpvqa.monitors.scrutiny import unknown
from tpvqa.monitors.verdict import Verdict
from tpvqa.monitors.ways import Ways
from tpvqa.observation import Observation, SensedFact
from tpvqa.pddl import Action, Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions import FactQuestion, FactWords, QuestionBook
from tpvqa.vlm import Answer, Reply

MOST_FACTS = 250_000
"""In all joint states that were met; those that are not possible any more are forgotten then."""
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
        senses: The predicates of facts that the robot is said to sense itself.
        experience: What was learned in earlier trials; goes before the rates of `settings`.
        noise_model: Whether answers do not depend on the picture, but on the look.
        priors: How probable facts are at first, besides what the problem says.
        model: The action model, where trials one after the other share it.
        name: What the log calls it.
    """

    def __init__(
        self,
        task: Task,
        settings: BeliefSettings | None = None,
        *,
        rules: FaultRules | None = None,
        calibration: Calibration | None = None,
        views: Sequence[str] = (),
        senses: Collection[str] = (),
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
        self._priors = priors or Priors()
        doubts = Doubts(task, self._priors.elsewhere)
        self.evidence = Evidence(
            self.belief, calibration, self.trust, skill=settings.skill, doubts=doubts
        )
        self._sight = Sight(self.belief.model)
        self._chooser = Chooser(self.belief.model, self.costs, self._sight)
        self._ways = Ways(task, self._chooser, self.chances, self.costs)
        self._learn(None)
        self._inquirer = Inquirer(self.belief.model, self.evidence, self.costs)
        self._views, self._blind = tuple(views), noise_model
        self._feeling = Feeling(self._sight, senses, self.evidence.noticed(task))
        self._looks = self._questions = 0
        self._words: FactWords | None = None
        self._person = self.costs.person is not None
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
        senses: Collection[str] = (),
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
            senses=senses,
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
        if not self._now.learned:
            shares, action = self.belief.outcome_shares(), self._now.action
            chances.learn(shares, action, self.belief.earlier_shares())
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
            picture=self._telling,
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
        barred = step.action if step.repeats_left is not None and step.repeats_left <= 0 else None
        choice = yield from self._choose(step, barred)
        if self._ways.learns_now(self._now):
            self._learn(step.action)
            choice = yield from self._choose(step, barred)
        return self._verdict(step, choice, acted=True)

    def _know(self, step: Step) -> None:
        """Annotate the plan that is being followed, and know what the trial still allows."""
        if self._feeling.asked_by(step.book):
            self._learn(None)
        self._chooser.ahead.allow(step.actions_left)
        self._chooser.changes_left = step.replans_left
        self._ways.follow(step)

    def _acted(self, step: Step) -> None:
        self._learn(self._now.action)
        if self.belief.model.facts > MOST_FACTS:
            numbers = self.belief.renew()
            self._chooser.renumbered(self.belief.model, numbers)
            self._inquirer.renumbered(self.belief.model)
        if self._ways.suspects(step.action):
            self.evidence.doubt(step.action, self._sight)
        self.evidence.rests_on(step.action)
        self._chooser.acted(self.belief, step.action)
        self.belief.act(step.action, self.chances.rates_of(step.action))
        self._now = self._begin(step.action)
        before = {atom: self.belief.probability(atom) for atom in self._now.effects}
        self.evidence.acted(step.action.name, failed=step.reported)
        for atom, was in before.items():
            self._now.notice(atom, was, self.belief.probability(atom), REPORTED)
        self._sense(step.sensed)

    def _sense(self, facts: Sequence[SensedFact]) -> None:
        """Take in what the robot itself has measured."""
        if self._feeling.take(facts, self._now.effects):
            self._learn(None)
        for fact in facts:
            was = self.belief.probability(fact.atom)
            self.evidence.take_sensed(fact.atom, fact.probability)
            self._now.notice(fact.atom, was, self.belief.probability(fact.atom), SENSED)

    def _learn(self, action: Action | None) -> None:
        """Learn from how the last action came out, after all that was seen of it."""
        if action is not None and self._learns and not self._now.learned:
            self._now.learned = True
            self.chances.learn(self.belief.outcome_shares(), action, self.belief.earlier_shares())
        self._chooser.ahead.learned(self.chances.skill, self.chances.rates)

    def _begin(self, action: Action | None) -> Inspection:
        return Inspection(action, next(iter(self._views), None))

    def _choose(self, step: Step, barred: Action | None = None) -> Generator[Request, Any, Choice]:
        while True:
            yield from self._ways.seek(self.belief)
            if self._may_feel():
                yield from self._look(self._now.view)
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
            new = (q for q in questions if q.text not in self._now.replies and self._open_views(q))
            doubted = [each for each in new if DOUBT < self._likely(each) < 1 - DOUBT]
            if doubted:
                return Inquiry(doubted[0], 1, 0.0)
        found = self._inquirer.best(
            questions,
            table,
            budget,
            picture=self._now.picture,
            views=self._open_views,
            person=self._person,
        )
        if found is None and self._ways.closely(self._now):
            found = unknown(self._now, self.belief, step.book, budget, self._open_views)
        return found

    def _budget(self) -> Budget:
        costs, now = self.costs, self._now
        questions = costs.questions_per_trial - self._questions
        looks = costs.looks_per_trial - self._looks
        return Budget(
            min(costs.questions_per_step - now.questions, questions),
            min(costs.looks_per_step - now.looks, looks),
        )

    def _likely(self, question: FactQuestion) -> float:
        return self.belief.probability(question.atom, question.alike)

    def _about_needs(self, book: QuestionBook) -> list[FactQuestion]:
        """Questions about what the plans need: nothing else can change a decision."""
        atoms = self._ways.atoms
        if self._asks_all:
            atoms |= {a for n in self.belief.weights for a in self.belief.model.state(n)}
        return self._now.about(atoms, book)

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
                yield from self._look(open_views[0])
                looks += 1
            answers: list[Answer] = yield Ask((question,))
            answer = answers[0]
            self._questions += 1
            now.questions += 1
            self.evidence.take(question, answer, now.picture, now.view)
        if answer.reply in (Reply.YES, Reply.NO):
            told = Replies(question.atoms, before)
            now.replies.setdefault(question.text, told).replies.append(answer.reply)

    def _look(self, view: str | None) -> Generator[Request, Any, None]:
        now = self._now
        now.view = view
        seen: Observation = yield Look(view)
        self._sense(seen.facts)
        self._feeling.looked(seen.facts)
        now.picture = self._telling(seen)
        self._looks += 1
        now.looks += 1

    def _telling(self, seen: Observation) -> Picture:
        """What tells one look from another: the pictures, or else the look's number."""
        pictures = () if self._blind else tuple(frame.data for frame in seen.frames.values())
        return pictures or seen.look

    def _may_feel(self) -> bool:
        """Whether a look, the first since the last action, senses what a plan needs and is in
        doubt: it costs next to nothing."""
        if self._now.looks or self._budget().looks <= 0:
            return False
        felt = self._feeling.by_a_look(self._ways.atoms)
        return any(DOUBT < self.belief.probability(atom) < 1 - DOUBT for atom in felt)

    def _shows_something_new(self, question: FactQuestion) -> bool:
        """Whether the latest picture may tell more than what a question was answered before."""
        text, now = question.text, self._now
        if now.picture is None or self.evidence.asked_of(text, now.picture):
            return False
        return not self.evidence.silent(text, now.view)

    def _verdict(self, step: Step, choice: Choice, *, acted: bool) -> Verdict:
        state, action, place = choice.state, choice.action, None
        same = self.belief.model.same_skill
        if action is None:
            likely = self.belief.where(self.task.goal_holds) >= 0.5
            decision = Decision.DONE if likely else Decision.GIVE_UP
        elif acted and same(action, step.action, state):
            decision = Decision.REPEAT
        else:
            places = [n for n, each in enumerate(step.plan.actions) if same(each, action, state)]
            decision = Decision.GO_ON if places else Decision.REPLAN
            place = min(places, key=lambda each: abs(each - step.index), default=None)
        self._words = self._words or FactWords(step.book)
        grounds = Grounds(
            step,
            self._words,
            self.belief,
            self._now.replies,
            self._now.noticed,
            self._ways.annotated(step),
            acted,
            unseen=self.evidence.unseen,
            questions_left=self._budget().questions > 0,
            actions_left=step.actions_left,
            failing=self._ways.failing(step),
        )
        why = reason(grounds, decision, action, state, place)
        if decision in (Decision.GO_ON, Decision.REPEAT, Decision.REPLAN) and (
            acted or place != step.index
        ):
            self._settled = action
        plan = self._ways.plan(state, action) if action and decision is Decision.REPLAN else None
        marginals = self.belief.probabilities(sorted(self._ways.atoms))
        return Verdict(decision, why, state, step=place, belief=marginals, plan=plan)
