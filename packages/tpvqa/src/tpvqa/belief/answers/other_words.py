"""Several wordings of one question: what was heard of one says something of the others.

What lasts of the answers, the scene's own answer (`belief.lasting`), is in another wording with a
probability the very same as in the first, and otherwise its own. How often is itself learned, from
how the first answers in other words agree with what was heard.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.heard import Drawn, Heard, own
from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.lasting import SUREST
from tpvqa.belief.answers.worth import SURE, Cases, Taken
from tpvqa.questions.question import FactQuestion

SHARES = np.array([0.02, 0.25, 0.5, 0.75, 0.98])
"""What is told apart of how often what lasts is the same in other words."""


@dataclass(frozen=True, slots=True)
class Answered:
    """An answer, and what it came to: one row for each of several cases.

    Attributes:
        yes: Whether it is a yes.
        numbers: Of the joint states that are the cases.
        truth: Whether yes is right in them.
        mass: Probability of each case with everything that is told apart of the noise.
        shares: Lasting shares of all that is told apart.
        first: P(yes) of the scene's own answer before it is drawn.
        before: P(the scene's own answer is a yes), before this one.
        after: The same after it.
    """

    yes: bool
    numbers: tuple[int, ...]
    truth: NDArray[np.bool_]
    mass: Floats
    shares: Floats
    first: Floats
    before: Floats
    after: Floats

    @staticmethod
    def of(
        yes: bool, numbers: tuple[int, ...], cases: Cases, taken: Taken, shares: Floats
    ) -> "Answered":
        """What an answer came to in joint states.

        Args:
            yes: Whether it is a yes.
            numbers: Of the joint states.
            cases: What was the case in them.
            taken: What the answer came to.
            shares: Lasting shares of all that is told apart.
        """
        before = own(cases.drawn, taken.first)
        return Answered(
            yes, numbers, cases.truth, cases.mass, shares, taken.first, before, taken.drawn.yes
        )


class OtherWords:
    """How far the wordings of a question err alike, and which of them were asked.

    Args:
        share: How often what lasts is the same in another wording as in the first; None to learn
            it.
    """

    def __init__(self, share: float | None = None):
        self._learns = share is None
        self._shares = SHARES if share is None else np.array([min(max(share, 0.001), 0.999)])
        self._weights: Floats = np.full(len(self._shares), 1 / len(self._shares))
        self._asked: dict[str, list[FactQuestion]] = {}

    @property
    def share(self) -> float:
        """How often, as far as that is known."""
        return float(self._weights @ self._shares)

    def ask(self, question: FactQuestion) -> None:
        """Note that a question is asked."""
        asked = self._asked.setdefault(question.family, [])
        if all(each.text != question.text for each in asked):
            asked.append(question)

    def nearest(self, question: FactQuestion) -> FactQuestion | None:
        """The wording that was asked and tells most of one that was not: the first, if it was."""
        others = self._asked.get(question.family, ())
        return min(others, key=lambda each: each.wording, default=None)

    def besides(self, question: FactQuestion) -> Sequence[FactQuestion]:
        """The other wordings of a question that were asked."""
        asked = self._asked.get(question.family, ())
        return [each for each in asked if each.text != question.text]

    def between(self, one: FactQuestion, other: FactQuestion) -> float:
        """How often what lasts is the same in two wordings."""
        return self.share if 0 in (one.wording, other.wording) else self.share**2

    def carried(self, heard: Heard, one: FactQuestion, other: FactQuestion) -> Heard:
        """What is known of a wording that was never asked, by what was heard of another."""
        share = self.between(one, other)
        first, rows = (each and _shared(each, share) for each in (heard.by_truth, heard.rows))
        return Heard(first, heard.numbers, rows, heard.true, heard.believed)

    def hear(
        self,
        question: FactQuestion,
        answer: Answered,
        others: Sequence[tuple[FactQuestion, Heard]],
    ) -> None:
        """Take in what an answer says of the others; and, if it is the first one in its words, how
        often they err alike.

        Args:
            question: What was asked.
            answer: What came.
            others: The other wordings that were asked, with what was heard of each.
        """
        nearest = self.nearest(question)
        for other, heard in others:
            known = heard.drawn(answer.numbers, answer.truth, answer.first.shape[1])
            new = question not in self._asked[question.family]
            if self._learns and new and other is nearest and answer.numbers:
                self._learn(answer, known)
            heard.told(answer.numbers, self._told(answer, self.between(question, other), known))

    def _learn(self, answer: Answered, known: Drawn) -> None:
        probable = []
        for own_yes in (own(known, answer.first), answer.first):
            yes = answer.shares * own_yes + (1 - answer.shares) * answer.first
            probable.append(float((answer.mass * (yes if answer.yes else 1 - yes)).sum()))
        same, apart = probable
        weights = self._weights * (self._shares * same + (1 - self._shares) * apart)
        self._weights = weights / weights.sum()

    def _told(self, answer: Answered, share: float, known: Drawn) -> Drawn:
        """What is known of the scene's own answer in another wording, after an answer.

        Before any answer the two are the same with a probability. Answers to the one say nothing
        of the other but by it, and so leave the odds ratio of the two as it was (the copula of
        Plackett 1965): what both are is known from what each is.
        """
        was = np.clip(own(known, answer.first), SURE, 1 - SURE)
        before = np.clip(answer.before, SURE, 1 - SURE)
        both = _both(before, was, _odds_ratio(answer.first, share))
        if_yes, if_no = both / before, (was - both) / (1 - before)
        now = np.clip(answer.after * if_yes + (1 - answer.after) * if_no, 0.0, 1.0)
        return Drawn(
            now,
            np.zeros_like(now),
            known.kept,
            known.answers + share,
            known.yeses + share * answer.yes,
        )


def _shared(drawn: Drawn, share: float) -> Drawn:
    return Drawn(
        share * drawn.yes,
        share * drawn.new + 1 - share,
        drawn.kept,
        share * drawn.answers,
        share * drawn.yeses,
    )


def _odds_ratio(rate: Floats, share: float) -> Floats:
    """Of two answers with a rate of yes each, which are the very same with a probability."""
    rate = np.clip(rate, SUREST, 1 - SUREST)
    same = (share + (1 - share) * rate) * (share + (1 - share) * (1 - rate))
    found: Floats = same / ((1 - share) ** 2 * rate * (1 - rate))
    return found


def _both(one: Floats, other: Floats, ratio: Floats) -> Floats:
    """The probability of both, from that of each and their odds ratio."""
    less = np.maximum(ratio - 1, 1e-9)
    total = 1 + (one + other) * less
    root = np.sqrt(np.maximum(total**2 - 4 * ratio * less * one * other, 0.0))
    found = 2 * ratio * one * other / (total + root)
    return np.clip(found, np.maximum(one + other - 1, 0.0), np.minimum(one, other))
