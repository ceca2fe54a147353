"""Answers as evidence: each weighs the belief by what it adds to those before."""

from collections import deque
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from tpvqa.belief.belief import NEVER, Belief
from tpvqa.belief.calibration import Apart, Calibration
from tpvqa.belief.chances import Beta
from tpvqa.belief.doubts import Doubts
from tpvqa.belief.heard import EVERY, Columns, Heard
from tpvqa.belief.information import Reliability, answers_to_be_sure, settled
from tpvqa.belief.last_answer import LastAnswer, Picture
from tpvqa.belief.led import Led
from tpvqa.belief.other_words import Answered, OtherWords
from tpvqa.belief.own_words import FAILED, SkillWorth, of_action
from tpvqa.belief.readings import Readings
from tpvqa.belief.repeats import learn_repeats
from tpvqa.belief.settling import Settling, in_doubt
from tpvqa.belief.sight import Sight
from tpvqa.belief.trust import Trust
from tpvqa.belief.weighed import Weighed
from tpvqa.belief.worth import SURE, Cases, Said, Worth, by_truth, moved
from tpvqa.pddl import Action, Atom, Task, literals
from tpvqa.questions.question import FactQuestion
from tpvqa.vlm import Answer, Reply

UNEXPLAINED = 0.002
"""Chance that a fact that an answer speaks against has changed without the action model."""
SURPRISING = 0.25
"""An answer less probable than this makes that chance be taken in."""
SUSPECTED = 0.02
"""That chance where an action that rests on the fact seems never to work."""
REMEMBERED = 8
"""Actions after which it is forgotten what was heard of a question."""
PERSON = 0.99
"""How often a person's answer is right."""
PERSONS_VIEW = "a person's"
"""Stands for the view from which a person could not tell; no world's view is called so."""
NOTICED = 0.8
"""A skill that reports so many of its failures shows what it does."""
PAIRS = 4.0
"""Pairs of answers that ρ counts for without any data."""

Pair = tuple[float, float]
_NONE = np.zeros(0, bool)


class Evidence:
    """Takes answers into a belief.

    With probability ρ a further look at an unchanged fact only repeats the last answer. Whether
    it is unchanged is known in each joint state. ρ has a Beta prior around
    the calibration's and is learned from every further answer, where trust is.

    Args:
        belief: What is believed.
        calibration: What answers are worth.
        trust: Whether they are worth that; None to take the calibration at its word.
        unexplained: Chance that a fact changed without the action model knowing.
        skill: What the report of any skill is worth; by default what the calibration says.
        doubts: Chances that things were elsewhere from the start; none by default.
        words: How far the wordings of a question err alike.
    """

    def __init__(
        self,
        belief: Belief,
        calibration: Calibration,
        trust: Trust | None,
        *,
        unexplained: float = UNEXPLAINED,
        skill: SkillWorth | None = None,
        doubts: Doubts | None = None,
        words: OtherWords | None = None,
    ):
        self._belief, self._calibration, self._trust = belief, calibration, trust
        self._weighed: Weighed = belief
        self._unexplained, self._doubts = unexplained, doubts
        self._skills = calibration.skills if skill is None else (skill,)
        self._sensors = calibration.sensors
        self._readings = Readings(belief, calibration.sensors)
        self._repeats = {
            apart: _cases(calibration.repeat(apart), PAIRS + calibration.pairs(apart))
            for apart in Apart
        }
        self._last: dict[str, LastAnswer] = {}
        self._words = words or OtherWords()
        self.worth = Worth(trust, calibration.lasting)
        self._size = len(self.worth.weights)
        belief.suppose(self.worth.weights)
        self._led: deque[Led | None] = deque(maxlen=REMEMBERED)
        self._acted = 0
        self._opened: set[tuple[Atom, ...]] = set()
        self._silent: set[tuple[str, str | None]] = set()

    def weigh(self, belief: Weighed) -> None:
        """Weigh something else from now on; what was answered before stays known."""
        self._weighed = belief
        self._belief.suppose(self.worth.weights)

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        for last in self._last.values():
            known = last.heard if last.acted == self._acted else {last.view: Heard()}
            for heard in known.values():
                heard.renumbered(numbers)
            last.heard, last.acted = known, self._acted
        self._led.clear()

    def _heard(self, last: LastAnswer, view: str | None) -> Heard:
        """What was heard of a question, as it counts now from a view."""
        since = self._acted - last.acted
        if since:
            heard, led = last.heard[last.view], list(self._led)
            if since > len(led):
                heard = Heard()
            for each in led[len(led) - since :] if since <= len(led) else ():
                heard.acted(each, self._belief.model.truth(last.atoms))
            last.heard, last.acted = {last.view: heard}, self._acted
        return last.heard_from(view)

    def _heard_of(self, question: FactQuestion, view: str | None) -> Heard | None:
        """What was heard of a question, in other words if not in these; None for nothing."""
        if question.text in self._last:
            return self._heard(self._last[question.text], view)
        other = self._words.nearest(question)
        if other is None:
            return None
        heard = self._heard(self._last[other.text], view)
        return self._words.carried(heard, other, question)

    def _cases(self, question: FactQuestion, heard: Heard, columns: Columns = EVERY) -> Cases:
        """What may be the case when a question is asked."""
        if self._weighed is not self._belief:
            now = self._weighed.probability(question.atom, question.alike)
            true, drawn = moved(heard.true, heard.believed, now), heard.drawn((), _NONE, self._size)
            return by_truth(self.worth.weights, true, drawn)
        numbers, mass = self._belief.masses()
        self.worth.believe(self._belief.noise)
        truth = self._belief.model.truth(question.atoms)
        right = np.array([truth[number] for number in numbers], bool)
        drawn = heard.drawn(numbers, right, self._size, columns)
        return Cases(mass[:, columns], right, drawn, columns)

    def acted(self, action: str = "", *, failed: bool | None = None) -> None:
        """Note that an action was executed: facts may have changed, other things are in view.

        Args:
            action: Its name.
            failed: Whether the robot's own skill reports a failure; None where it reports nothing.
        """
        if failed is not None:
            self._take_report(action, failed=failed)
        self._readings.acted()
        self._led.append(self._belief.led)
        self._acted += 1
        for last in self._last.values():
            last.pictures.clear()
            if self._acted - last.acted == REMEMBERED + 1:  # forgotten: it need not be kept
                last.heard = {last.view: Heard()}
        self._opened.clear()
        self._silent.clear()

    def _take_report(self, action: str, *, failed: bool) -> None:
        known = of_action(self._skills, action)
        if known is not None:
            worked, not_worked = known.likelihoods(failed=failed)
        elif failed:
            worked, not_worked = FAILED
        else:
            return
        # A skill that finds nothing to do may call that a failure, or not.
        idle = (worked + not_worked) / 2 if failed else worked
        self._belief.weigh_outcome(succeeded=worked, failed=not_worked, achieved=idle)

    def noticed(self, task: Task) -> frozenset[str]:
        """The predicates of facts that the robot is known to notice itself: those whose sensors
        were calibrated, and those that skills change which report their failures."""
        sensed = {each.predicate for each in self._sensors}
        for schema in task.schemas:
            known = of_action(self._skills, schema.name)
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
        if atoms not in self._opened and self._unexplained:
            self._opened.add(atoms)
            elsewhere = self._doubts.taken(atoms, held=held) if self._doubts else 0.0
            self._weighed.open(atoms, max(self._unexplained, elsewhere))

    def rests_on(self, action: Action) -> None:
        """Take in that a thing may never have been where an action needs it, before it is done."""
        if self._doubts is None:
            return
        for literal in literals(action.precondition):
            atom = literal.atom
            if literal.positive and self._belief.probability(atom) >= 0.5:
                chance = self._doubts.gone(atom)
                if chance:
                    self._belief.open((atom,), chance)

    def doubt(self, action: Action, sight: Sight) -> None:
        """Take in that an action which fails again and again may need what does not hold."""
        task = self._belief.model.task
        for literal in literals(action.precondition):
            atom = literal.atom
            if atom.predicate in task.fluents and sight.sees(atom):
                self._belief.open((atom,), SUSPECTED)

    def asked_of(self, text: str, picture: Picture) -> bool:
        """Whether a question was answered on a picture since the last action: once more is worth
        nothing."""
        last = self._last.get(text)
        return last is not None and picture in last.pictures

    def silence(self, text: str, view: str | None) -> None:
        """Note that a question finds no answer from a view before the next action."""
        self._silent.add((text, view))

    def silent(self, text: str, view: str | None) -> bool:
        """Whether that was noted."""
        return (text, view) in self._silent

    @property
    def unseen(self) -> bool:
        """Whether any question found no answer since the last action."""
        return bool(self._silent)

    def answers_to_be_sure(self) -> float:
        """How many answers of this VLM it takes to notice a mistake."""
        rates = self._calibration.whole.rates
        expected = self.worth.expect((rates.yes_if_true, rates.yes_if_false))
        right = (expected.yes_if_true + 1 - expected.yes_if_false) / 2
        sure = answers_to_be_sure(right, self._repeats[Apart.SAME_VIEW].mean)
        return 1 + (sure - 1) * max(0.0, 5 * self.settling().share - 4)

    def settling(self, questions: Iterable[FactQuestion] = ()) -> Settling:
        """How far the answers in another scene would settle what is in doubt.

        Args:
            questions: About what may be in doubt; none for a fact that was never asked about.
        """
        whole = self._calibration.whole.rates
        new = self.worth.expect((whole.yes_if_true, whole.yes_if_false))
        doubts: dict[str, tuple[float, Reliability]] = {}
        for question in questions:
            true = self._weighed.probability(question.atom, question.alike)
            nearest, expected = self._words.nearest(question), new
            last = self._last.get(question.text if nearest is None else nearest.text)
            if last is not None and in_doubt(true):
                rates, cases = self._calibration.group(question).rates, None
                heard = self._heard_of(question, last.view) if self.worth.lasts else None
                if heard is not None:
                    columns = self.worth.columns
                    cases = self._cases(question, heard, columns).elsewhere(self.worth.stays)
                expected = self.worth.expect((rates.yes_if_true, rates.yes_if_false), cases)
            known = doubts.get(question.family)
            if known is None or settled(expected) > settled(known[1]):
                doubts[question.family] = true, expected
        return Settling.of(doubts.values(), new)

    def expect(self, question: FactQuestion, view: str | None) -> Reliability:
        """What the next answers to a question, at new looks from a view, are worth."""
        rates = self._calibration.group(question).rates
        abstains = min((rates.abstain_if_true + rates.abstain_if_false) / 2, 0.95)
        said = rates.yes_if_true, rates.yes_if_false
        last = self._last.get(question.text)
        heard = self._heard_of(question, view)
        if heard is None:
            return replace(self.worth.expect(said), abstains=abstains)
        cases = self._cases(question, heard, self.worth.columns)
        found = self.worth.expect(said, cases)
        if last is None:
            return replace(found, abstains=abstains)
        rho = self._repeats[_apart(last, view)].mean
        before = 1.0 if last.reply is Reply.YES else 0.0
        if_true, if_false = (
            tuple((share, again * before + (1 - again) * each) for share, each in mixture)
            for again, mixture in zip(
                (rho * same for same in _unchanged(cases)), found.mixtures, strict=True
            )
        )
        return Reliability.mixed(if_true, if_false, abstains)

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
        atoms = question.atoms
        last = self._last.get(question.text)
        if last is not None and picture in last.pictures:
            return 1.0
        group = self._calibration.group(question)
        true = self._weighed.probability(question.atom, question.alike)
        yes, rates = answer.reply is Reply.YES, (group.rates.yes_if_true, group.rates.yes_if_false)
        said = Said(yes, group.log_ratio(answer.reply, answer.p_yes))
        heard = self._heard_of(question, view) or Heard()
        cases = self._cases(question, heard)
        if last is not None:
            repeats, same = self._repeats[_apart(last, view)], last.reply is answer.reply
            if self._trust is not None:
                # How often this word is said, not how much this P(yes) is worth.
                expected = self.worth.expect(rates, cases)
                words = (expected.yes_if_true, expected.yes_if_false)
                told = words if yes else _others(words)
                learn_repeats(repeats, true, told, _unchanged(cases), float(same))
            said = replace(said, repeats=repeats.mean, same=same)
        taken = self.worth.take(said, cases, rates)
        (if_true, if_false) = taken.whole
        probable = true * if_true + (1 - true) * if_false
        if last is None:
            last = LastAnswer(answer.reply, set(), view, atoms, self._acted)
            self._last[question.text] = last
        last.reply, last.view, last.heard[view] = answer.reply, view, heard
        last.pictures.add(picture)
        if probable < SURPRISING:
            self._open(atoms, held=true >= 0.5)
        elif self._doubts is not None:
            self._doubts.learn(atoms, if_true, if_false)
        self._weigh_answer(question, heard, said, rates, view)
        self._words.ask(question)
        return probable

    def _weigh_answer(
        self, question: FactQuestion, heard: Heard, said: Said, rates: Pair, view: str | None
    ) -> None:
        cases = self._cases(question, heard)
        taken = self.worth.take(said, cases, rates)
        self.worth.compare(said, rates)
        masses = cases.mass * taken.likely
        if self._weighed is self._belief:
            numbers = tuple(self._belief.weights)
            if others := self._words.besides(question):
                came = Answered.of(said.yes, numbers, cases, taken, self.worth.shares)
                known = [(each, self._heard(self._last[each.text], view)) for each in others]
                self._words.hear(question, came, known)
            heard.told(numbers, taken.drawn)
            alike = masses.sum(axis=1) / np.maximum(cases.mass.sum(axis=1), 1e-300)
            learns = self._trust is not None
            self._belief.hear(taken.likely if learns else alike[:, None])
            self.worth.believe(self._belief.noise)
            return
        self._weighed.see(question.atoms, *taken.whole)
        heard.told((), taken.drawn)
        heard.believed = self._weighed.probability(question.atom, question.alike)
        both = np.maximum(masses.sum(axis=0), 1e-300)
        heard.true = np.clip(masses[0] / both, SURE, 1 - SURE)
        self.worth.believe(np.maximum(both / both.sum(), NEVER))

    def take_from_person(self, question: FactQuestion, reply: Reply) -> None:
        """Weigh the belief by a person's reply to a question."""
        if reply is Reply.CANNOT_SEE:
            self.silence(question.text, PERSONS_VIEW)
        if reply in (Reply.YES, Reply.NO):
            right = PERSON if reply is Reply.YES else 1 - PERSON
            self._weighed.open(question.atoms, self._unexplained)
            self._weighed.see(question.atoms, right, 1 - right)


def _unchanged(cases: Cases) -> Pair:
    """Probability that yes (no) was right at the last answer already, where it is right now."""
    kept = cases.drawn.kept
    return cases.where(kept, true=True), cases.where(kept, true=False)


def _cases(mean: float, cases: float) -> Beta:
    return Beta(cases * mean, cases * (1 - mean))


def _others(said: Pair) -> Pair:
    return 1 - said[0], 1 - said[1]


def _apart(last: LastAnswer, view: str | None) -> Apart:
    return Apart.SAME_VIEW if last.view == view else Apart.OTHER_VIEW
