"""What looking at another scene may come to, before an action: how much of the doubt it settles."""

from collections.abc import Iterable
from dataclasses import dataclass

from tpvqa.belief.information import Reliability, answers_to_know, settled

DOUBTED = 0.01
"""A fact whose probability times its contrary's is less is in no doubt."""
SETTLED = 0.97
"""Where answers settle so much, what follows an action is taken to be seen."""


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
        doubt: How much is in doubt: the variances of the facts, together.
    """

    share: float = 1.0
    answers: float = 0.0
    doubt: float = 0.0

    @staticmethod
    def of(facts: Iterable[tuple[float, Reliability]], new: Reliability) -> "Settling":
        """Of some facts.

        Args:
            facts: Their probabilities, and what is expected of answers about them.
            new: What is expected where nothing is in doubt.
        """
        doubts = [each for each in facts if in_doubt(each[0])]
        weights = [likely * (1 - likely) for likely, _ in doubts]
        if not doubts:
            return Settling(settled(new), 0.0)
        told = sum(w * settled(each) for w, (_, each) in zip(weights, doubts, strict=True))
        answers = sum(answers_to_know(likely, DOUBTED, each) for likely, each in doubts)
        return Settling(told / sum(weights), answers, sum(weights))


@dataclass(slots=True)
class Settlings:
    """How far doubts were settled until now, where that is less than it may be thought.

    What is not worth asking now will not be worth it later. So how far answers are expected to
    settle what is in doubt counts as often as they have.

    Attributes:
        expected: After how many actions what has come of it counts as much as what is expected.
    """

    expected: float = 3.0
    _settled: float = 0.0
    _left: float = 0.0
    _first: float | None = None
    _last: float = 0.0

    def taken(self, found: Settling) -> float:
        """How far answers can be expected to settle what is in doubt."""
        if self._first is None:
            self._first = found.doubt
        self._last = found.doubt
        if found.share >= SETTLED:
            return found.share
        so_far = self.expected + self._settled
        return found.share * so_far / (so_far + self._left)

    def acted(self) -> None:
        """Note that there is an action: what is in doubt still was not settled."""
        if self._first:
            left = min(self._last / self._first, 1.0)
            self._left += left
            self._settled += 1 - left
        self._first = None
