"""The choices with what each is expected to cost."""

from dataclasses import dataclass

import numpy as np

from tpvqa.belief.answers.information import Floats, opened
from tpvqa.pddl import Action, State


@dataclass(frozen=True, slots=True)
class Choice:
    """Something that can be done now.

    Attributes:
        action: The action to execute; None to end the trial here.
        state: The most probable joint state in which this is the step to take.
    """

    action: Action | None
    state: State


@dataclass(frozen=True, slots=True)
class Table:
    """The choices with their costs.

    Attributes:
        choices: What can be done.
        numbers: The joint states.
        weights: Their probabilities, shape (states,).
        costs: Expected cost of each choice in each joint state, shape (states, choices).
        work: What each choice has to do there, by what makes it worth being one, shape (limits,
            states, choices): where any is expected to be negative, it is closed. An answer may
            open it.
    """

    choices: tuple[Choice, ...]
    numbers: tuple[int, ...]
    weights: Floats
    costs: Floats
    work: Floats

    @property
    def expected(self) -> Floats:
        """The expected cost of every choice, shape (choices,); of closed ones infinite."""
        return opened(self.weights @ self.costs, self.weights @ self.work)

    @property
    def best(self) -> Choice:
        """The choice that is expected to cost least; of equal ones the first."""
        return self.choices[self._place]

    @property
    def _place(self) -> int:
        return int(np.argmin(np.round(self.expected, 9)))

    def mistaken(self, by: float) -> float:
        """The probability that another choice than the best one costs less by so much."""
        least = self.costs.min(axis=1)
        return float(self.weights @ (self.costs[:, self._place] > least + by))
