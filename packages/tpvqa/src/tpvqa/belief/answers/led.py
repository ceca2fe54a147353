"""Where joint states have led: what is known along the way goes with them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.lasting import EVERY, Columns

Places = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Led:
    """Where an action has led from and to, with all that is told apart of the VLM's noise.

    Attributes:
        before: The numbers of the joint states before it.
        after: Those after it.
        begun: Of each way the place of the joint state before it; ways to the same one after it
            follow one another.
        came: The same of those after.
        same: Whether a way has changed nothing.
        weights: How probable it is to have come each way.
        shares: How probable it is to have come each way (rows), for everything told apart.
        mixed: What is believed of the noise in the joint states after it (rows).
        columns: Which of all that is told apart they are.
    """

    before: tuple[int, ...]
    after: tuple[int, ...]
    begun: Places
    came: Places
    same: NDArray[np.bool_]
    weights: Floats
    shares: Floats
    mixed: Floats
    _first: Places
    columns: Columns = field(default_factory=lambda: EVERY)

    @staticmethod
    def of(
        led: Sequence[tuple[int, int, float]],
        after: Mapping[int, float],
        noise: Mapping[int, Floats],
        scenes: Mapping[int, int],
        columns: Columns = EVERY,
    ) -> "Led":
        """Of single ways.

        Args:
            led: From where to where, with which weight.
            after: All weight of each joint state after the action; ways to others are left out.
            noise: What was believed of the noise in each before it.
            scenes: What tells scenes apart, of each.
            columns: Which of all that is told apart of the noise these are.
        """
        ways = [way for way in led if way[2] > 0 and way[1] in after]
        before = tuple(dict.fromkeys(old for old, _, _ in ways))
        reached = tuple(dict.fromkeys(new for _, new, _ in ways))
        places = {number: place for place, number in enumerate(before)}
        rows = {number: place for place, number in enumerate(reached)}
        ways.sort(key=lambda way: rows[way[1]])
        begun = np.array([places[old] for old, _, _ in ways])
        came = np.array([rows[new] for _, new, _ in ways])
        same = np.array([scenes[old] == scenes[new] for old, new, _ in ways])
        first = np.flatnonzero(np.diff(came, prepend=-1))
        weights = np.array([weight for _, _, weight in ways])
        weights /= np.add.reduceat(weights, first)[came]
        masses = weights[:, None] * np.stack([noise[number] for number in before])[begun]
        mixed = np.add.reduceat(masses, first)
        shares = masses / np.maximum(mixed, 1e-300)[came]
        return Led(before, reached, begun, came, same, weights, shares, mixed, first, columns)

    def told_apart(self, columns: Columns, taken: Places) -> "Led":
        """The same by other columns.

        Args:
            columns: They.
            taken: Of each the place of the one whose part it takes.
        """
        shares, mixed = self.shares[:, taken], self.mixed[:, taken]
        return replace(self, shares=shares, mixed=mixed, columns=columns)

    def carried(self, known: Floats) -> Floats:
        """What is known after it of something that is known of each way (rows)."""
        found: Floats = np.add.reduceat(self.shares * known, self._first)
        return found

    def averaged(self, known: Floats) -> Floats:
        """The same of what is one number for each way (last axis), whatever the noise."""
        found: Floats = np.add.reduceat(self.weights * known, self._first, axis=-1)
        return found
