"""Answers as evidence: each weighs the belief by what it adds to those before."""

from collections.abc import Mapping, Set
from dataclasses import replace

import numpy as np

from tpvqa.belief.answers.biases import Biases
from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.last_answer import LastAnswer, Picture
from tpvqa.belief.answers.noise import NEVER
from tpvqa.belief.answers.other_words import Answered, OtherWords
from tpvqa.belief.answers.told_apart import ToldApart
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.answers.weighed import Weighed
from tpvqa.belief.answers.worth import SURE, Cases, Said, Taken
from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.own_words import SkillWorth, of_action
from tpvqa.belief.calibrating.repeats import learn_repeats
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.doubts import Doubts
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.reports import Reports
from tpvqa.belief.learning.skills import DEAD, DEAD_WITH, SUSPECTED
from tpvqa.belief.weighing.expected import Expected, Pair, answered_apart, unchanged
from tpvqa.belief.weighing.readings import Readings
from tpvqa.pddl import Action, Atom, Task, literals
from tpvqa.questions.question import FactQuestion
from tpvqa.vlm import Answer, Reply

UNEXPLAINED = 0.002
"""Chance that a fact that an answer speaks against has changed without the action model."""
SURPRISING = 0.25
"""An answer less probable than this makes that chance be taken in."""
ANSWERED = 0.2
"""The share of a doubt that is left where the last answer has denied it."""
MANY = 48
"""Joint states from which on it saves time to leave out of them what is next to impossible."""
ANYWAY = 0.25
"""How often a picture shows what holds no more, where a file says that it may."""
PERSON = 0.99
"""How often a person's answer is right."""
PERSONS_VIEW = "a person's"
"""Stands for the view from which a person could not tell; no world's view is called so."""
NOTICED = 0.8
"""A skill that reports so many of its failures shows what it does."""


class Evidence(Expected):
    """Takes answers into a belief.

    With probability ρ a further look at an unchanged fact only repeats the last answer. Whether
    it is unchanged is known in each joint state. ρ has a Beta prior around
    the calibration's and is learned from every further answer, where trust is.

    Args:
        belief: What is believed.
        calibration: What answers are worth.
        trust: Whether they are worth that; None to take the calibration at its word.
        biases: What was learned of single predicates; by default nothing.
        unexplained: Chance that a fact changed without the action model knowing.
        skill: What the report of any skill is worth; by default what the calibration says, or else
            what is learned.
        doubts: Chances that things were elsewhere from the start; none by default.
        words: How far the wordings of a question err alike.

    Attributes:
        reports: What skills' reports are worth.
    """

    def __init__(
        self,
        belief: Belief,
        calibration: Calibration,
        trust: Trust | None,
        biases: Biases | None = None,
        *,
        unexplained: float = UNEXPLAINED,
        skill: SkillWorth | None = None,
        doubts: Doubts | None = None,
        words: OtherWords | None = None,
    ):
        super().__init__(belief, calibration, trust, words, biases)
        self._unexplained, self._doubts = unexplained, doubts
        self.reports = Reports(calibration.skills if skill is None else (skill,))
        self._sensors = calibration.sensors
        self._readings = Readings(belief, calibration.sensors)
        self._opened: set[tuple[Atom, ...]] = set()
        self._silent: set[tuple[str, str | None]] = set()
        self._affirmed: set[str] = set()

    def weigh(self, belief: Weighed) -> None:
        """Weigh something else from now on; what was answered before stays known."""
        if self._doubts:
            self._doubts.leave()
        self._weighed = belief
        self._belief.suppose(self.worth.weights)

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        self._hearing.renumbered(numbers)

    def _tell_apart(self) -> None:
        """Leave out of the joint states what has become next to impossible of the noise, and take
        in again what has not stayed so."""
        if self._trust is None or self._weighed is not self._belief:
            return
        if self._belief.apart is None and len(self._belief.weights) < MANY:
            return
        apart = ToldApart.of(self._belief.noise, self._belief.told)
        if apart.differs(self._belief.told):
            self._belief.tell_apart(apart)
            self._hearing.tell_apart(apart.columns, apart.taken)

    def acted(self, action: str = "", *, failed: bool | None = None) -> None:
        """Note that an action was executed: facts may have changed, other things are in view.

        Args:
            action: Its name.
            failed: Whether the robot's own skill reports a failure; None where it reports nothing.
        """
        self._take_report(action, failed)
        self._readings.acted()
        self._hearing.moved(self._belief.led)
        if self._doubts:
            self._doubts.leave()
        self._tell_apart()
        self._opened.clear()
        self._silent.clear()
        self._affirmed.clear()

    def _take_report(self, action: str, failed: bool | None) -> None:
        likely = self.reports.take(action, failed=failed)
        if likely is None:
            return
        worked, not_worked = likely
        # A skill that finds nothing to do may call that a failure, or not.
        idle = (worked + not_worked) / 2 if failed else worked
        self._belief.weigh_outcome(succeeded=worked, failed=not_worked, achieved=idle)

    def noticed(self, task: Task) -> frozenset[str]:
        """The predicates of facts that the robot is known to notice itself: those whose sensors
        were calibrated, and those that skills change which report their failures."""
        sensed = {each.predicate for each in self._sensors}
        for schema in task.schemas:
            known = of_action(self.reports.known, schema.name)
            if known is not None and known.notices >= NOTICED:
                sensed |= {effect.literal.predicate for effect in schema.effects}
        return frozenset(sensed)

    def take_sensed(self, atom: Atom, probability: float) -> None:
        """Weigh the belief by what the robot itself has measured.

        Args:
            atom: The fact.
            probability: How probable the reading makes it.
        """
        stated = atom.predicate not in self._belief.model.task.derived
        if stated and self._readings.expected(atom, probability) < SURPRISING:
            self._open((atom,), held=probability < 0.5)
        self._readings.take(atom, probability)

    def _open(self, atoms: tuple[Atom, ...], *, held: bool) -> None:
        """Take in, once between two actions, that a fact may have changed unexplained, or that it
        never was as the problem says."""
        if atoms in self._opened or not self._unexplained:
            return
        elsewhere = self._doubts.of(atoms, held=held) if self._doubts else 0.0
        if self._weighed.open(atoms, max(self._unexplained, elsewhere), self._instead):
            self._opened.add(atoms)
            if self._doubts:
                self._doubts.give(atoms)

    def rests_on(self, action: Action, sight: Sight | None = None, *, dead: float = 0.0) -> None:
        """Take in that what an action needs may not be so, before it is done.

        That explains tries in vain as well as that the action never works does. So each thing that
        it needs has its share of that, less where it was said last that it holds.

        Args:
            action: It.
            sight: What can be seen; None for all.
            dead: How probable it is that it never works, where tries in vain are to be explained.
        """
        fluents, needed = self._belief.model.task.fluents, list(literals(action.precondition))
        doubted = [
            each
            for each in needed
            if dead and each.atom.predicate in fluents and (sight is None or sight.sees(each.atom))
        ]
        chance = dead * SUSPECTED / (len(doubted) * SUSPECTED + DEAD + DEAD_WITH)
        for each in doubted:  # whatever was said, so many tries in vain are to be explained
            said = self._hearing.said(each.atom, holds=each.positive)
            self._belief.open((each.atom,), chance * (ANSWERED if said else 1.0))
        if self._doubts is None:
            return
        for each in needed:
            if each.positive and self._belief.probability(each.atom) >= 0.5:
                chance = self._doubts.gone(each.atom)
                if chance and self._belief.open((each.atom,), chance, self._instead):
                    self._doubts.give((each.atom,))

    def _instead(self, one: int, other: int) -> Floats | None:
        return self._hearing.instead(one, other, self._belief.model)

    def asked_of(self, text: str, picture: Picture) -> bool:
        """Whether a question was answered on a picture since the last action: once more is worth
        nothing."""
        return self._hearing.asked_of(text, picture)

    def silence(self, text: str, view: str | None) -> None:
        """Note that a question finds no answer from a view before the next action."""
        self._silent.add((text, view))

    def silent(self, text: str, view: str | None) -> bool:
        """Whether that was noted."""
        return (text, view) in self._silent

    @property
    def unanswered(self) -> Set[str]:
        """The questions that were found to have no answer since the last action."""
        return {text for text, _ in self._silent}

    def affirmed(self, question: FactQuestion) -> bool:
        """Whether a yes has said all that there is to it in this scene, in whatever words."""
        return question.family in self._affirmed

    def take(
        self, question: FactQuestion, answer: Answer, picture: Picture, view: str | None
    ) -> float:
        """Weigh the belief by the answer to a question.

        Returns:
            How probable the answer was before it came; 1 for an abstention, which says nothing.
        """
        if answer.reply not in (Reply.YES, Reply.NO):
            self.silence(question.text, view)
            return 1.0
        if question.still_shown and answer.reply is Reply.YES:
            return self._take_affirmed(question)
        atoms = question.atoms
        last = self._hearing.last.get(question.text)
        if last is not None and picture in last.pictures:
            return 1.0
        group = self._calibration.group(question)
        true = self._weighed.probability(question.atom, question.alike)
        yes, rates = answer.reply is Reply.YES, self._rates(question)
        ratio = group.log_ratio(answer.reply, answer.p_yes)
        said = Said(yes, self._biased(question, ratio, yes=yes))
        heard = self._heard_of(question, view) or Heard()
        cases = self._cases(question, heard)
        if last is not None:
            repeats, same = self._repeats[answered_apart(last, view)], last.reply is answer.reply
            if self._trust is not None:
                # How often this word is said, not how much this P(yes) is worth.
                expected = self.worth.expect(rates, cases)
                words = (expected.yes_if_true, expected.yes_if_false)
                told = words if yes else _others(words)
                learn_repeats(repeats, true, told, unchanged(cases), float(same))
            said = replace(said, repeats=repeats.mean, same=same)
        taken = self.worth.take(said, cases, rates)
        (if_true, if_false) = taken.whole
        probable = true * if_true + (1 - true) * if_false
        if last is None:
            last = LastAnswer(answer.reply, set(), view, atoms, self._hearing.acted)
            self._hearing.last[question.text] = last
        last.reply, last.view, last.heard[view] = answer.reply, view, heard
        last.pictures.add(picture)
        if probable < SURPRISING:
            self._open(atoms, held=true >= 0.5)
        if self._weighed is not self._belief or self._belief.masses()[1] is not cases.mass:
            cases = self._cases(question, heard)
            taken = self.worth.take(said, cases, rates)
        self._weigh_answer(question, heard, cases, taken, said, rates, view)
        self._words.ask(question)
        return probable

    def _biased(self, question: FactQuestion, ratio: float, *, yes: bool) -> float:
        """What an answer is worth, by what those about its predicate were."""
        if not self._finds_biases or question.still_shown:
            return ratio
        said = self._rates_said(question)
        self.biases.hear(question, said, yes=yes)
        return self.biases.worth(question, said, ratio, yes=yes)

    def leave(self) -> None:
        """Note that an action comes next: what was right here is known as well as it will be."""
        self.biases.leave(self._likely_yes)

    def carried(self) -> Biases:
        """What the next trial may begin with of single predicates."""
        return self.biases.after(self._likely_yes)

    def _likely_yes(self, question: FactQuestion) -> float:
        return self._belief.probability(question.atom, question.alike)

    def _take_affirmed(self, question: FactQuestion) -> float:
        """Weigh the belief by a yes that may be right where the fact does not hold any more.

        That belongs to the scene, so that a second yes says nothing more; and it says nothing of
        the VLM.
        """
        if self.affirmed(question):
            return 1.0
        self._affirmed.add(question.family)
        true = self._weighed.probability(question.atom, question.alike)
        expected = self.worth.expect(self._rates(question))
        if_true, wrongly = expected.yes_if_true, expected.yes_if_false
        if_false = ANYWAY * if_true + (1 - ANYWAY) * wrongly
        self._weighed.see(question.atoms, if_true, if_false)
        return true * if_true + (1 - true) * if_false

    def _weigh_answer(
        self,
        question: FactQuestion,
        heard: Heard,
        cases: Cases,
        taken: Taken,
        said: Said,
        rates: Pair,
        view: str | None,
    ) -> None:
        self.worth.compare(said, rates)
        if self._weighed is self._belief:
            numbers, both = tuple(self._belief.weights), cases.either_way(heard)
            so = self.worth.take(said, both, rates)
            self._doubt(question, so)
            if others := self._words.besides(question):
                shares = self.worth.shares[cases.columns]
                last, model = self._hearing.last, self._belief.model
                known = [(e, self._hearing.now(last[e.text], view, model)) for e in others]
                for those, what, came in ((numbers, cases, taken), ((), both, so)):
                    told = Answered.of(said.yes, those, what, came, shares)
                    self._words.hear(question, told, known)
            heard.told(numbers, taken.drawn)
            if self._trust is not None:
                heard.say(so.likely, so.drawn)
                self._belief.hear(taken.likely, self._left_out(said, cases, rates))
                self._tell_apart()
            else:
                heard.say(np.broadcast_to(_alike(both, so), both.mass.shape), so.drawn)
                self._belief.hear(_alike(cases, taken))
            self.worth.believe(self._belief.noise)
            return
        self._doubt(question, taken)
        self._weighed.see(question.atoms, *taken.whole)
        heard.told((), taken.drawn)
        heard.believed = self._weighed.probability(question.atom, question.alike)
        masses = cases.mass * taken.likely
        both = np.maximum(masses.sum(axis=0), 1e-300)
        heard.true = np.clip(masses[0] / both, SURE, 1 - SURE)
        self.worth.believe(np.maximum(both / both.sum(), NEVER))

    def _doubt(self, question: FactQuestion, taken: Taken) -> None:
        if self._doubts is not None:
            self._doubts.learn(question.atoms, *taken.whole)

    def _left_out(self, said: Said, cases: Cases, rates: Pair) -> Floats | None:
        """How probable an answer is with each of what is left out of the joint states."""
        apart = self._belief.apart
        if apart is None or not len(apart.rest):
            return None
        rest = cases.standing_for(apart.stands, apart.rest)
        found: Floats = (rest.mass * self.worth.take(said, rest, rates).likely).sum(axis=0)
        return found

    def take_from_person(self, question: FactQuestion, reply: Reply) -> None:
        """Weigh the belief by a person's reply to a question."""
        if reply is Reply.CANNOT_SEE:
            self.silence(question.text, PERSONS_VIEW)
        if reply in (Reply.YES, Reply.NO):
            right = PERSON if reply is Reply.YES else 1 - PERSON
            self._weighed.open(question.atoms, self._unexplained, self._instead)
            self._weighed.see(question.atoms, right, 1 - right)


def _alike(cases: Cases, taken: Taken) -> Floats:
    """An answer's probability in each case (rows of one), whatever the noise."""
    likely = (cases.mass * taken.likely).sum(axis=1)
    found: Floats = likely / np.maximum(cases.mass.sum(axis=1), 1e-300)
    return found[:, None]


def _others(said: Pair) -> Pair:
    return 1 - said[0], 1 - said[1]
