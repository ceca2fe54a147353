"""What is at stake in questions: what every choice costs where yes is right, and where no is."""

from collections.abc import Sequence

from tpvqa.belief.answers.information import (
    TIMES,
    Floats,
    Reliability,
    gains,
    joint_gains,
    known_gain,
    opened,
)
from tpvqa.belief.deciding.table import Table


class Stakes:
    """What answers can save.

    Args:
        table: What can be done, and what it costs.
        truths: Whether yes is right, shape (questions, states).

    Attributes:
        now: What the best choice is expected to cost.
        likely: Of every question, the probability that yes is right.
    """

    def __init__(self, table: Table, truths: Floats):
        self._truths = truths
        self._weighted = table.weights[:, None] * table.costs
        self._work = table.weights[:, None] * table.work
        self.now = float(table.expected.min())
        self.likely: list[float] = (truths @ table.weights).tolist()
        self._if_true, self._work_if_true = truths @ self._weighted, truths @ self._work
        self._if_false = self._weighted.sum(axis=0) - self._if_true
        self._work_if_false = self._work.sum(axis=1)[:, None] - self._work_if_true

    def of_truth(self) -> list[float]:
        """Of every question, how much it saves to know its answer."""
        known = opened(self._if_true, self._work_if_true).min(axis=1)
        known += opened(self._if_false, self._work_if_false).min(axis=1)
        saved: list[float] = (self.now - known).tolist()
        return saved

    def bounds(self) -> list[float]:
        """Of every question, what its answers may save at most, whatever they open."""
        most = self.now - self._if_true.min(axis=1) - self._if_false.min(axis=1)
        bounds: list[float] = most.tolist()
        return bounds

    def alone(
        self,
        places: Sequence[int],
        reliabilities: Sequence[Reliability],
        times: Sequence[int] = TIMES,
    ) -> list[list[float]]:
        """Of some questions, what so many answers save, each question by itself."""
        told: list[list[float]] = gains(
            self._if_true[places],
            self._if_false[places],
            self._work_if_true[:, places],
            self._work_if_false[:, places],
            reliabilities,
            tuple(times),
        ).tolist()
        return told

    def together(self, places: Sequence[int], reliabilities: Sequence[Reliability]) -> list[float]:
        """What so many answers to each of some questions save, all of them together."""
        truths = self._truths[list(places)]
        told: list[float] = joint_gains(
            self._weighted, self._work, truths, reliabilities, TIMES
        ).tolist()
        return told

    def known(self, places: Sequence[int]) -> float:
        """What it saves to know the answers to all of some questions."""
        return known_gain(self._weighted, self._work, self._truths[list(places)])
