"""How often a VLM says yes where a fact of one predicate holds, and where it does not.

A calibration may be wrong about one predicate alone: yes is said too readily of what lies where.
That shows where answers contradict each other and the actions. So it is learned without any truth,
by what is believed of each fact once a scene is left, as expectation maximisation does for raters
of whom nobody knows when they were right (Dawid and Skene 1979).
"""

from collections.abc import Callable, Mapping
from functools import lru_cache
from math import exp, log

from tpvqa.questions.question import FactQuestion

KNOWN = 20.0
"""Answers about facts that hold, and about such that do not, that the calibration counts for."""
MOST = 2.0
"""Answers that those to one question in one scene count for at most: their errors last."""
KEPT = 200.0
"""Answers that are remembered of a predicate."""
FURTHEST = 2.5
"""By so much, in nats, the odds of a yes may be other than the calibration says."""

Pair = tuple[float, float]
Counts = tuple[float, float, float, float]
"""Yeses and answers where a fact holds, and the same where it does not."""


class Biases:
    """Rates of yes by predicate, under those of the calibration.

    Args:
        told: What was learned before, by predicate.
    """

    def __init__(self, told: Mapping[str, Counts] | None = None):
        self._told: dict[str, Counts] = dict(told or {})
        self._heard: dict[str, tuple[FactQuestion, list[bool]]] = {}

    @property
    def told(self) -> Mapping[str, Counts]:
        """What was learned, by predicate."""
        return self._told

    def hear(self, question: FactQuestion, *, yes: bool) -> None:
        """Note an answer in this scene."""
        self._heard.setdefault(question.text, (question, []))[1].append(yes)

    def leave(self, likely: Callable[[FactQuestion], float]) -> None:
        """Learn from the answers in this scene, which is left.

        Args:
            likely: How probable it is by all that was seen that yes was right.
        """
        for question, answers in self._heard.values():
            true, predicate = likely(question), question.atom.predicate
            each = min(1.0, MOST / len(answers))
            yeses, count = each * sum(answers), each * len(answers)
            added = (true * yeses, true * count, (1 - true) * yeses, (1 - true) * count)
            before = self._told.get(predicate, (0.0, 0.0, 0.0, 0.0))
            after = [a + b for a, b in zip(before, added, strict=True)]
            kept = min(1.0, KEPT / max(after[1] + after[3], 1.0))
            self._told[predicate] = (
                *(kept * after[0], kept * after[1]),
                *(kept * after[2], kept * after[3]),
            )
        self._heard.clear()

    def rates(self, question: FactQuestion, said: Pair) -> Pair:
        """P(yes) where yes is right and where no is.

        Args:
            question: What is asked.
            said: These by the calibration.
        """
        told = self._told.get(question.atom.predicate)
        return said if told is None else _moved(said, told)

    def shift(self, question: FactQuestion, said: Pair, *, yes: bool) -> float:
        """By how much the log likelihood ratio of an answer differs from the calibration's.

        Args:
            question: What was asked.
            said: P(yes) where yes is right and where no is, by the calibration.
            yes: Whether the answer is a yes.
        """
        now = self.rates(question, said)
        return 0.0 if now == said else _ratio(now, yes=yes) - _ratio(said, yes=yes)


def _ratio(rates: Pair, *, yes: bool) -> float:
    true, false = rates if yes else (1 - rates[0], 1 - rates[1])
    return log(max(true, 1e-3) / max(false, 1e-3))


@lru_cache(maxsize=4096)
def _moved(said: Pair, told: Counts) -> Pair:
    """Rates as far apart as before, of which as many yeses are expected as came."""
    true, false = (KNOWN + told[1], KNOWN + told[3])
    came = KNOWN * sum(said) + told[0] + told[2]
    odds = [log(max(each, 1e-3) / max(1 - each, 1e-3)) for each in said]
    low, high = -FURTHEST, FURTHEST
    for _ in range(12):
        middle = (low + high) / 2
        yes = [1 / (1 + exp(-each - middle)) for each in odds]
        if true * yes[0] + false * yes[1] < came:
            low = middle
        else:
            high = middle
    # Rounded, as what is worked out for some rates is kept.
    moved = [1 / (1 + exp(-each - low)) for each in odds]
    return min(max(round(moved[0], 2), 0.01), 0.99), min(max(round(moved[1], 2), 0.01), 0.99)
