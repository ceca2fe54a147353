"""Actions as masks of bits: whether one can be done, and what it changes, in a few operations."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from tpvqa.pddl import Action, Atom, Conjunction, Literal, State, Task
from tpvqa.pddl.conditions import Condition


@dataclass(frozen=True, slots=True)
class Compiled:
    """An action whose precondition is a conjunction and whose effects have no conditions.

    Attributes:
        added: What it makes true.
        deleted: What it makes false.
        fixed: Facts that no action changes, which have to hold.
        add: What it makes true, as bits.
        delete: What it makes false, as bits.
        need: What has to hold, as bits.
        bar: What must not hold, as bits.
    """

    added: State
    deleted: State
    fixed: State
    add: int
    delete: int
    need: int
    bar: int

    def achieved(self, holding: int) -> bool:
        """Whether nothing is left to do where some facts hold."""
        return not (self.add & ~holding or self.delete & holding)

    def possible(self, holding: int, state: State) -> bool:
        """Whether the precondition holds."""
        return not (self.need & ~holding or self.bar & holding) and self.fixed <= state


def met(
    condition: Condition, task: Task, bits: Callable[[Iterable[Atom]], int]
) -> tuple[int, int] | None:
    """What has to hold for a condition, and what must not, as bits; None where it is no
    conjunction of facts that actions change."""
    parts = _parts(condition)
    if parts is None or any(each.atom.predicate not in task.fluents for each in parts):
        return None
    needed = bits(each.atom for each in parts if each.positive)
    return needed, bits(each.atom for each in parts if not each.positive)


def compiled(action: Action, task: Task, bits: Callable[[Iterable[Atom]], int]) -> Compiled | None:
    """An action as masks; None where it takes more than that to say what it does.

    Args:
        action: The action.
        task: Says which facts actions change.
        bits: Facts as bits.
    """
    needed = _parts(action.precondition)
    if needed is None or any(_parts(effect.condition) != [] for effect in action.effects):
        return None
    fixed = [each for each in needed if each.atom.predicate not in task.fluents]
    if any(each.atom.predicate in task.derived or not each.positive for each in fixed):
        return None
    changing = [each for each in needed if each.atom.predicate in task.fluents]
    added = frozenset(each.literal.atom for each in action.effects if each.literal.positive)
    deleted = frozenset(each.literal.atom for each in action.effects) - added
    return Compiled(
        added,
        deleted,
        frozenset(each.atom for each in fixed),
        bits(added),
        bits(deleted),
        bits(each.atom for each in changing if each.positive),
        bits(each.atom for each in changing if not each.positive),
    )


def _parts(condition: Condition) -> list[Literal] | None:
    """The literals of a conjunction; None where it is something else."""
    if isinstance(condition, Literal):
        return [condition]
    if not isinstance(condition, Conjunction):
        return None
    found: list[Literal] = []
    for part in condition.parts:
        literals = _parts(part)
        if literals is None:
            return None
        found += literals
    return found
