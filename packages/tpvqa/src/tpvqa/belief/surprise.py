"""What else could be true when answers contradict all that the action model explains."""

from collections.abc import Sequence
from functools import cached_property
from typing import Any

from tpvqa.belief.consistency import most_probable
from tpvqa.belief.constraints import Constraints
from tpvqa.belief.disturbances import disturbances
from tpvqa.belief.mutexes import h2_mutexes
from tpvqa.errors import BeliefError, ContradictionError, MissingExtraError, PlannerError
from tpvqa.pddl import Atom, State, Task

KEPT = 2.0
"""Log odds that a fact stayed as it was: any positive number gives the nearest state."""
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
            self._known[key] = tuple(self._find(state, atoms))
        return self._known[key]

    def _find(self, state: State, atoms: tuple[Atom, ...]) -> list[State]:
        can_hold = self._task.atoms() | self._task.init
        true = [atom for atom in atoms if atom in state]
        if not true:
            wishes = [{atom: True} for atom in sorted(atoms) if atom in can_hold]
        else:
            gone = dict.fromkeys(atoms, False)
            homes = [g.atoms for g in self._task.groups_of(true[0]) if g.exactly_one]
            elsewhere = sorted((max(homes, key=len, default=frozenset()) & can_hold) - set(atoms))
            wishes = [{**gone, other: True} for other in elsewhere] or [gone]
        fluents = self._task.fluents
        odds = {
            atom: KEPT if atom in state else -KEPT
            for atom in can_hold | state
            if atom.predicate in fluents
        }
        static = frozenset(atom for atom in state if atom.predicate not in fluents)
        found: dict[State, int] = {}
        for wish in wishes:
            try:
                after = static | most_probable(odds, self.constraints, fixed=wish).state
            except (ContradictionError, BeliefError, MissingExtraError):
                continue
            if after != state:
                found[after] = len(after ^ state)
        nearest = min(found.values(), default=0)
        return [after for after, changes in found.items() if changes <= nearest + FARTHER]
