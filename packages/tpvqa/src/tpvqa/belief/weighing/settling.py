"""What looking at another scene may come to, before an action: how much of the doubt it settles."""

from collections.abc import Container, Mapping
from dataclasses import dataclass, field

from tpvqa.belief.answers.information import Reliability, answers_to_know, settled

DOUBTED = 0.01
"""A fact whose probability times its contrary's is less is in no doubt."""
ABLE = 0.5
"""Where answers settle so much of a doubt, it is for later when it was not asked about."""
FIRST = 3.0
"""After how many actions what has come of answers counts as much as what is expected of them …"""
PART = 0.125
"""… or after this part of a task's steps, where that is more: it would be done unseen otherwise,
which in a long task leads nowhere."""
IN_VAIN = 2.0
"""How many times the steps of a task may be done in vain."""
WHOLE = 0.25
"""The variance of a fact of which nothing is known."""
SETTLED = 0.97
"""Where answers settle so much, what follows an action is taken to be seen."""
LONG = 14
"""In tasks of more steps many doubts wait for the step that needs them, and are none in vain …"""
MOSTLY = 0.8
"""… so that what came of answers counts the less there the more they settle from here on."""

Doubt = tuple[float, float]
"""The variance of a fact, and how far answers settle it."""


def in_doubt(likely: float) -> bool:
    """Whether a fact is in doubt."""
    return likely * (1 - likely) >= DOUBTED


@dataclass(frozen=True, slots=True)
class Settling:
    """What looking may come to.

    Attributes:
        share: How far answers settle the doubts there are: 1 where they do, 0 where they would say
            nothing, as they are worth nothing or only say the same again.
        answers: How many that takes.
        doubts: What is in doubt, by question.
        new: How far answers would settle a doubt that was never asked about.
    """

    share: float = 1.0
    answers: float = 0.0
    doubts: Mapping[str, Doubt] = field(default_factory=dict)
    new: float = 1.0

    @staticmethod
    def of(facts: Mapping[str, tuple[float, Reliability]], new: Reliability) -> "Settling":
        """Of some facts.

        Args:
            facts: Their probabilities, and what is expected of answers about them, by question.
            new: What is expected where nothing is in doubt.
        """
        known = {name: each for name, each in facts.items() if in_doubt(each[0])}
        doubts = {
            name: (likely * (1 - likely), settled(each)) for name, (likely, each) in known.items()
        }
        if not doubts:
            return Settling(settled(new), new=settled(new))
        told = sum(variance * share for variance, share in doubts.values())
        answers = sum(answers_to_know(likely, DOUBTED, each) for likely, each in known.values())
        share = told / sum(variance for variance, _ in doubts.values())
        return Settling(share, answers, doubts, settled(new))


@dataclass(slots=True)
class Settlings:
    """How far doubts were settled until now, where that is less than it may be thought.

    What is not worth asking now will not be worth it later. So how far answers are expected to
    settle what is in doubt counts as often as they have: a doubt that could be settled and was not
    asked about is for later, and counts for nothing. And it counts less the more was done that
    brought the goal no nearer.

    Attributes:
        dearer: How many times its price a question has to be worth, as more is expected of answers
            than came of them: the root of how many times as much.
    """

    dearer: float = 1.0
    _settled: float = 0.0
    _left: float = 0.0
    _acted: int = 0
    _whole: int = 1
    _first: Mapping[str, Doubt] | None = None
    _last: Mapping[str, Doubt] = field(default_factory=dict)

    def taken(self, found: Settling, ahead: int) -> float:
        """How far answers can be expected to settle what is in doubt.

        Args:
            found: What looking may come to.
            ahead: How many steps the goal is away.
        """
        self._first = found.doubts if self._first is None else self._first
        self._whole = max(self._whole, ahead)
        self._last = found.doubts
        self.dearer = 1.0
        if found.share >= SETTLED:
            return found.share
        so_far = max(FIRST, PART * self._whole) + self._settled
        kept = self._nearer(ahead) * so_far / (so_far + self._left)
        if self._whole > LONG:
            kept += (1 - kept) * max(0.0, found.share - MOSTLY) / (SETTLED - MOSTLY)
        self.dearer = kept**-0.5
        return found.share * kept

    def _nearer(self, ahead: int) -> float:
        """How far what was done has brought the goal nearer."""
        allowed, nearer = IN_VAIN * self._whole, min(self._whole - ahead, self._acted)
        return (allowed + nearer) / (allowed + self._acted)

    def acted(self, asked: Container[str]) -> None:
        """Note that there is an action: what is in doubt still was not settled.

        Args:
            asked: The questions that were asked since the last one.
        """
        self._acted += 1
        first, last = self._first or {}, self._last
        tried = [
            name for name, each in {**first, **last}.items() if name in asked or each[1] < ABLE
        ]
        was, left = (sum(each[name][0] for name in tried if name in each) for each in (first, last))
        whole = max(was, WHOLE)
        self._left += min(left / whole, 1.0)
        self._settled += max(was - left, 0.0) / whole
        self._first = None
