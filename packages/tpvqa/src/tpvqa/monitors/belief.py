"""The monitor that believes: probabilities instead of votes, costs instead of thresholds."""

from collections.abc import Collection, Generator, Sequence
from dataclasses import replace
from typing import Any

from tpvqa.belief.answers.biases import Biases
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.risk import RiskBound, confidence
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.deciding.inquiry import DOUBT, Inquirer, Inquiry
from tpvqa.belief.deciding.table import Choice, Table
from tpvqa.belief.filtering.ablations import belief_without
from tpvqa.belief.filtering.doubts import Doubts
from tpvqa.belief.filtering.faults import FaultModel, FaultRules
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.filtering.priors import Priors
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.experience import Experience
from tpvqa.belief.learning.learned import Learned
from tpvqa.belief.weighing.controls import Controls
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.belief.weighing.settling import Settling, Settlings
from tpvqa.belief.weighing.vantage import Vantage
from tpvqa.events.decision import Decision
from tpvqa.monitors.asking import Asking
from tpvqa.monitors.belief_settings import BeliefSettings
from tpvqa.monitors.capabilities import Learning
from tpvqa.monitors.errands import Errand, Errands
from tpvqa.monitors.feeling import Feeling
from tpvqa.monitors.first_look import first_look, first_verdict
from tpvqa.monitors.grounds import Grounds
from tpvqa.monitors.inspection import REPORTED, Inspection
from tpvqa.monitors.lost import lost
from tpvqa.monitors.protocol import Check, Step
from tpvqa.monitors.reasons import reason
from tpvqa.monitors.requests import Request
from tpvqa.monitors.saying_done import says_done
from tpvqa.monitors.scrutiny import TELLING, unknown
from tpvqa.monitors.stated_risk import IN_DOUBT, as_stated, bound_for
from tpvqa.monitors.telltales import Telltales
from tpvqa.monitors.verdict import Verdict
from tpvqa.monitors.ways import Ways
from tpvqa.pddl import Action, Task
from tpvqa.plugins import PlainArguments
from tpvqa.questions import FactQuestion, FactWords, QuestionBook

MOST_FACTS = 250_000
"""In all joint states that were met; those that are not possible any more are forgotten then."""


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
        risk: Where "done" may be reported, if `settings` state a risk.
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
        risk: RiskBound | None = None,
        name: str = "belief",
    ):
        settings = settings or BeliefSettings()
        self.task, self.costs, self.name = task, settings.costs, name
        self.belief = belief_without(settings.without, model or FaultModel(task, rules))
        if calibration is None or settings.without == "calibration":
            calibration = Calibration.default()
        known = settings.chances(calibration.faults, experience)
        self._risk = bound_for(settings.risk, risk)
        self._learns = settings.without != "learning"
        self._asks_all = settings.without == "relevance"
        learned = None if experience is None else experience.trusting()
        self.trust = (learned or Trust.after(calibration.rows)) if self._learns else None
        told = Biases(None if experience is None else experience.biases)
        self._trials = 0 if experience is None else experience.trials
        self._priors = priors or Priors()
        doubts, words = Doubts(task, self._priors.elsewhere), settings.other_words
        given = self.belief, calibration, self.trust, told
        self.evidence = Evidence(*given, skill=settings.skill, doubts=doubts, words=words)
        self.chances = Learned(known, self.belief, trusts=self.trust is not None)
        self._sight = Sight(self.belief.model)
        self._telltales = Telltales(self._sight)
        chooser = Chooser(self.belief.model, self.costs, self._sight)
        self._task_ways = Ways(task, chooser, self.chances, self.costs)
        vantage = Vantage(self.belief, () if rules is None else rules.shown)
        self._errands = Errands(task, vantage, self.costs)
        self._errand: Errand | None = None
        self._past: Errand | None = None
        self._learn(None)
        self._inquirer = Inquirer(self.belief.model, self.evidence, self.costs)
        self._controls = Controls(self.evidence, self.costs)
        self._feeling = Feeling(self._sight, senses, self.evidence.noticed(task))
        asked = self.belief, self.evidence, vantage, self.costs, self._feeling, views
        self._asking = Asking(*asked, blind=noise_model, felt=lambda: self._learn(None))
        self._words: FactWords | None = None
        self._settled: Action | None = None
        self._settlings, self._telling = Settlings(), 1.0
        self._undo = () if rules is None else rules.undo
        self._stepped: Step | None = None

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
        risk: RiskBound | None = None,
    ) -> "BeliefMonitor":
        """Make it from `belief`, or `belief:question=0.05:failure=200`; see `BeliefSettings`.

        Raises:
            PluginError: Something is unknown, or no fitting number; a risk is stated of which
                nothing is known.
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
            risk=risk,
            name=f"belief:{arguments}" if arguments else "belief",
        )

    @property
    def experience(self) -> Experience | None:
        """What is known now, for the next trial; None where nothing is learned."""
        if self.trust is None:
            return None
        last = None if self._now.learned or self._chooser.blind else self._now.action
        chances, trials = self.chances.carried(last), self._trials + 1
        return Experience.of(chances, self.trust, trials, self.evidence.carried())

    @property
    def goal_probability(self) -> float:
        """How probable it is now that the goal holds."""
        return confidence(self.belief.where(self.task.goal_holds))

    @property
    def unsure(self) -> bool:
        """Whether the problem or the priors leave open how the world is at first."""
        return bool(self.task.left_open) or self._priors.opens

    @property
    def _ways(self) -> Ways:
        """The ways to what is aimed at: to the goal, or to where something of it is seen."""
        return self._task_ways if self._errand is None else self._errand.ways

    @property
    def _chooser(self) -> Chooser:
        return self._ways.chooser

    @property
    def _choosers(self) -> list[Chooser]:
        return [self._task_ways.chooser, *([self._errand.ways.chooser] if self._errand else [])]

    @property
    def _now(self) -> Inspection:
        return self._asking.now

    def first(self, book: QuestionBook) -> Check:
        """Look, where there are too many initial states to weigh; and plan from a likely one."""
        prior, now = Prior(self.task, self._priors, self._undo), self._asking.begin()
        self.evidence.weigh(prior)
        yield from first_look(
            prior,
            self.evidence,
            book,
            now,
            views=lambda question: self._asking.views_at_first(question, prior),
            budget=self._asking.budget,
            picture=self._asking.telling,
        )
        self.evidence.weigh(self.belief)
        self.belief.begin(prior.states())
        verdict = yield from first_verdict(self.belief, prior, FactWords(book), now)
        done = verdict.plan is not None and not verdict.plan.actions
        if self._risk is None or not done or self._risk.allows(self.goal_probability):
            return verdict
        why = f"{IN_DOUBT}: {as_stated(self.goal_probability, self._risk)}; {verdict.reason}"
        return replace(verdict, decision=Decision.GIVE_UP, reason=why)

    def before(self, step: Step) -> Check:
        """Act where this is the step to take; otherwise go to what is."""
        self._know(step)
        settled, self._settled = self._settled, None
        if settled is not None and self.belief.model.same_skill(settled, step.action, step.state):
            return Verdict(Decision.GO_ON, "as decided")  # by this very belief, a moment ago
        return self._verdict(step, (yield from self._choose(step)), acted=False)

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
        for chooser in self._choosers:
            chooser.ahead.allow(step.actions_left)
            chooser.changes_left = step.replans_left
        if self._errand is None and not (self._past and self._past.ways.knows(step.plan)):
            self._ways.follow(step)

    def _acted(self, step: Step) -> None:
        self._learn(self._now.action)
        self.evidence.leave()
        if self.belief.model.facts > MOST_FACTS:
            numbers = self.belief.renew()
            self.evidence.renumbered(numbers)
            for chooser in self._choosers:
                chooser.renumbered(self.belief.model, numbers)
            self._inquirer.renumbered(self.belief.model)
        self.evidence.rests_on(step.action, self._sight, dead=self._ways.suspects(step.action))
        self._telltales.acted(step.action)
        for chooser in self._choosers:
            chooser.acted(self.belief, step.action)
        self.belief.act(step.action, self.chances.rates_of(step.action))
        self._settlings.acted(self._now.replies.keys() | self.evidence.unanswered)
        self._asking.begin(step.action)
        told = step.reported or not self._chooser.blind  # else its report says next to nothing
        before = {atom: self.belief.probability(atom) for atom in self._now.effects if told}
        self.evidence.acted(step.action.name, failed=step.reported)
        for atom, was in before.items():
            self._now.notice(atom, was, self.belief.probability(atom), REPORTED)
        self._asking.sense(step.sensed)

    def _learn(self, action: Action | None) -> None:
        """Learn from how the last action came out, after all that was seen of it."""
        if action is not None and self._learns and not self._now.learned:
            self._now.learned = True
            if not self._chooser.blind or self._now.noticed:  # else nothing was seen of it
                self.chances.learn(action)
                self.evidence.reports.learn(self.belief.outcome_shares())
        for chooser in self._choosers:
            chooser.ahead.learned(self.chances.skill, self.chances.rates)

    def _choose(self, step: Step, barred: Action | None = None) -> Generator[Request, Any, Choice]:
        while True:
            yield from self._ways.seek(self.belief)
            yield from self._asking.feel(self._ways.atoms)
            self._settle(step)
            table = self._chooser.table(self.belief, self.chances.rates, step.plan.actions, barred)
            if self._chooser.seeking.foresees():
                continue
            inquiry = self._inquire(step, table)
            if inquiry is not None:
                yield from self._asking.inquire(inquiry)
                continue
            best = table.best
            if best.action is None and self._errand is not None:
                self._errand, self._past = None, self._errand  # there; now it is looked
            elif best.action or not self._asking.sees or not (yield from self._sets_out(step)):
                return best

    def _settle(self, step: Step) -> None:
        """Work out how far it can be found out what is true, and what that costs."""
        questions, unseen = self._about_needs(step.book), Settling(0.0, new=0.0)
        sees = self._asking.sees or not questions  # else sensors alone tell, and go on
        found = self.evidence.settling(questions) if sees else unseen
        self._telling = found.share
        self._chooser.settles = self._settlings.taken(found, self._task_ways.ahead(self.belief))
        self._chooser.blind = self.evidence.worthless(found)
        self._chooser.finding = found.answers * self.costs.question + self.costs.look

    def _sets_out(self, step: Step) -> Generator[Request, Any, bool]:
        """Whether a goal that is out of sight is worth going to, before the trial ends."""
        self._errand = yield from self._errands.seek(
            step, self.belief, self.evidence, self._chooser, self._sight, self.chances
        )
        return self._errand is not None

    def _inquire(self, step: Step, table: Table) -> Inquiry | None:
        budget, views = self._asking.budget(), self._asking.open_views
        questions, likely = self._about_needs(step.book), self._asking.likely
        if self._asks_all and budget.questions > 0:
            new = (q for q in questions if q.family not in self._now.replies and views(q))
            if doubted := [each for each in new if DOUBT < likely(each) < 1 - DOUBT]:
                return Inquiry(doubted[0], 1, 0.0)
        able = questions if min(budget.questions, budget.looks) > 0 else []
        if known := self._controls.next(able, likely, views):
            self._now.controls.append(known)
            return Inquiry(known, 1, 0.0)
        found = self._inquirer.best(
            questions,
            table,
            budget,
            picture=self._now.picture,
            views=views,
            person=self._asking.person,
            dearer=self.evidence.dearer(self._chooser.ahead.dearer) * self._settlings.dearer,
            stake=self._chooser.ahead.stake,
        )
        if found is None and self._telling >= TELLING and self._ways.closely(self._now):
            found = unknown(self._now, self.belief, step.book, budget, views)
        if found is None and self._past is not None:
            found = self._past.look(self._now, self.belief, step.book, budget, views)
        return found

    def _about_needs(self, book: QuestionBook) -> list[FactQuestion]:
        """Questions about what the plans need, or tells of it, or of where there is none."""
        atoms = self._ways.atoms | self._telltales.of(self.belief, self._ways.atoms)
        atoms |= lost(self.belief, self._chooser.ahead)
        if self._asks_all:
            atoms |= {a for n in self.belief.weights for a in self.belief.model.state(n)}
        return self._now.about(atoms, book)

    def _verdict(self, step: Step, choice: Choice, *, acted: bool) -> Verdict:
        state, action, place = choice.state, choice.action, None
        if silent := self._asking.silence.told:
            return Verdict(Decision.GIVE_UP, silent, state)
        same = self.belief.model.same_skill
        if action is None:
            done = says_done(self.goal_probability, self._risk)
            decision = Decision.DONE if done else Decision.GIVE_UP
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
            self._now,
            self._ways.annotated(step),
            acted,
            unseen=self.evidence.unanswered,
            questions_left=self._asking.may_ask,
            actions_left=step.actions_left,
            failing=self._ways.failing(step),
            settles=self._chooser.settles,
            followed=self._chooser.blind,
            risk=self._risk,
        )
        errand = "" if self._errand is None else f"{self._errand.why}; "
        why = errand + reason(grounds, decision, action, state, place)
        if action is not None and (acted or place != step.index):
            self._settled = action
        plan = self._ways.plan(state, action) if action and decision is Decision.REPLAN else None
        marginals = self.belief.probabilities(sorted(self._ways.atoms | (state ^ step.state)))
        return Verdict(decision, why, state, step=place, belief=marginals, plan=plan)
