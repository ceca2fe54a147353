"""Where things that can be moved may be."""

from collections.abc import Iterator
from typing import NamedTuple

from tpvqa.pddl import Atom, Task


def further_places(task: Task) -> frozenset[Atom]:
    """Where things may be although no action brings them there: where another thing may be.

    Bread may lie in the fridge as the apple does, although no action puts anything into it.
    """
    can_hold = task.atoms() | task.init
    known = {(atom.predicate, atom.arguments[1:]) for atom in can_hold}
    return frozenset(
        atom
        for thing in things(task)
        for group in task.groups_of(thing.stated)
        if thing.places <= group.atoms
        for atom in group.atoms - can_hold
        if (atom.predicate, atom.arguments[1:]) in known and task.fits(atom)
    )


class Thing(NamedTuple):
    """Something that can be moved.

    Attributes:
        stated: Where the problem says that it is.
        places: All that it can be at or in, that one too: facts of which exactly one holds.
    """

    stated: Atom
    places: frozenset[Atom]


def things(task: Task) -> Iterator[Thing]:
    """The things of a task whose place the problem says and actions change.

    A thing is what the facts of a group speak of first: `(on bread table)`, `(in_hand bread left)`.
    """
    can_hold = task.atoms() | task.init
    for group in task.mutex_groups:
        places = group.atoms & can_hold
        stated = sorted(group.atoms & task.init - task.left_open)
        first = {atom.arguments[:1] for atom in group.atoms}
        if not group.exactly_one or len(first) > 1 or len(places) < 2 or not stated:
            continue
        if len(stated[0].arguments) > 1:
            yield Thing(stated[0], places)
