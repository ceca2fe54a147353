"""What else could be true when answers contradict all that the action model explains."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from tpvqa.belief.states.constraints import Constraints
from tpvqa.belief.states.disturbances import disturbances
from tpvqa.belief.states.mutexes import h2_mutexes
from tpvqa.belief.states.nearest import Nearest
from tpvqa.belief.states.places import further_places
from tpvqa.errors import BeliefError, PlannerError
from tpvqa.pddl import Atom, State, Task

KNOWN = 64
"""Answers to which it is kept what else could be true."""
FARTHER = 2
"""Facts by which a state may differ more than the nearest does."""


class Surprise:
    """Finds the nearest consistent states in which a fact is the other way.

    Consistent is what violates no mutex group and no h² mutex, disturbances counted in.

    Args:
        task: Gives the mutex groups.
        undo: What disturbances can undo, as a world file says; empty where nobody knows.
    """

    def __init__(self, task: Task, undo: Sequence[Any] = ()):
        self._task, self._undo = task, undo
        self._known: dict[tuple[State, tuple[Atom, ...]], tuple[State, ...]] = {}

    @cached_property
    def constraints(self) -> Constraints:
        """What every state of the task keeps."""
        if not self._undo:  # what befalls the world is unknown, so only the groups are sure
            return Constraints.of(self._task)
        try:
            further = disturbances(self._task, self._undo)
            found = h2_mutexes(self._task, further)
        except (PlannerError, AttributeError):  # rules of another kind than a world file's
            return Constraints.of(self._task)
        return Constraints.of(self._task, found.pairs, never=found.never, further=further)

    def flips(self, state: State, atoms: tuple[Atom, ...]) -> tuple[State, ...]:
        """The nearest consistent states in which a fact is the other way.

        Args:
            state: A joint state.
            atoms: The fact, and others that no answer tells from it.

        Returns:
            States in which none of them holds, where one does; or one of them, where none does.
            A thing that is not where it was is at each of the other places.
        """
        key = (state, atoms)
        if key not in self._known:
            if len(self._known) >= KNOWN:
                self._known.clear()
            self._known[key] = tuple(self._nearest(state, atoms))
        return self._known[key]

    @cached_property
    def _can_hold(self) -> State:
        return self._task.atoms() | self._task.init | further_places(self._task)

    def _nearest(self, state: State, atoms: tuple[Atom, ...]) -> list[State]:
        true = [atom for atom in atoms if atom in state]
        if not true:
            wishes = [{atom: True} for atom in sorted(atoms) if atom in self._can_hold]
        else:
            gone = dict.fromkeys(atoms, False)
            homes = [g.atoms for g in self._task.groups_of(true[0]) if g.exactly_one]
            places = max(homes, key=len, default=frozenset[Atom]()) & self._can_hold
            elsewhere = sorted(places.difference(atoms))
            wishes = [{**gone, other: True} for other in elsewhere] or [gone]
        nearest = Nearest(self.constraints, state, self._can_hold)
        found: dict[State, int] = {}
        for wish in wishes:
            try:
                after = nearest.where(wish)
            except BeliefError:
                continue
            if after != state:
                found[after] = len(after ^ state)
        least = min(found.values(), default=0)
        return [after for after, changes in found.items() if changes <= least + FARTHER]
