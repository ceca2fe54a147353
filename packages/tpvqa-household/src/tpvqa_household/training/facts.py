"""What pictures show, as a table: pictures × facts."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.pddl import Atom

Facts = Mapping[Atom, tuple[bool, bool]]
"""Of every fact whether it is true and whether the picture shows it."""


@dataclass(frozen=True)
class FactTable:
    """The facts of many pictures.

    Attributes:
        atoms: The facts.
        true: Whether each is true; pictures × atoms.
        visible: Whether each picture shows it; pictures × atoms.
    """

    atoms: tuple[Atom, ...]
    true: NDArray[np.bool_]
    visible: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.true)

    @classmethod
    def of(cls, pictures: Sequence[Facts]) -> "FactTable":
        """Gather the facts of pictures; all must name the same atoms.

        Raises:
            ValueError: They do not.
        """
        atoms = tuple(sorted(pictures[0])) if pictures else ()
        if any(len(facts) != len(atoms) for facts in pictures):
            raise ValueError("the pictures name different facts; gather them separately")
        rows = [[facts[atom] for atom in atoms] for facts in pictures]
        table = np.array(rows, bool).reshape(len(pictures), len(atoms), 2)
        return cls(atoms, table[..., 0], table[..., 1])

    @classmethod
    def joined(cls, tables: Sequence["FactTable"]) -> "FactTable":
        """Several tables below each other.

        Raises:
            ValueError: They name different facts.
        """
        atoms = tables[0].atoms
        if any(table.atoms != atoms for table in tables):
            raise ValueError("the tables name different facts")
        return cls(
            atoms,
            np.concatenate([table.true for table in tables]),
            np.concatenate([table.visible for table in tables]),
        )
