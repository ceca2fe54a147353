"""Things that may be elsewhere than the problem says, until they are seen where they should be."""

from random import Random

from tpvqa.belief.states.places import Thing, things
from tpvqa.belief.states.surprise import Surprise
from tpvqa.pddl import Atom, State, Task

ELSEWHERE = 0.02
"""Chance that a thing that can be moved is not where the problem says."""


class Doubts:
    """How probable it is that things are elsewhere, of those that were not seen yet.

    A belief over joint states would have to hold them all from the start. So each is kept as a
    number until an answer speaks against what is believed of its place; then the belief is told to
    take it in.

    Args:
        task: Says where things are.
        elsewhere: Probability that one is not there, before anything was seen; None for the usual.
    """

    def __init__(self, task: Task, elsewhere: float | None = None):
        chance = ELSEWHERE if elsewhere is None else elsewhere
        self._chances = dict.fromkeys(things(task), chance)
        self._learnt: dict[Thing, float] = {}
        self._things: dict[Atom, list[Thing]] = {}
        for thing in self._chances:
            for atom in thing.places:
                self._things.setdefault(atom, []).append(thing)

    def of(self, atoms: tuple[Atom, ...], *, held: bool) -> float:
        """The chance that a fact is the other way as its thing was elsewhere all the time.

        Args:
            atoms: The fact, and others that no answer tells from it.
            held: Whether it is believed to hold.
        """
        none = 1.0
        for thing in {thing for atom in atoms for thing in self._things.get(atom, ())}:
            chance = self._chances.get(thing, 0.0)
            none *= 1 - (chance if held else chance / (len(thing.places) - 1))
        return 1 - none

    def gone(self, atom: Atom) -> float:
        """The chance that a thing which the problem says to be here never was."""
        there = (each for each in self._things.get(atom, ()) if each.stated == atom)
        return sum(self._chances.get(thing, 0.0) for thing in there)

    def give(self, atoms: tuple[Atom, ...]) -> None:
        """Leave the doubts about some facts to the belief, which has them from now on."""
        for thing in (thing for atom in atoms for thing in self._things.get(atom, ())):
            self._chances.pop(thing, None)

    def learn(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> None:
        """Weigh the doubts by an answer about a fact, as Bayes' rule says, from the next scene on:
        what was said in this one the belief weighs itself where it takes a doubt in."""
        for thing in (thing for atom in atoms for thing in self._things.get(atom, ())):
            if thing in self._chances and thing.stated in atoms:
                chance = self._learnt.get(thing, self._chances[thing])
                there, gone = (1 - chance) * if_true, chance * if_false
                self._learnt[thing] = gone / (there + gone) if there + gone else chance

    def leave(self) -> None:
        """Note that another scene comes."""
        self._chances |= {t: learnt for t, learnt in self._learnt.items() if t in self._chances}
        self._learnt.clear()


def moved(task: Task, state: State, elsewhere: float, surprise: Surprise, random: Random) -> State:
    """A state in which each thing is elsewhere with a probability, any other place alike."""
    for thing in sorted(things(task), key=lambda each: each.stated):
        if random.random() < elsewhere and thing.stated in state:
            others = surprise.flips(state, (thing.stated,))
            state = random.choice(sorted(others, key=sorted)) if others else state
    return state
