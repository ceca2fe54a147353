"""Of which predicates a VLM says yes too readily, or too rarely.

A calibration may be wrong about one predicate alone: yes is said too readily of what lies where.
That shows where answers contradict each other and the actions. So it is learned without any truth,
by what is believed of each fact once a scene is left, as expectation maximisation does for raters
of whom nobody knows when they were right (Dawid and Skene 1979). It is believed from the next trial
on: one alone is too short to tell it from chance and from errors that last. Only the odds of a yes
are moved; how far yes where a fact holds and yes where it does not lie apart is left as it is: a
belief finds answers right that it rests on.
"""

from collections.abc import Callable, Iterable, Mapping
from math import exp, log, sqrt

from tpvqa.questions.question import FactQuestion

KNOWN = 20.0
"""Answers about facts that hold, and about such that do not, that the calibration counts for."""
FIRST = 2
"""So many answers about one fact in one scene count, the first ones: errors last, and where answers
agree it is asked no further, so that how many came says what they were."""
KEPT = 200.0
"""Answers that are remembered of a predicate."""
CLEAR = 2.0
"""Standard errors by which the yeses that came have to differ from those that were due."""
FURTHEST = 2.5
"""By so much, in nats, the odds of a yes may be other than the calibration says."""
STEP = 0.05
"""They are told to so much, as what is worked out for some rates is kept."""

Pair = tuple[float, float]
Row = tuple[float, float, float, float, float]
"""P(yes) by the calibration where a fact holds and where it does not; and of the answers of which
it said so the yeses, those about facts that hold, and those about such that do not."""


class Biases:
    """By how much the odds of a yes differ from the calibration's, by predicate.

    Args:
        told: What was learned in earlier trials, by predicate: by this it is judged.
    """

    def __init__(self, told: Mapping[str, Iterable[Row]] | None = None):
        self._known = self._told = {name: _kept(rows) for name, rows in (told or {}).items()}
        self._heard: dict[str, tuple[FactQuestion, Pair, list[bool]]] = {}
        self._moved: dict[tuple[str, Pair], float] = {}

    @property
    def told(self) -> Mapping[str, tuple[Row, ...]]:
        """What was learned, by predicate, in this trial, too."""
        return self._told

    def hear(self, question: FactQuestion, said: Pair, *, yes: bool) -> None:
        """Note an answer in this scene.

        Args:
            question: What was asked.
            said: P(yes) where yes is right and where no is, by the calibration.
            yes: Whether it is a yes.
        """
        answers = self._heard.setdefault(question.family, (question, said, []))[2]
        if len(answers) < FIRST and _possible(said):
            answers.append(yes)

    def leave(self, likely: Callable[[FactQuestion], float]) -> None:
        """Learn from the answers in this scene, which is left.

        Args:
            likely: How probable it is by all that was seen that yes was right.
        """
        self._told = dict(self.after(likely).told)
        self._heard.clear()

    def after(self, likely: Callable[[FactQuestion], float]) -> "Biases":
        """What would be known if this scene were left; argument as that of `leave`."""
        found = {predicate: list(rows) for predicate, rows in self._told.items()}
        for question, said, answers in filter(lambda each: each[2], self._heard.values()):
            true, count = likely(question), len(answers)
            row = (*said, float(sum(answers)), true * count, (1 - true) * count)
            found.setdefault(question.atom.predicate, []).append(row)
        return Biases(found)

    def rates(self, question: FactQuestion, said: Pair) -> Pair:
        """P(yes) where yes is right and where no is.

        Args:
            question: What is asked.
            said: These by the calibration.
        """
        moved = self._by(question, said)
        return said if not moved else (_odd(said[0], moved), _odd(said[1], moved))

    def worth(self, question: FactQuestion, said: Pair, ratio: float, *, yes: bool) -> float:
        """The log likelihood ratio of an answer; a yes never speaks for no by it.

        Args:
            question: What was asked.
            said: P(yes) where yes is right and where no is, by the calibration.
            ratio: The log likelihood ratio by the calibration.
            yes: Whether the answer is a yes.
        """
        now = self.rates(question, said)
        if now == said or ratio == 0.0 or (ratio > 0) != yes:
            return ratio
        moved = ratio + _ratio(now, yes=yes) - _ratio(said, yes=yes)
        return max(0.0, moved) if yes else min(0.0, moved)

    def _by(self, question: FactQuestion, said: Pair) -> float:
        predicate = question.atom.predicate
        rows = self._known.get(predicate, ())
        if not rows or question.still_shown or not _possible(said):
            return 0.0
        known = self._moved.get((predicate, said))
        if known is None:
            known = self._moved[predicate, said] = _balanced(rows, said)
        return known


def _possible(said: Pair) -> bool:
    """Whether there are odds to be moved."""
    return all(0 < each < 1 for each in said)


def _balanced(rows: Iterable[Row], said: Pair) -> float:
    """By how much odds have to be moved that as many yeses are expected as came."""
    rows = tuple(rows)
    came = sum(row[2] for row in rows)
    if abs(came - sum(t * a + f * b for a, b, _, t, f in rows)) < CLEAR * _error(rows):
        return 0.0
    rows, came = (*rows, (*said, KNOWN * sum(said), KNOWN, KNOWN)), came + KNOWN * sum(said)
    low, high = -FURTHEST, FURTHEST
    while high - low > STEP / 10:
        middle = (low + high) / 2
        due = sum(t * _odd(a, middle) + f * _odd(b, middle) for a, b, _, t, f in rows)
        low, high = (middle, high) if due < came else (low, middle)
    return STEP * round((low + high) / 2 / STEP)


def _error(rows: Iterable[Row]) -> float:
    """The standard error of how many yeses were due; a fact's answers in one scene are as one."""
    return sqrt(FIRST * sum(t * a * (1 - a) + f * b * (1 - b) for a, b, _, t, f in rows))


def _kept(rows: Iterable[Row]) -> tuple[Row, ...]:
    """Those of the same rates as one, and no more answers than are remembered."""
    found: dict[Pair, list[float]] = {}
    for true, false, *counts in rows:
        known = found.setdefault((true, false), [0.0, 0.0, 0.0])
        known[:] = (a + b for a, b in zip(known, counts, strict=True))
    answers = sum(known[1] + known[2] for known in found.values())
    share = min(1.0, KEPT / max(answers, 1.0))
    return tuple(
        (true, false, share * yeses, share * holding, share * other)
        for (true, false), (yeses, holding, other) in found.items()
    )


def _odd(rate: float, moved: float) -> float:
    rate = min(max(rate, 1e-6), 1 - 1e-6)
    return 1 / (1 + exp(-log(rate / (1 - rate)) - moved))


def _ratio(rates: Pair, *, yes: bool) -> float:
    true, false = rates if yes else (1 - rates[0], 1 - rates[1])
    return log(true / false)
