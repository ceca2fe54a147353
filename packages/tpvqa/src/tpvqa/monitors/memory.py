"""Taking a denied fact out of the believed state without losing an object.

The paper removes `in_hand(plate)` when the VLM denies it, and the planner goes back to the table
"as it believes there is a plate on the table". In STRIPS that knowledge was deleted when the plate
was picked up. So every exactly-one group keeps what held in it before: when its true member is
taken out and no answer says which other one holds, the fact that held before is believed again.
"""

from collections.abc import Collection, Iterable
from functools import cached_property

from tpvqa.pddl import Atom, Literal, MutexGroup, State, Task


class FactMemory:
    """Remembers which believed facts ended, and repairs a state from which facts are taken out.

    What ended lies on a stack. Falling back to a fact takes it off: a fact that is believed again
    has before it what it had the first time, and what was denied is never fallen back to.

    Args:
        task: Gives the initial state and the mutex groups.
    """

    def __init__(self, task: Task):
        self._task = task
        self._groups = [group for group in task.mutex_groups if group.exactly_one]
        self._all_groups = task.mutex_groups
        self._initial = task.init
        self._ended: list[Atom] = []
        self._changed: set[Atom] = set()

    @cached_property
    def _possible(self) -> frozenset[Atom]:
        """What held at first, or what some action brings about."""
        return self._initial | {
            effect.literal.atom
            for action in self._task.ground_actions()
            for effect in action.effects
            if effect.literal.positive
        }

    def record(self, before: State, after: State) -> None:
        """Note what an action changed."""
        self._ended += sorted(before - after)
        self._changed |= before ^ after

    def correct(self, before: State, after: State) -> None:
        """Note a correction by `take_out`."""
        for atom in sorted(after - before):
            if atom in self._ended:
                latest = len(self._ended) - 1 - self._ended[::-1].index(atom)
                del self._ended[latest]
        self._changed |= before ^ after

    def alternatives(self, atom: Atom) -> list[Atom]:
        """The other members of its exactly-one groups that can come true, in a fixed order."""
        others = {other for group in self._groups if atom in group.atoms for other in group.atoms}
        return sorted(others & self._possible - {atom})

    def take_out(
        self,
        state: State,
        denied: Iterable[Literal],
        *,
        seen: Collection[Atom] = (),
        unseen: Collection[Atom] = (),
    ) -> State:
        """The believed state without the denied literals.

        Args:
            state: What was believed.
            denied: Literals that were denied; a negative one becomes its atom.
            seen: Alternatives that the VLM affirmed.
            unseen: Alternatives that it denied; fallen back to only where nothing else is left.

        Returns:
            The corrected state. A literal with nothing before it (an initial one that never
            changed) stays, unless an affirmed alternative takes its place; so the result may be
            the state itself.
        """
        for literal in denied:
            if literal.positive:
                state = self._without(state, literal.atom, seen, unseen)
            elif literal.atom in self._changed and literal.atom not in state:
                state = self._with(state, literal.atom)
        return state

    def _without(
        self, state: State, atom: Atom, seen: Collection[Atom], unseen: Collection[Atom]
    ) -> State:
        if atom not in state:
            return state
        homes = [group for group in self._groups if atom in group.atoms]
        if not homes:
            known = atom in self._initial and atom not in self._changed
            return state if known else state - {atom}
        replaced = state - {atom}
        for group in homes:
            if replaced & group.atoms:
                continue
            candidates = [other for other in seen if other in group.atoms and other != atom]
            successor = (
                self._least_disturbing(replaced, candidates)
                if candidates
                else self._previous(group, atom, unseen)
            )
            if successor is not None:
                replaced = self._with(replaced, successor)
        if any(not replaced & group.atoms for group in self._groups):
            return state
        return replaced

    def _previous(self, group: MutexGroup, atom: Atom, unseen: Collection[Atom]) -> Atom | None:
        held = [e for e in reversed(self._ended) if e in group.atoms and e != atom]
        return next((each for each in held if each not in unseen), held[0] if held else None)

    def _with(self, state: State, atom: Atom) -> State:
        rivals = {
            other for group in self._all_groups if atom in group.atoms for other in group.atoms
        }
        return (state - rivals) | {atom}

    def _least_disturbing(self, state: State, candidates: Iterable[Atom]) -> Atom:
        def bereaved(candidate: Atom) -> int:
            after = self._with(state, candidate)
            return sum(
                1 for group in self._groups if state & group.atoms and not after & group.atoms
            )

        return min(sorted(candidates), key=bereaved)
