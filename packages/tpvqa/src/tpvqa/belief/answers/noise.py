"""What is believed of a VLM's noise in every joint state."""

from collections.abc import Mapping

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.led import Places
from tpvqa.belief.answers.told_apart import ToldApart

NEVER = 1e-12
"""Nothing that is told apart of a VLM's noise is less probable, so that it can be learnt of."""


class JointNoise:
    """Probabilities of what is told apart of the noise, by the number of a joint state.

    Attributes:
        told: Columns of all that is told apart, those that are kept in joint states.
        apart: How these stand for the others; None where there are none.
    """

    def __init__(self) -> None:
        self.told: Places = np.arange(1)
        self.apart: ToldApart | None = None
        self._left_out: Floats = np.zeros(1)
        self._unaware: Floats = np.ones(1)
        self._numbers: tuple[int, ...] = ()
        self._places: dict[int, int] = {}
        self._rows: Floats = np.ones((0, 1))

    def suppose(self, noise: Floats) -> None:
        """Begin anew with the same in every joint state.

        Args:
            noise: Probabilities of all that is told apart.
        """
        if len(noise) != len(self._left_out):
            self.told, self.apart = np.arange(len(noise)), None
        self._leave_out(noise)
        kept = noise[self.told]
        self._unaware = kept if self.apart is None else kept / kept.sum()
        self.take((), np.ones((0, len(kept))))

    def take(self, numbers: tuple[int, ...], rows: Floats) -> None:
        """Take over what is believed in joint states; in others it is what it was at first."""
        self._numbers, self._rows = numbers, rows
        self._places = {number: place for place, number in enumerate(numbers)}

    def rows(self, numbers: tuple[int, ...]) -> Floats:
        """What is believed in some joint states, shape (joint states, columns)."""
        if numbers == self._numbers:
            return self._rows
        places = np.array([self._places.get(number, -1) for number in numbers], np.intp)
        found: Floats = np.concatenate([self._rows, self._unaware[None]])[places]
        return found

    def keep(self, numbers: tuple[int, ...]) -> None:
        """Forget all joint states but some."""
        if numbers != self._numbers:
            self.take(numbers, self.rows(numbers))

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states, by their old ones."""
        self.take(tuple(numbers.values()), self.rows(tuple(numbers)))

    def mix(self, into: int, weight: float, more: Floats, share: float) -> None:
        """Take into a joint state what is believed in another.

        Args:
            into: The number of the one that takes it.
            weight: What that one weighs.
            more: What is believed in the other.
            share: What comes, in weight.
        """
        own = self.rows((into,))[0]
        row = ((weight * own + share * more) / (weight + share))[None]
        kept = tuple(number for number in self._numbers if number != into)
        self.take((*kept, into), np.concatenate([self.rows(kept), row]))

    def whole(self, masses: Floats) -> Floats:
        """Probabilities of all that is told apart.

        Args:
            masses: Those of the joint states, each with what is kept.
        """
        found: Floats = masses.sum(axis=0)
        if self.apart is None:
            return found
        kept, found = found, self._left_out.copy()
        found[self.told] = kept * (1 - self._left_out.sum())
        return found

    def answered(self, left_out: Floats, kept: float) -> None:
        """Weigh what is left out by an answer.

        Args:
            left_out: The answer's probability with each of what is.
            kept: The same with what is kept.
        """
        assert self.apart is not None
        rest = self._left_out[self.apart.rest]
        kept, rest = kept * (1 - rest.sum()), rest * left_out
        self._left_out[self.apart.rest] = np.maximum(rest / (rest.sum() + kept), NEVER)

    def tell_apart(self, apart: ToldApart, masses: Floats) -> None:
        """Go on with other columns of all that is told apart.

        Args:
            apart: Which.
            masses: As those of `whole`.
        """
        noise, kept = self.whole(masses), masses.sum(axis=0)[apart.taken]
        rows = np.concatenate([self._rows, self._unaware[None]])[:, apart.taken]
        rows = rows * (noise[apart.columns] / np.maximum(kept, 1e-300))
        rows /= rows.sum(axis=1, keepdims=True)
        self.told, self.apart = apart.columns, apart
        self._leave_out(noise)
        self._unaware = rows[-1]
        self.take(self._numbers, rows[:-1])

    def _leave_out(self, noise: Floats) -> None:
        self._left_out = noise.copy()
        self._left_out[self.told] = 0.0
