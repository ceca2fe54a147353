"""What a task is made of once its variables are gone."""

from dataclasses import dataclass

from tpvqa.pddl.atoms import Atom, Literal
from tpvqa.pddl.conditions import Condition


@dataclass(frozen=True, slots=True)
class Effect:
    """A literal that becomes true, if its condition held before."""

    condition: Condition
    literal: Literal


@dataclass(frozen=True, slots=True)
class Action:
    """A ground action as its author wrote it."""

    name: str
    arguments: tuple[str, ...]
    precondition: Condition
    effects: tuple[Effect, ...]
    cost: int = 1

    def __hash__(self) -> int:
        return hash((self.name, self.arguments))  # of a task, these tell it from all others

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.arguments)})"

    def pddl(self) -> str:
        """As a plan file writes it, e.g. `(pick_up plate table left)`."""
        return f"({' '.join((self.name, *self.arguments))})"


@dataclass(frozen=True, slots=True)
class MutexGroup:
    """Atoms of which at most one holds, or exactly one."""

    atoms: frozenset[Atom]
    exactly_one: bool
