"""What can happen to a state, in its simplest form."""

from typing import NamedTuple

from tpvqa.pddl import Action, Atom, Condition, Conjunction, Literal, Task, holds, literals


class Transition(NamedTuple):
    """Something that can happen to a state.

    Attributes:
        needed: Atoms that hold before.
        added: Atoms that hold afterwards.
        deleted: Atoms that do not hold afterwards.
        earlier: Atoms that held at some time before, and need not any more.
    """

    needed: frozenset[Atom]
    added: frozenset[Atom]
    deleted: frozenset[Atom]
    earlier: frozenset[Atom] = frozenset()


def of_action(action: Action, task: Task) -> Transition:
    """A superset of what an action can do.

    Negative, disjunctive and derived conditions are taken to hold, conditional effects to add and,
    unless nothing that changes decides it, not to delete.
    """
    known = task.fluents - task.derived
    parts = action.precondition
    conjuncts = parts.parts if isinstance(parts, Conjunction) else (parts,)
    needed = frozenset(
        part.atom
        for part in conjuncts
        if isinstance(part, Literal) and part.positive and part.atom.predicate in known
    )
    added = frozenset(e.literal.atom for e in action.effects if e.literal.positive)
    deleted = frozenset(
        effect.literal.atom
        for effect in action.effects
        if not effect.literal.positive and _always(effect.condition, task)
    )
    return Transition(needed, added, deleted - added)


def _always(condition: Condition, task: Task) -> bool:
    """Whether a condition rests on nothing that changes, and holds."""
    changing = task.fluents | task.derived
    return all(part.atom.predicate not in changing for part in literals(condition)) and holds(
        condition, task.static
    )
