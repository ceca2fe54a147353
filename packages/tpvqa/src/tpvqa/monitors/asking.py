"""Looks and questions of a belief monitor: what is asked, from where, and what comes of it."""

from collections.abc import Callable, Collection, Generator, Sequence
from typing import Any

from tpvqa.belief.answers.last_answer import Picture
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.inquiry import DOUBT, Budget, Inquiry
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.first import Prior
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.belief.weighing.vantage import Vantage
from tpvqa.monitors.feeling import Feeling
from tpvqa.monitors.inspection import SENSED, Inspection, Replies
from tpvqa.monitors.requests import Ask, AskPerson, Look, Request
from tpvqa.monitors.silence import Silence
from tpvqa.observation import Observation, SensedFact
from tpvqa.pddl import Action, Atom
from tpvqa.questions import FactQuestion
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.answer import CAMERA

SAME = 3
"""Looks in a row that may show a picture which the question was asked of already."""


class Asking:
    """Looks, asks, and takes what comes of it into the belief.

    Args:
        belief: What is believed.
        evidence: Takes answers in.
        vantage: Knows from where facts are shown.
        costs: What may be asked and looked at.
        feeling: Knows which facts the robot senses.
        views: The views that the world can be looked at from, the default one first.
        blind: Whether answers do not depend on the picture, but on the look.
        felt: Called where more is known to be shown than before.

    Attributes:
        now: What happened since the last action.
        person: Whether a person can be asked.
        silence: How long nothing was found out.
    """

    def __init__(
        self,
        belief: Belief,
        evidence: Evidence,
        vantage: Vantage,
        costs: Costs,
        feeling: Feeling,
        views: Sequence[str],
        *,
        blind: bool,
        felt: Callable[[], None],
    ):
        self._belief, self._evidence, self._costs = belief, evidence, costs
        self._vantage = vantage
        self._feeling, self._felt = feeling, felt
        self._views, self._blind = tuple(views), blind
        self._before = Inspection()
        self.person, self.silence = costs.person is not None, Silence()
        self.now = self._begun(None)

    def begin(self, action: Action | None = None) -> Inspection:
        """Note that an action was executed: what was seen before is past."""
        self._before = Inspection(looks=self.looks, questions=self.questions)
        self.silence.acted()
        self._vantage.moved()
        self.now = self._begun(action)
        return self.now

    @property
    def looks(self) -> int:
        """Looks in this trial."""
        return self._before.looks + self.now.looks

    @property
    def questions(self) -> int:
        """Questions in this trial."""
        return self._before.questions + self.now.questions

    def _begun(self, action: Action | None) -> Inspection:
        return Inspection(action, next(iter(self._views), None))

    def _left(self) -> Budget:
        costs = self._costs
        return Budget(
            costs.questions_per_trial - self.questions, costs.looks_per_trial - self.looks
        )

    @property
    def sees(self) -> bool:
        """Whether an answer may still come in this trial, from the VLM or from a person."""
        costs, left = self._costs, self._left()
        looks = left.looks > 0 or self.now.picture is not None
        vlm = min(left.questions, costs.questions_per_step, costs.looks_per_step) > 0 and looks
        return vlm or self.person

    def budget(self) -> Budget:
        """What may still be asked and looked at before the next action."""
        costs, now, left = self._costs, self.now, self._left()
        return Budget(
            min(costs.questions_per_step - now.questions, left.questions),
            min(costs.looks_per_step - now.looks, left.looks),
        )

    @property
    def may_ask(self) -> bool:
        """Whether the VLM may be asked anything more before the next action."""
        budget = self.budget()
        return budget.questions > 0 and (budget.looks > 0 or self.now.picture is not None)

    def likely(self, question: FactQuestion) -> float:
        """The probability that yes is right."""
        return self._belief.probability(question.atom, question.alike)

    def open_views(self, question: FactQuestion) -> list[str | None]:
        """From where a question may still find an answer, the next one first, and none
        where what it is about is out of sight here."""
        return self._views_of(question) if self._vantage.shows(question.atoms) else []

    def views_at_first(self, question: FactQuestion, prior: Prior) -> list[str | None]:
        """The same where initial states are looked for: by what they say of the place."""
        return self._views_of(question) if self._vantage.shows(question.atoms, prior) else []

    def _views_of(self, question: FactQuestion) -> list[str | None]:
        """From where a question may still find an answer, wherever the robot is.

        They go round: another view repeats the last answer less than the same one does. From none
        where it has said since the last action what it can (`Evidence.exhausted`, `affirmed`).
        """
        if self._exhausted(question.text) or self._evidence.affirmed(question):
            return []
        turn = self.now.looks % len(self._views) if self._views else 0
        views: list[str | None] = [*self._views[turn:], *self._views[:turn]]
        return [view for view in views or [None] if not self._evidence.silent(question.text, view)]

    def _exhausted(self, text: str) -> bool:
        heard, scenes = self.now.heard, max(1, len(self._views))
        yeses, noes = (heard[text, each] // scenes for each in (Reply.YES, Reply.NO))
        return self._evidence.exhausted(yeses, noes)

    def inquire(self, inquiry: Inquiry) -> Generator[Request, Any, None]:
        """Ask what was found to be worth asking."""
        for _ in range(inquiry.times):
            yield from self._ask(inquiry.question, person=inquiry.person)
            if not inquiry.person and not self.open_views(inquiry.question):
                break

    def _ask(self, question: FactQuestion, *, person: bool) -> Generator[Request, Any, None]:
        now, before = self.now, self.likely(question)
        if person:
            answer: Answer = yield AskPerson(question)
            self.person = answer.reply is not Reply.UNKNOWN
            self._evidence.take_from_person(question, answer.reply)
        else:
            looks = 0
            while not self._shows_something_new(question):
                if looks == SAME:  # there is no other picture of it to be had
                    self._evidence.silence(question.text, now.view)
                    looks = 0
                open_views = self.open_views(question)
                if not open_views:
                    return
                yield from self._look(open_views[0])
                looks += 1
            answers: list[Answer] = yield Ask((question,))
            answer = answers[0]
            now.questions += 1
            now.heard[question.text, answer.reply] += 1
            self._evidence.take(question, answer, now.picture, now.view)
            if answer.source != CAMERA:  # else the picture shows nothing, wherever it is from
                self._vantage.take(question.atoms, answer.reply)
        self.silence.asked(answered=answer.reply in (Reply.YES, Reply.NO))
        if answer.reply in (Reply.YES, Reply.NO):
            told = Replies(question.atoms, before)
            now.replies.setdefault(question.family, told).replies.append(answer.reply)

    def feel(self, atoms: Collection[Atom]) -> Generator[Request, Any, None]:
        """Look, once after an action, where that senses something of these that is in doubt: it
        costs next to nothing."""
        if self.now.looks or self.budget().looks <= 0:
            return
        felt = self._feeling.by_a_look(atoms)
        if any(DOUBT < self._belief.probability(atom) < 1 - DOUBT for atom in felt):
            yield from self._look(self.now.view)

    def _look(self, view: str | None) -> Generator[Request, Any, None]:
        now = self.now
        now.view = view
        seen: Observation = yield Look(view)
        self.sense(seen.facts)
        self._feeling.looked(seen.facts)
        now.picture = self.telling(seen)
        now.looks += 1

    def sense(self, facts: Sequence[SensedFact]) -> None:
        """Take in what the robot itself has measured."""
        if self._feeling.take(facts, self.now.effects):
            self._felt()
        if facts:
            self.silence.broken()
        for fact in facts:
            was = self._belief.probability(fact.atom)
            self._evidence.take_sensed(fact.atom, fact.probability)
            self.now.notice(fact.atom, was, self._belief.probability(fact.atom), SENSED)

    def telling(self, seen: Observation) -> Picture:
        """What tells one look from another: the pictures, or else the look's number."""
        pictures = () if self._blind else tuple(frame.data for frame in seen.frames.values())
        return pictures or seen.look

    def _shows_something_new(self, question: FactQuestion) -> bool:
        """Whether the latest picture may tell more than what a question was answered before."""
        text, now = question.text, self.now
        if now.picture is None or self._evidence.asked_of(text, now.picture):
            return False
        if self._evidence.affirmed(question):
            return False
        return not self._evidence.silent(text, now.view)
