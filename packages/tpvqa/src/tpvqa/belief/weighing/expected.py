"""What is expected of further answers, by all that was heard until now."""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from tpvqa.belief.answers.biases import Biases
from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.hearing import Hearing
from tpvqa.belief.answers.information import LATE, Floats, Reliability, answers_to_be_sure, settled
from tpvqa.belief.answers.last_answer import LastAnswer
from tpvqa.belief.answers.lasting import EVERY, Columns
from tpvqa.belief.answers.led import Places
from tpvqa.belief.answers.other_words import OtherWords
from tpvqa.belief.answers.trust import Trust
from tpvqa.belief.answers.weighed import Weighed
from tpvqa.belief.answers.worth import SLIGHT, Cases, Worth, by_truth, moved
from tpvqa.belief.calibrating.beta import Beta
from tpvqa.belief.calibrating.calibration import Apart, Calibration
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.weighing.settling import Settling, in_doubt
from tpvqa.questions.question import FactQuestion
from tpvqa.vlm import Reply

PAIRS = 4.0
"""Pairs of answers that ρ counts for without any data."""
DEARER = 2.0
"""How many times its price a question has to be worth at most, while answers are worth a thing."""

Pair = tuple[float, float]
_NONE = np.zeros(0, bool)
WORTHLESS = 0.1
"""Answers that settle less of a doubt that was never asked about are worth nothing."""
EXHAUSTED = 5.0
"""So many times the answers that it takes to be sure are asked for in one scene, at most."""
AGREEING = 6.0
"""The same of those by which yeses outnumber noes, or noes yeses."""


class Expected:
    """What is expected of answers.

    Args:
        belief: What is believed.
        calibration: What answers are worth.
        trust: Whether they are worth that; None to take the calibration at its word.
        words: How far the wordings of a question err alike.
        biases: What was learned of single predicates.

    Attributes:
        worth: What answers are worth, as far as they have shown it.
        biases: What they have shown of single predicates, where trust is learned.
    """

    def __init__(
        self,
        belief: Belief,
        calibration: Calibration,
        trust: Trust | None,
        words: OtherWords | None,
        biases: Biases | None = None,
    ):
        self._belief, self._calibration, self._trust = belief, calibration, trust
        self._weighed: Weighed = belief
        self._repeats = {
            apart: _cases(calibration.repeat(apart), PAIRS + calibration.pairs(apart))
            for apart in Apart
        }
        self._words = words or OtherWords()
        self._hearing = Hearing(self._words)
        self.biases = biases or Biases()
        self.worth = Worth(trust, calibration.lasting)
        belief.suppose(self.worth.weights)
        self._likeliest: tuple[Floats, tuple[Floats, Columns, Places]] | None = None

    def answers_to_be_sure(self) -> float:
        """How many answers of this VLM it takes to notice a mistake."""
        return self._as_settled(self._to_be_sure())

    @property
    def late(self) -> float:
        """How many answers later a mistake is taken to be noticed, where answers are priced."""
        return self._as_settled(min(self._to_be_sure(), LATE * self._said_to_be_sure()))

    def _as_settled(self, answers: float) -> float:
        return 1 + (answers - 1) * max(0.0, 5 * self.settling().share - 4)

    def exhausted(self, yeses: int, noes: int) -> bool:
        """Whether a question has said what it can in one scene, by its answers there.

        As errors last, what it has not settled then it never will: neither where many more answers
        came than it takes, at what they are trusted now, nor where so many more agree than it
        takes, at what the calibration says of them.
        """
        many = yeses + noes >= EXHAUSTED * self._to_be_sure()
        return many or abs(yeses - noes) >= AGREEING * self._said_to_be_sure()

    def _said_to_be_sure(self) -> float:
        """How many answers the calibration says it takes; that of a VLM of which nothing is known
        only guesses how often an answer repeats the last one."""
        calibration = self._calibration
        repeat = calibration.repeat_same_view if calibration.rows else 0.0
        return answers_to_be_sure(self.right, repeat)

    def _to_be_sure(self) -> float:
        rates = self._calibration.whole.rates
        expected = self.worth.expect((rates.yes_if_true, rates.yes_if_false))
        right = (expected.yes_if_true + 1 - expected.yes_if_false) / 2
        return answers_to_be_sure(right, self._repeats[Apart.SAME_VIEW].mean)

    @property
    def right(self) -> float:
        """How often answers are right, by the calibration."""
        rates = self._calibration.whole.rates
        return min(max((rates.yes_if_true + 1 - rates.yes_if_false) / 2, 0.501), 0.999)

    def dearer(self, times: float) -> float:
        """How many times its price a question has to be worth.

        What decides between two actions is worth no more where a failed task costs more; so it is
        `DEARER` at most, unless answers are probably worth nothing.

        Args:
            times: How many times as much a failed task costs as it would if all could be seen.
        """
        return times if self.worth.nothing > 0.5 else min(times, DEARER)

    def worthless(self, found: Settling) -> bool:
        """Whether answers are probably worth nothing, or are known to be."""
        return self.worth.nothing > 0.5 or found.new < WORTHLESS

    def settling(self, questions: Iterable[FactQuestion] = ()) -> Settling:
        """How far the answers in another scene would settle what is in doubt.

        Args:
            questions: About what may be in doubt; none for a fact that was never asked about.
        """
        whole = self._calibration.whole.rates
        new = self.worth.expect((whole.yes_if_true, whole.yes_if_false))
        told: list[tuple[str, float, Reliability | None]] = []
        asked: list[tuple[Pair, Cases]] = []
        for question in questions:
            true = self._weighed.probability(question.atom, question.alike)
            expected: Reliability | None = new
            if in_doubt(true):
                nearest = self._words.nearest(question)
                last = self._hearing.last.get(question.text if nearest is None else nearest.text)
                if last is not None:
                    rates = self._rates(question)
                    heard = self._heard_of(question, last.view) if self.worth.lasts else None
                    expected = self.worth.expect(rates) if heard is None else None
                    if heard is not None:
                        cases = self._cases(question, heard, likely=True)
                        asked.append((rates, cases.elsewhere(self.worth.stays)))
            told.append((question.family, true, expected))
        further = iter(self.worth.expect_all(asked))
        doubts: dict[str, tuple[float, Reliability]] = {}
        for family, true, expected in told:
            each, known = expected or next(further), doubts.get(family)
            if known is None or settled(each) > settled(known[1]):
                doubts[family] = true, each
        return Settling.of(doubts, new)

    def _rates(self, question: FactQuestion) -> Pair:
        said = self._rates_said(question)
        return self.biases.rates(question, said) if self._finds_biases else said

    @property
    def _finds_biases(self) -> bool:
        """Whether there are labelled rates that a predicate's may differ from."""
        return self._trust is not None and self._calibration.rows > 0

    def _rates_said(self, question: FactQuestion) -> Pair:
        """By the calibration."""
        rates = self._calibration.group(question).rates
        return rates.yes_if_true, rates.yes_if_false

    def expect(self, question: FactQuestion, view: str | None) -> Reliability:
        """What the next answers to a question, at new looks from a view, are worth."""
        return self.expect_all([(question, view)])[0]

    def expect_all(self, questions: Iterable[tuple[FactQuestion, str | None]]) -> list[Reliability]:
        """The same of several questions, each with a view."""
        found: list[Reliability | None] = []
        asked: list[tuple[Pair, Cases]] = []
        answered: list[tuple[FactQuestion, str | None]] = []
        for question, view in questions:
            heard, rates = self._heard_of(question, view), self._rates(question)
            if heard is None:
                found.append(self._abstaining(question, self.worth.expect(rates)))
                continue
            found.append(None)
            asked.append((rates, self._cases(question, heard, likely=True)))
            answered.append((question, view))
        told = zip(answered, asked, self.worth.expect_all(asked), strict=True)
        further = (self._repeating(*each, cases, new) for each, (_, cases), new in told)
        return [each or next(further) for each in found]

    def keep(self, question: FactQuestion, view: str | None) -> None:
        """Note that a question matters still: what was heard of it is not forgotten."""
        self._heard_of(question, view)

    def _abstaining(self, question: FactQuestion, expected: Reliability) -> Reliability:
        rates = self._calibration.group(question).rates
        abstains = min((rates.abstain_if_true + rates.abstain_if_false) / 2, 0.95)
        return replace(expected, abstains=abstains)

    def _repeating(
        self, question: FactQuestion, view: str | None, cases: Cases, found: Reliability
    ) -> Reliability:
        """What is expected of answers that may repeat the last one."""
        last = self._hearing.last.get(question.text)
        if last is not None:
            rho = self._repeats[answered_apart(last, view)].mean
            before = 1.0 if last.reply is Reply.YES else 0.0
            if_true, if_false = (
                tuple((share, again * before + (1 - again) * each) for share, each in mixture)
                for again, mixture in zip(
                    (rho * same for same in unchanged(cases)), found.mixtures, strict=True
                )
            )
            found = Reliability.mixed(if_true, if_false, 0.0)
        return self._abstaining(question, found)

    def _heard_of(self, question: FactQuestion, view: str | None) -> Heard | None:
        """What was heard of a question, in other words if not in these; None for nothing."""
        return self._hearing.of(question, view, self._belief.model)

    def _cases(self, question: FactQuestion, heard: Heard, *, likely: bool = False) -> Cases:
        """What may be the case when a question is asked; where only what is likely counts, without
        what is next to impossible of the noise."""
        if self._weighed is not self._belief:
            now = self._weighed.probability(question.atom, question.alike)
            size = len(self.worth.weights)
            true, drawn = moved(heard.true, heard.believed, now), heard.drawn((), _NONE, size)
            return by_truth(self.worth.weights, true, drawn)
        numbers, mass = self._belief.masses()
        self.worth.believe(self._belief.noise)
        right, columns = self._belief.holds(question.atoms), self._belief.told
        places: Columns = EVERY
        if likely:
            mass, places, columns = self._likely(mass, columns)
        return Cases(
            mass, right, heard.drawn(numbers, right, len(self._belief.told), places), columns
        )

    def _likely(self, mass: Floats, columns: Places) -> tuple[Floats, Columns, Places]:
        """The columns that are not next to impossible: masses, places, and which they are."""
        known = self._likeliest
        if known is None or known[0] is not mass:
            places = np.flatnonzero(self.worth.weights[columns] > SLIGHT)
            known = self._likeliest = mass, (mass[:, places], places, columns[places])
        return known[1]


def unchanged(cases: Cases) -> Pair:
    """Probability that yes (no) was right at the last answer already, where it is right now."""
    weights = cases.mass.sum(axis=1)
    where = np.stack([weights * cases.truth, weights * ~cases.truth])
    true, false = ((where @ cases.drawn.kept) / np.maximum(where.sum(axis=1), 1e-300)).tolist()
    return true, false


def _cases(mean: float, cases: float) -> Beta:
    return Beta(cases * mean, cases * (1 - mean))


def answered_apart(last: LastAnswer, view: str | None) -> Apart:
    """Whether a further answer from a view is of another one than the last was."""
    return Apart.SAME_VIEW if last.view == view else Apart.OTHER_VIEW
