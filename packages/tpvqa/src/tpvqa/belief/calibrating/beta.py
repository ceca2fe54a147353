"""What is known of a probability: a Beta distribution that learns from cases."""

from dataclasses import dataclass


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

    def learn(self, yes: float, no: float) -> None:
        """Take in a case of which it is only probable how it came out.

        What is known then is a mixture of Beta distributions; the one of the same mean and
        variance takes its place. A case about which nothing was seen teaches nothing.

        Args:
            yes: Probability that it was a case for.
            no: Probability that it was one against; with `yes` at most 1, the rest is no case.
        """
        a, b = self.yes, self.no
        n = a + b
        if yes + no <= 1e-9 or a <= 0 or b <= 0:
            return
        rest = max(0.0, 1 - yes - no)
        mean = rest * a / n + (yes * (a + 1) + no * a) / (n + 1)
        square = rest * a * (a + 1) / (n * (n + 1)) + (
            yes * (a + 1) * (a + 2) + no * a * (a + 1)
        ) / ((n + 1) * (n + 2))
        variance = square - mean * mean
        if variance <= 1e-15 or not 0 < mean < 1:
            return
        cases = max(mean * (1 - mean) / variance - 1, 1e-3)
        self.yes, self.no = mean * cases, (1 - mean) * cases
