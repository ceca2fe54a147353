"""What a task is made of once its variables are gone."""

from dataclasses import dataclass

from tpvqa.pddl.arithmetic import Expression, Words
from tpvqa.pddl.atoms import Atom, Literal
from tpvqa.pddl.conditions import Condition


@dataclass(frozen=True, slots=True)
class Effect:
    """A literal that becomes true, if its condition held before."""

    condition: Condition
    literal: Literal


@dataclass(frozen=True, slots=True)
class Change:
    """What becomes of a number, if a condition held before.

    Attributes:
        condition: The condition.
        kind: "increase", "decrease", "assign", "scale-up" or "scale-down".
        function: The function with its arguments.
        by: By how much, or to what.
    """

    condition: Condition
    kind: str
    function: Words
    by: Expression


@dataclass(frozen=True, slots=True)
class Action:
    """A ground action as its author wrote it."""

    name: str
    arguments: tuple[str, ...]
    precondition: Condition
    effects: tuple[Effect, ...]
    cost: int = 1
    changes: tuple[Change, ...] = ()

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
