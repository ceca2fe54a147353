"""Questions whose answers are not known, and what is expected of their answers."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from operator import mul

from tpvqa.belief.answers.information import Reliability, settled
from tpvqa.belief.weighing.evidence import Evidence
from tpvqa.questions.question import FactQuestion

TOGETHER = 4
"""Questions that are thought to be asked together, at most."""
SAYING = 0.02
"""A question whose further answers settle less of a doubt is exhausted in this scene."""
EQUAL = 1e-9
"""Savings that differ by less are equal: the last bits of a sum are the processor's."""


@dataclass
class Doubted:
    """A question whose answer is not known.

    Attributes:
        urgent: Orders them: what matters most first, then what is least known.
        place: Among all questions.
        likely: The probability that yes is right.
        view: From where it is asked next.
        evidence: Says what is expected of answers.
        expected: That, once it was worked out.
    """

    urgent: tuple[float, float]
    place: int
    question: FactQuestion
    likely: float
    view: str | None
    evidence: Evidence
    expected: Reliability | None = None

    @property
    def reliability(self) -> Reliability:
        """What is expected of the answers."""
        if self.expected is None:
            self.expected = self.evidence.expect(self.question, self.view)
        return self.expected


def expect(doubted: Sequence[Doubted]) -> None:
    """Work out what is expected of the answers to several questions."""
    left = [each for each in doubted if each.expected is None]
    if left:
        told = left[0].evidence.expect_all([(each.question, each.view) for each in left])
        for each, expected in zip(left, told, strict=True):
            each.expected = expected


def saying(doubted: Sequence[Doubted]) -> Iterator[Doubted]:
    """Those whose answers say anything."""
    for begins in range(0, len(doubted), TOGETHER):
        several = doubted[begins : begins + TOGETHER]
        expect(several)
        yield from (each for each in several if says(each.reliability))


def once(doubted: Sequence[Doubted]) -> list[Doubted]:
    """Every fact once: in the words whose answers will settle most."""
    found: dict[str, Doubted] = {}
    for each in doubted:
        known = found.setdefault(each.question.family, each)
        if known is not each and settled(each.reliability) > settled(known.reliability) + EQUAL:
            found[each.question.family] = each
    return list(found.values())


def settled_by(doubted: Sequence[Doubted]) -> float:
    """How far answers in this scene settle what is in doubt."""
    weights = [each.likely * (1 - each.likely) for each in doubted]
    told = [settled(each.reliability) for each in doubted]
    return float(max(sum(map(mul, weights, told)) / sum(weights), EQUAL))


def says(each: Reliability) -> bool:
    """Whether further answers say anything: what was asked often enough in this scene does not."""
    return abs(each.yes_if_true - each.yes_if_false) > SAYING or settled(each) > SAYING
