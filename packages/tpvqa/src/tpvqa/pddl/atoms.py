"""Ground facts: tuples, as millions of them are hashed and compared in a long trial."""

from typing import NamedTuple


class Atom(NamedTuple):
    """A ground atom such as in_hand(plate, left). Names are lower case, as PDDL's are."""

    predicate: str
    arguments: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.predicate}({', '.join(self.arguments)})"

    def pddl(self) -> str:
        """The atom as PDDL writes it, e.g. `(in_hand plate left)`."""
        return f"({' '.join((self.predicate, *self.arguments))})"

    @staticmethod
    def parse(text: str) -> "Atom":
        """Read `(on apple table)`, `on(apple, table)` or `on apple table`.

        Raises:
            ValueError: The text is not an atom.
        """
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

    def negate(self) -> "Literal":
        """The opposite literal."""
        return Literal(self.atom, not self.positive)

    def holds(self, state: "State") -> bool:
        """Whether it holds in a state under the closed world."""
        return (self.atom in state) == self.positive


State = frozenset[Atom]
"""The atoms that hold; all others do not (closed world). Derived atoms are not in it: see
`Task.extend`."""
