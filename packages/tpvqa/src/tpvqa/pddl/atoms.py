"""Ground facts: tuples, as millions of them are hashed and compared in a long trial."""

from contextlib import suppress
from typing import NamedTuple

from tpvqa.pddl.arithmetic import (
    ARITHMETIC,
    COMPARISONS,
    VALUE,
    compares,
    number,
    of_several,
    parsed,
    text_of,
    written,
)


class Atom(NamedTuple):
    """A ground atom such as in_hand(plate, left). Names are lower case, as PDDL's are."""

    predicate: str
    arguments: tuple[str, ...] = ()

    def __str__(self) -> str:
        if self.predicate in COMPARISONS and self.arguments:
            *about, number = self.arguments
            said = about[0] if len(about) == 1 else f"{about[0]}({', '.join(about[1:])})"
            return f"{said} {self.predicate} {number}"
        return f"{self.predicate}({', '.join(self.arguments)})"

    def pddl(self) -> str:
        """The atom as PDDL writes it, e.g. `(in_hand plate left)` or `(>= (battery robot) 20)`."""
        if self.predicate in COMPARISONS and self.arguments:
            *about, number = self.arguments
            said = about[0] if of_several(self.arguments) else f"({' '.join(about)})"
            return f"({self.predicate} {said} {number})"
        return f"({' '.join((self.predicate, *self.arguments))})"

    @staticmethod
    def parse(text: str) -> "Atom":
        """Read `(on apple table)`, `on(apple, table)`, `on apple table` or `(= (battery r) 60)`.

        Raises:
            ValueError: The text is not an atom.
        """
        if text.lstrip(" (").split(" ", 1)[0] in COMPARISONS:
            return _comparison(text.lower())
        words = text.lower().replace("(", " ").replace(")", " ").replace(",", " ").split()
        if not words:
            raise ValueError(f"{text!r} is not an atom; write it as (predicate object …)")
        return Atom(words[0], tuple(words[1:]))


class Literal(NamedTuple):
    """An atom or its negation."""

    atom: Atom
    positive: bool = True

    def __str__(self) -> str:
        return str(self.atom) if self.positive else f"not {self.atom}"

    def pddl(self) -> str:
        """The literal as PDDL writes it, e.g. `(not (on apple table))`."""
        return self.atom.pddl() if self.positive else f"(not {self.atom.pddl()})"

    def negate(self) -> "Literal":
        """The opposite literal."""
        return Literal(self.atom, not self.positive)

    def holds(self, state: "State") -> bool:
        """Whether it holds in a state under the closed world."""
        return holds_in(self.atom, state) == self.positive


def holds_in(atom: Atom, state: "State") -> bool:
    """Whether an atom is one of a state's, or a comparison that its values bear out."""
    if atom.predicate in COMPARISONS and (atom.predicate != VALUE or of_several(atom.arguments)):
        return compares(atom.predicate, atom.arguments, state)
    return atom in state


def _comparison(text: str) -> Atom:
    found = parsed(text)
    comparison, *two = found if isinstance(found, tuple) else ("",)
    if (
        not isinstance(comparison, str)
        or len(two) != 2
        or not any(isinstance(x, tuple) for x in two)
    ):
        raise ValueError(f"{text!r} compares no number; write it as (>= (battery r) 20)")
    left, right = two
    if isinstance(left, tuple) and isinstance(right, str) and left[0] not in ARITHMETIC:
        with suppress(ValueError):  # what is no number is told by who knows the task
            right = written(number(right))  # as values are written: 60.0 is 60
        return Atom(comparison, (*map(str, left), right))
    return Atom(comparison, (text_of(left), text_of(right)))


State = frozenset[Atom]
"""The atoms that hold; all others do not (closed world). Derived atoms are not in it: see
`Task.extend`."""
