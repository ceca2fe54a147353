"""Answers as evidence: each weighs the belief by what it adds to those before."""

from collections.abc import Collection, Hashable, Iterable
from dataclasses import dataclass
from math import exp, log
from typing import Protocol

from tpvqa.belief.belief import Belief
from tpvqa.belief.calibration import Apart, Calibration, Group
from tpvqa.belief.chances import Beta
from tpvqa.belief.counts import PSEUDO
from tpvqa.belief.doubts import Doubts
from tpvqa.belief.information import Reliability, answers_to_be_sure
from tpvqa.belief.own_words import FAILED, SkillWorth, of_action
from tpvqa.belief.readings import Readings
from tpvqa.belief.sight import Sight
from tpvqa.belief.trust import Trust
from tpvqa.pddl import Action, Atom, Task, literals
from tpvqa.questions.question import FactQuestion
from tpvqa.vlm import Answer, Reply

UNEXPLAINED = 0.002
"""Chance that a fact that an answer speaks against has changed without the action model."""
SURPRISING = 0.25
"""An answer less probable than this makes that chance be taken in."""
SUSPECTED = 0.02
"""That chance where an action that rests on the fact seems never to work."""
PERSON = 0.99
"""How often a person's answer is right."""
PERSONS_VIEW = "a person's"
"""Stands for the view from which a person could not tell; no world's view is called so."""
NOTICED = 0.8
"""A skill that reports so many of its failures shows what it does."""
PAIRS = 4.0
"""Pairs of answers that ρ counts for without any data."""

Pair = tuple[float, float]
Picture = Hashable
"""What tells one picture from another: what it shows, or else the number of the look."""


@dataclass(slots=True)
class _Last:
    """The last answer to a question.

    Attributes:
        pictures: Of which pictures it was asked since something was done last.
        view: From which view the last one was.
        true: Probability, after it, that yes was right.
        yes: Yeses to the question since something was done last.
        no: Noes since then.
        settled: Whether nothing was done since, so that what is true is unchanged.
    """

    reply: Reply
    pictures: set[Picture]
    view: str | None
    true: float
    yes: int = 0
    no: int = 0
    settled: bool = True


class Weighed(Protocol):
    """What answers weigh: a belief, or what was believed before anything was done."""

    def probability(self, atom: Atom, alike: Iterable[Atom] = ()) -> float:
        """The probability of a fact, or of it or any fact alike."""

    def see(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> float:
        """Weigh by an answer about a fact (or any of several alike)."""

    def open(self, atoms: tuple[Atom, ...], chance: float) -> int:
        """Take in that a fact may have changed without the action model knowing."""


class Evidence:
    """Takes answers into a belief.

    With probability ρ a further look at an unchanged fact only repeats the last answer. Whether
    it is unchanged is known as well as the fact was after that answer. ρ has a Beta prior around
    the calibration's and is learned from every further answer, where trust is.

    Args:
        belief: What is believed.
        calibration: What answers are worth.
        trust: Whether they are worth that; None to take the calibration at its word.
        unexplained: Chance that a fact changed without the action model knowing.
        skill: What the report of any skill is worth; by default what the calibration says.
        doubts: Chances that things were elsewhere from the start; none by default.
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
        self._last: dict[str, _Last] = {}
        self._opened: set[tuple[Atom, ...]] = set()
        self._silent: set[tuple[str, str | None]] = set()

    def weigh(self, belief: Weighed) -> None:
        """Weigh something else from now on; what was answered before stays known."""
        self._weighed = belief

    def acted(self, action: str = "", *, failed: bool | None = None) -> None:
        """Note that an action was executed: facts may have changed, other things are in view.

        Args:
            action: Its name.
            failed: Whether the robot's own skill reports a failure; None where it reports nothing.
        """
        if failed is not None:
            self._take_report(action, failed=failed)
        self._readings.acted()
        for last in self._last.values():
            last.settled = False
            last.pictures.clear()
            last.yes = last.no = 0
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
        right = (rates.yes_if_true + 1 - rates.yes_if_false) / 2
        if self._trust is not None:
            right = 0.5 + _share(self._trust, rates.yes_if_true, rates.yes_if_false) * (right - 0.5)
        return answers_to_be_sure(right, self._repeats[Apart.SAME_VIEW].mean)

    def expect(self, question: FactQuestion, view: str | None) -> Reliability:
        """What the next answer to a question, at a new look from a view, is worth."""
        group = self._calibration.group(question)
        rates = group.rates
        abstains = (rates.abstain_if_true + rates.abstain_if_false) / 2
        true, false = rates.yes_if_true, rates.yes_if_false
        if self._trust is not None:
            # The same answer, worth what it can be trusted: drawn towards one half.
            share = _share(self._trust, true, false)
            true, false = 0.5 + share * (true - 0.5), 0.5 + share * (false - 0.5)
        last = self._last.get(question.text)
        if last is not None:
            true, false = _with_history(group, last, true, false)
            rho = self._repeats[_apart(last, view)].mean
            before = 1.0 if last.reply is Reply.YES else 0.0
            if_true, if_false = _unchanged(last)
            true = rho * if_true * before + (1 - rho * if_true) * true
            false = rho * if_false * before + (1 - rho * if_false) * false
        return Reliability(true, false, min(abstains, 0.95))

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
        raw = group.log_ratio(answer.reply, answer.p_yes)
        true = self._weighed.probability(question.atom, question.alike)
        ratio = raw if self._trust is None else self._trust.ratio(raw)
        if_true = _sigmoid(ratio)
        if_false = 1 - if_true
        again_true = again_false = same = 0.0
        yes = answer.reply is Reply.YES
        if last is not None:
            if yes:
                if_true, if_false = _with_history(group, last, if_true, if_false)
            else:
                yes_true, yes_false = _with_history(group, last, 1 - if_true, 1 - if_false)
                if_true, if_false = 1 - yes_true, 1 - yes_false
            repeats = self._repeats[_apart(last, view)]
            same = 1.0 if last.reply is answer.reply else 0.0
            unchanged = _unchanged(last)
            again_true, again_false = (repeats.mean * share for share in unchanged)
            if self._trust is not None:
                # How often this word is said, not how much this P(yes) is worth.
                said = (group.rates.yes_if_true, group.rates.yes_if_false)
                _learn_repeats(repeats, true, said if yes else _others(said), unchanged, same)
            if_true = again_true * same + (1 - again_true) * if_true
            if_false = again_false * same + (1 - again_false) * if_false
        probable = true * if_true + (1 - true) * if_false
        if probable < SURPRISING:
            self._open(atoms, held=true >= 0.5)
        elif self._doubts is not None:
            self._doubts.learn(atoms, if_true, if_false)
        self._weighed.see(atoms, if_true, if_false)
        if self._trust is not None:
            self._trust.learn(
                true, raw, same=bool(same), again_true=again_true, again_false=again_false
            )
        after = self._weighed.probability(question.atom, question.alike)
        if last is None:
            last = self._last[question.text] = _Last(answer.reply, set(), view, after)
        last.reply, last.view, last.true, last.settled = answer.reply, view, after, True
        last.pictures.add(picture)
        last.yes, last.no = last.yes + yes, last.no + (not yes)
        return probable

    def take_from_person(self, question: FactQuestion, reply: Reply) -> None:
        """Weigh the belief by a person's reply to a question."""
        if reply is Reply.CANNOT_SEE:
            self.silence(question.text, PERSONS_VIEW)
        if reply in (Reply.YES, Reply.NO):
            right = PERSON if reply is Reply.YES else 1 - PERSON
            self._weighed.open(question.atoms, self._unexplained)
            self._weighed.see(question.atoms, right, 1 - right)


def _with_history(
    group: Group, last: _Last, if_true: float, if_false: float
) -> tuple[float, float]:
    """Rates of yes, given the answers to the same question since the last action.

    A rate is known from so many cases only. Answers that go on coming where one of the two says
    they should not speak against that rate as well as against the fact (Beta-binomial).
    """
    cases = PSEUDO + group.rows / 2
    total = cases + last.yes + last.no
    return (cases * if_true + last.yes) / total, (cases * if_false + last.yes) / total


def _unchanged(last: _Last) -> tuple[float, float]:
    """Probability that yes (no) was right at the last answer already, where it is right now."""
    return (1.0, 1.0) if last.settled else (last.true, 1 - last.true)


def _cases(mean: float, cases: float) -> Beta:
    return Beta(cases * mean, cases * (1 - mean))


def _learn_repeats(repeats: Beta, true: float, said: Pair, unchanged: Pair, same: float) -> None:
    """Learn from one more answer how often answers repeat.

    Args:
        repeats: What is known of ρ.
        true: Probability, before the answer, that yes is right.
        said: Probability of this reply, drawn afresh, where yes is right and where no is.
        unchanged: Probability that the fact was the same at the last answer, likewise.
        same: 1 where it is the last reply again, else 0.
    """
    still = (true * unchanged[0], (1 - true) * unchanged[1])
    changed = (true * (1 - unchanged[0]), (1 - true) * (1 - unchanged[1]))
    yes = repeats.mean * same * sum(still)
    no = (1 - repeats.mean) * (still[0] * said[0] + still[1] * said[1])
    total = yes + no + changed[0] * said[0] + changed[1] * said[1]
    if total > 0:
        repeats.learn(yes / total, no / total)


def _others(said: Pair) -> Pair:
    return 1 - said[0], 1 - said[1]


def _apart(last: _Last, view: str | None) -> Apart:
    return Apart.SAME_VIEW if last.view == view else Apart.OTHER_VIEW


def _share(trust: Trust, true: float, false: float) -> float:
    """By how much trust draws the rates of yes towards one half; never away from it."""
    right = min(max((true + 1 - false) / 2, 0.501), 0.999)
    trusted = _sigmoid(trust.ratio(_logit(right)))
    return min((trusted - 0.5) / (right - 0.5), 1.0)


def _sigmoid(x: float) -> float:
    return 1 / (1 + exp(-x))


def _logit(p: float) -> float:
    return log(p / (1 - p))


def words(replies: Collection[Reply]) -> str:
    """Some replies in words: "two noes and a yes"."""
    parts = []
    for reply, one, many in ((Reply.NO, "a no", "noes"), (Reply.YES, "a yes", "yeses")):
        count = sum(1 for each in replies if each is reply)
        if count:
            number = _NUMBERS[count] if count < len(_NUMBERS) else str(count)
            parts.append(one if count == 1 else f"{number} {many}")
    return " and ".join(parts)


_NUMBERS = ("no", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine")
