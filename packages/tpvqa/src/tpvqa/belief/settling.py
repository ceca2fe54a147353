"""What looking at another scene may come to, before an action: how much of the doubt it settles."""

from collections.abc import Iterable
from dataclasses import dataclass

from tpvqa.belief.information import Reliability, answers_to_know, settled

DOUBTED = 0.01
"""A fact whose probability times its contrary's is less is in no doubt."""


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
    """

    share: float = 1.0
    answers: float = 0.0

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
        return Settling(told / sum(weights), answers)
