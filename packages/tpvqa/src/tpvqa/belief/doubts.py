"""Things that may be elsewhere than the problem says, until they are seen where they should be."""

from collections.abc import Iterator
from random import Random
from typing import NamedTuple

from tpvqa.belief.surprise import Surprise
from tpvqa.pddl import Atom, State, Task


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


class Doubts:
    """How probable it is that things are elsewhere, of those that were not seen yet.

    A belief over joint states would have to hold them all from the start. So each is kept as a
    number until an answer speaks against what is believed of its place; then the belief is told to
    take it in.

    Args:
        task: Says where things are.
        elsewhere: Probability that one is not there, before anything was seen.
    """

    def __init__(self, task: Task, elsewhere: float):
        self._chances = dict.fromkeys(things(task), elsewhere)
        self._things: dict[Atom, list[Thing]] = {}
        for thing in self._chances:
            for atom in thing.places:
                self._things.setdefault(atom, []).append(thing)

    def taken(self, atoms: tuple[Atom, ...], *, held: bool) -> float:
        """The chance that a fact is the other way as its thing was elsewhere all the time.

        It is given once: from then on the belief has it.

        Args:
            atoms: The fact, and others that no answer tells from it.
            held: Whether it is believed to hold.
        """
        none = 1.0
        for thing in {thing for atom in atoms for thing in self._things.get(atom, ())}:
            chance = self._chances.pop(thing, 0.0)
            none *= 1 - (chance if held else chance / (len(thing.places) - 1))
        return 1 - none

    def learn(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> None:
        """Weigh the doubts by an answer about a fact, as Bayes' rule says."""
        for thing in (thing for atom in atoms for thing in self._things.get(atom, ())):
            chance = self._chances.get(thing)
            if chance is not None and thing.stated in atoms:
                there, gone = (1 - chance) * if_true, chance * if_false
                self._chances[thing] = gone / (there + gone) if there + gone else chance


def moved(task: Task, state: State, elsewhere: float, surprise: Surprise, random: Random) -> State:
    """A state in which each thing is elsewhere with a probability, any other place alike."""
    for thing in sorted(things(task), key=lambda each: each.stated):
        if random.random() < elsewhere and thing.stated in state:
            others = surprise.flips(state, (thing.stated,))
            state = random.choice(sorted(others, key=sorted)) if others else state
    return state
