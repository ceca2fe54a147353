"""What answers weigh."""

from collections.abc import Callable, Iterable
from typing import Protocol

from tpvqa.belief.answers.information import Floats
from tpvqa.pddl import Atom

Instead = Callable[[int, int], Floats | None]
"""The logarithm of how many times as probable what was said in this scene is in the second of two
joint states, by their numbers, for everything that is told apart of the noise; None for as
probable."""


class Weighed(Protocol):
    """What answers weigh: a belief, or what was believed before anything was done."""

    def probability(self, atom: Atom, alike: Iterable[Atom] = ()) -> float:
        """The probability of a fact, or of it or any fact alike."""

    def see(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> float:
        """Weigh by an answer about a fact (or any of several alike)."""

    def open(self, atoms: tuple[Atom, ...], chance: float, instead: Instead | None = None) -> int:
        """Take in that a fact may have changed without the action model knowing."""
