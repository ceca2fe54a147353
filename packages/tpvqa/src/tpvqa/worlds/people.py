"""People who move things while the robot works."""

from collections.abc import Iterator
from functools import lru_cache
from random import Random

from tpvqa.pddl import Atom, State, Task
from tpvqa.worlds.elsewhere import elsewhere_of, places_of


def somebody_moves(task: Task, state: State, draw: Random) -> tuple[Atom, State] | None:
    """Puts one thing where another fact of its place can be, as `--elsewhere` does at first.

    Nobody touches what is held, what something lies on, and what else the robot is at: what a true
    fact of another exactly-one group is about, such as `(near apple)`.

    Args:
        task: Gives the groups.
        state: The true one.
        draw: Decides which thing, and where it goes.

    Returns:
        The fact that is no longer, and the state after; None where nothing can be moved.
    """
    for thing, places in draw.sample(_movable(task), len(_movable(task))):
        here = state.intersection(places)
        if len(here) == 1 and not any(_bound(thing, places, state, task)):
            others = list(elsewhere_of(list(places), state, task))
            if others:
                return next(iter(here)), draw.choice(others)
    return None


@lru_cache(maxsize=8)
def _movable(task: Task) -> tuple[tuple[str, tuple[Atom, ...]], ...]:
    return tuple((thing, tuple(found)) for thing, found in sorted(places_of(task).items()))


def _bound(thing: str, places: tuple[Atom, ...], state: State, task: Task) -> Iterator[bool]:
    """Of every true fact that names a thing and is not its place: whether it holds it there."""
    for atom in state.difference(places):
        if thing in atom.arguments[1:]:
            yield atom.predicate == places[0].predicate
        elif thing in atom.arguments:
            yield any(group.exactly_one for group in task.groups_of(atom))
