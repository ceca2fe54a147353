"""Taking a denied fact out of the believed state without losing an object.

The paper removes `in_hand(plate)` when the VLM denies it, and the planner goes back to the table
"as it believes there is a plate on the table". In STRIPS that knowledge was deleted when the plate
was picked up. So every exactly-one group keeps what held in it before: when its true member is
taken out and no answer says which other one holds, the fact that held before is believed again.
"""

from collections.abc import Collection, Iterable, Mapping
from fractions import Fraction
from functools import cached_property

from tpvqa.pddl import Atom, Literal, MutexGroup, State, Task
from tpvqa.pddl.arithmetic import COMPARISONS, Words, values_in
from tpvqa.pddl.numeric import steps_of


class FactMemory:
    """Remembers what was believed before, and repairs a state from which facts are taken out.

    Of every exactly-one group it keeps the members that were believed, the present one last. To
    fall back to an earlier one drops the present one, so that what was denied does not come back;
    what was seen instead comes after what it took the place of.

    Args:
        task: Gives the initial state and the mutex groups.
    """

    def __init__(self, task: Task):
        self._task = task
        self._groups = [group for group in task.mutex_groups if group.exactly_one]
        self._all_groups = task.mutex_groups
        self._initial = task.init
        self._believed = {g.atoms: sorted(task.init & g.atoms) for g in self._groups}
        self._changed: set[Atom] = set()
        self._came_with: dict[Atom, dict[Words, tuple[Fraction, Fraction]]] = {}

    @cached_property
    def _possible(self) -> frozenset[Atom]:
        """What held at first, or what some action brings about."""
        return self._initial | {
            effect.literal.atom
            for action in self._task.ground_actions()
            for effect in action.effects
            if effect.literal.positive
        }

    @cached_property
    def _steps(self) -> Mapping[str, Fraction]:
        numeric = self._task.numeric
        return {} if numeric is None else steps_of(self._task, numeric)

    def record(self, before: State, after: State) -> None:
        """Note what an action changed."""
        for group, members in self._believed.items():
            members += sorted(after & group - before)
        self._changed |= before ^ after
        if self._task.numeric is not None:
            old, new = values_in(before), values_in(after)
            by = {w: (new[w] - old[w], new[w]) for w in new if w in old and new[w] != old[w]}
            for atom in after - before:
                self._came_with[atom] = by

    def came_with(self, atom: Atom, state: State) -> Mapping[Words, Fraction]:
        """By how much numbers changed with the action that brought a fact about.

        What was used up counts only where the number is as that action left it: who has charged or
        driven on since has arrived before.
        """
        values = values_in(state)
        return {
            words: by
            for words, (by, then) in self._came_with.get(atom, {}).items()
            if by > 0 or values.get(words) == then
        }

    def correct(self, before: State, after: State, denied: Iterable[Literal]) -> None:
        """Note a correction by `take_out` of what was denied.

        Only what was denied is dropped: that the hand is not free follows from what is in it
        after all, and nobody has denied that it was.
        """
        out = {literal.atom for literal in denied if literal.positive}
        for group, members in self._believed.items():
            for atom in sorted(after & group - before):
                if atom in members[:-1] and members[-1] in out:
                    members.pop()
                    latest = len(members) - 1 - members[::-1].index(atom)
                    del members[latest]
                members.append(atom)
        self._changed |= before ^ after

    def alternatives(self, atom: Atom) -> list[Atom]:
        """The other places where the thing that a fact is about may be, in a fixed order.

        The thing is what every fact of an exactly-one group speaks of. Of several it is the one
        whose places say least of other things: the plate, not the hand in which the apple might
        be instead. Where a group speaks of no thing, such as (robot-at ?room), the facts of one
        predicate are places of the robot.
        """
        homes = [group for group in self._spoken if atom in group]
        things = {name for name in atom.arguments if any(name in self._spoken[g] for g in homes)}
        if not things:
            alike = [g for g in homes if all(a.predicate == atom.predicate for a in g)]
            others = {other for group in alike for other in group}
            return sorted(others & self._possible - {atom})
        places = {thing: self._places(thing, homes) - {atom} for thing in things}
        thing = min(
            sorted(things, key=atom.arguments.index),
            key=lambda name: sum(self._says_of_others(place, name) for place in places[name]),
        )
        return sorted(places[thing] & self._possible)

    def _places(self, thing: str, homes: Iterable[State]) -> set[Atom]:
        """Where a thing may be; nothing is its own place."""
        own = (group for group in homes if thing in self._spoken[group])
        return {atom for group in own for atom in group if atom.arguments.count(thing) == 1}

    def _says_of_others(self, atom: Atom, thing: str) -> bool:
        """Whether a place of a thing is also one of another thing."""
        return any(atom in group and names - {thing} for group, names in self._spoken.items())

    @cached_property
    def _spoken(self) -> dict[State, frozenset[str]]:
        """Of which objects every fact of each exactly-one group speaks."""
        return {
            group.atoms: frozenset.intersection(*(frozenset(a.arguments) for a in group.atoms))
            for group in self._groups
        }

    def _rivals(self, atom: Atom) -> set[Atom]:
        return {o for group in self._all_groups if atom in group.atoms for o in group.atoms}

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
            The corrected state. Of a comparison that is denied the number becomes the nearest for
            which it is wrong. A literal with nothing before it (an initial one that never
            changed) stays, unless an affirmed alternative takes its place; so the result may be
            the state itself.
        """
        for literal in denied:
            if literal.atom.predicate in COMPARISONS and self._task.numeric is not None:
                state = self._task.numeric.believing(state, literal.negate(), self._steps)
            elif literal.positive:
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
        for group in self._groups:
            if not replaced & group.atoms:
                follows = self._what_follows(replaced, group)
                if follows is None:
                    return state
                replaced |= {follows}
        return replaced

    def _what_follows(self, state: State, group: MutexGroup) -> Atom | None:
        """The one member of a group that goes with all the rest: where a block has left its place
        for another, nothing is on it. None where several do, or none."""
        fitting = [
            atom
            for atom in sorted(group.atoms & self._possible)
            if self._rivals(atom).isdisjoint(state)
        ]
        return fitting[0] if len(fitting) == 1 else None

    def _previous(self, group: MutexGroup, atom: Atom, unseen: Collection[Atom]) -> Atom | None:
        held = [each for each in reversed(self._believed[group.atoms]) if each != atom]
        return next((each for each in held if each not in unseen), held[0] if held else None)

    def _with(self, state: State, atom: Atom) -> State:
        return (state - self._rivals(atom)) | {atom}

    def _least_disturbing(self, state: State, candidates: Iterable[Atom]) -> Atom:
        def bereaved(candidate: Atom) -> int:
            after = self._with(state, candidate)
            return sum(
                1 for group in self._groups if state & group.atoms and not after & group.atoms
            )

        return min(sorted(candidates), key=bereaved)
