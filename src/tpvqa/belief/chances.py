"""How often actions fail: Beta distributions that learn from what came of actions."""

from collections.abc import Mapping
from dataclasses import dataclass

from tpvqa.belief.faults import Rates


@dataclass(slots=True)
class Beta:
    """A Beta distribution: what is known of a probability.

    Attributes:
        yes: Cases for, prior ones included.
        no: Cases against.
    """

    yes: float
    no: float

    @property
    def mean(self) -> float:
        """The expected probability."""
        return self.yes / (self.yes + self.no)


class Chances:
    """The rates of faults, learned while running from expected numbers of cases.

    Args:
        rates: What is believed beforehand.
        strength: How many cases that is worth.
    """

    def __init__(self, rates: Rates | None = None, strength: float = 12.0):
        rates = rates or Rates()
        self.failure = Beta(rates.failure * strength, (1 - rates.failure) * strength)
        self.disturbance = Beta(rates.disturbance * strength, (1 - rates.disturbance) * strength)
        self.spontaneous = rates.spontaneous

    @property
    def rates(self) -> Rates:
        """The expected rates."""
        return Rates(self.failure.mean, self.disturbance.mean, self.spontaneous)

    def learn(self, shares: Mapping[str, float]) -> None:
        """Learn from how an action came out, see `Belief.outcome_shares`."""
        self.failure.yes += shares.get("failure", 0.0)
        self.failure.no += shares.get("success", 0.0)
        self.disturbance.yes += shares.get("disturbed", 0.0)
        self.disturbance.no += shares.get("undisturbed", 0.0)
