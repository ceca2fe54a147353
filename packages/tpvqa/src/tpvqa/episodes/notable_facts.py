"""Which facts of a belief a reader should see: those in doubt, and those that have changed."""

from collections.abc import Mapping
from dataclasses import dataclass

DOUBT = 0.02
"""A fact is in doubt where its probability is further than this from 0 and from 1."""
CHANGE = 0.05
"""A change of probability that is shown although the fact is not in doubt."""
MOST = 6
"""Facts that are shown at one decision, at most."""


@dataclass(frozen=True, slots=True)
class FactNow:
    """What is believed of a fact, and what was before.

    Attributes:
        fact: The atom as PDDL.
        p: Its probability.
        before: Its probability when it was last told; None where it never was.
    """

    fact: str
    p: float
    before: float | None = None

    @property
    def change(self) -> float:
        """By how much the probability has changed; 0 where there was none before."""
        return 0.0 if self.before is None else self.p - self.before

    @property
    def arrow(self) -> str:
        """The change as ▲.22 or ▼.22; empty where there is none."""
        if abs(self.change) < 0.005:
            return ""
        return ("▲" if self.change > 0 else "▼") + f"{abs(self.change):.2f}".removeprefix("0")


def in_doubt(p: float) -> bool:
    """Whether a probability leaves a doubt."""
    return DOUBT < p < 1 - DOUBT


def notable(belief: Mapping[str, float], before: Mapping[str, float]) -> list[FactNow]:
    """The facts that matter most now, the most doubtful or most changed one first.

    Args:
        belief: Probabilities of facts.
        before: What the reader was told of them before.
    """
    facts = [FactNow(fact, p, before.get(fact)) for fact, p in belief.items()]
    shown = [each for each in facts if in_doubt(each.p) or abs(each.change) >= CHANGE]
    return sorted(shown, key=_weight, reverse=True)[:MOST]


def probability(p: float) -> str:
    """A probability in two digits, never called certain.

    >>> probability(0.847), probability(0.999), probability(0.0)
    ('.85', '>.99', '<.01')
    """
    if p >= 0.995:
        return ">.99"
    return "<.01" if p < 0.005 else f"{p:.2f}"[1:]


def _weight(fact: FactNow) -> float:
    return max(abs(fact.change), 1 - abs(2 * fact.p - 1))
