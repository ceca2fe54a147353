"""What a disturbance leads to where no world file says it."""

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, lru_cache

from tpvqa.belief.states.dead_ends import DeadEnds, dead_ends_of
from tpvqa.belief.states.places import things
from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.arithmetic import VALUE
from tpvqa.pddl.likewise import numbers_likewise

LOST = 0.1
"""How often what was held falls where nothing that the task knows says that it is."""


class BackToBefore:
    """An undone fact gives way to what held before it in its groups, or a thing is lost.

    Who believes reckons with the latter; a world without a file loses nothing.

    A thing that is no longer in the hand is where it was taken from; the hand is free again. A
    fact without an exactly-one group is false again. What cannot hold with the rest, as no actions
    lead there (h²), does not come back, and nothing is undone: a screw is not back in the gripper
    once another tool is mounted, but stays. So does what no action could mend (`DeadEnds`): the
    sugar in the tea. Numbers go with that as with the action that does it, where there is one; a
    number is never without a value.

    Args:
        task: Gives the mutex groups.
    """

    def __init__(self, task: Task):
        self._task = task
        self._groups: list[State] = []
        self._homes: dict[Atom, list[int]] = {}
        self._rivals: dict[Atom, State] = {}
        for group in task.mutex_groups:
            if group.exactly_one:
                for each in group.atoms:
                    self._homes.setdefault(each, []).append(len(self._groups))
                self._groups.append(group.atoms)

    @cached_property
    def _places(self) -> frozenset[int]:
        """The groups that say where a thing is, by number. Only who believes needs them: they take
        the task to be grounded."""
        places = {thing.places for thing in things(self._task)}
        groups = enumerate(self._groups)
        return frozenset(number for number, each in groups if any(p <= each for p in places))

    @property
    def groups(self) -> int:
        """How many groups there are of which exactly one fact holds."""
        return len(self._groups)

    def homes(self, atom: Atom) -> Sequence[int]:
        """The groups of which exactly one fact holds that an atom belongs to, by number."""
        return self._homes.get(atom, ())

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """The one state that this leads to; none where nothing held before."""
        before = self.latest(atom, history)
        after = None if atom.predicate == VALUE else self.undone(atom, state, before)
        if after is not None and task.numeric is not None:
            after = numbers_likewise(task, state, after) or after
        return [] if after is None else [("it is as before", after)]

    def latest(self, atom: Atom, history: Sequence[Atom]) -> Callable[[int], Atom | None]:
        """What held last, besides an atom, of a group, by all that ended, the latest last."""

        def before(number: int) -> Atom | None:
            others = self._groups[number] - {atom}
            return next((each for each in reversed(history) if each in others), None)

        return before

    def undone(
        self, atom: Atom, state: State, before: Callable[[int], Atom | None]
    ) -> State | None:
        """The state that undoing an atom leads to; None where nothing held before, or it cannot
        hold with the rest, or never be mended.

        Args:
            atom: What is undone.
            state: Where it holds.
            before: What held last, besides it, of a group.
        """
        after = state - {atom}
        for number in self.homes(atom):
            if not after.isdisjoint(self._groups[number]):
                continue
            earlier = before(number)
            if earlier is None:
                return None
            after = (after - self._rivals_of(earlier)) | {earlier}
        if any(
            after.isdisjoint(self._groups[number])
            for gone in state - after
            for number in self.homes(gone)
        ):
            return None
        if not self._possible(after, state) or self._dead_ends.holds(after, state):
            return None
        return after

    def _possible(self, after: State, state: State) -> bool:
        """Whether what has come can hold together with the rest."""
        come = after - state
        return all(after.isdisjoint(self._apart.get(each, ())) for each in come)

    @cached_property
    def _apart(self) -> Mapping[Atom, set[Atom]]:
        return _kept_apart(self._task, self._task.besides)

    @cached_property
    def _dead_ends(self) -> DeadEnds:
        return dead_ends_of(self._task)

    def with_shares(
        self, atom: Atom, state: State, before: Callable[[int], Atom | None]
    ) -> list[tuple[float, State]]:
        """What undoing an atom leads to, with shares: seldom a thing is lost.

        Args:
            atom: What is undone.
            state: Where it holds.
            before: What held last, besides it, of a group.
        """
        after, lost = self.undone(atom, state, before), self.lost(atom, state, before)
        if after is None:
            return []
        return [(1.0, after)] if lost is None else [(1 - LOST, after), (LOST, lost)]

    def lost(self, atom: Atom, state: State, before: Callable[[int], Atom | None]) -> State | None:
        """The state in which a thing is nowhere that a fact says, and what held it is free again;
        None where an atom does not say that something holds a thing.

        Args:
            atom: What is undone.
            state: Where it holds.
            before: What held last, besides it, of a group.
        """
        homes = self.homes(atom)
        holders = [number for number in homes if number not in self._places]
        earlier, left = [before(number) for number in holders], state - {atom}
        if not atom.arguments or len(holders) == len(homes) or None in earlier:
            return None
        freed = {each for each in earlier if each and atom.arguments[0] not in each.arguments}
        free = all(left.isdisjoint(self._rivals_of(each)) for each in freed)
        return left | freed if freed and free else None

    def _rivals_of(self, atom: Atom) -> State:
        """The facts that do not hold together with one."""
        known = self._rivals.get(atom)
        if known is None:
            groups = (group.atoms for group in self._task.groups_of(atom))
            known = self._rivals[atom] = frozenset[Atom]().union(*groups) - {atom}
        return known


# The world's and the belief's, and those of a bench's trials, are one. Tasks that differ in what
# may hold besides are equal and have other actions.
@lru_cache(maxsize=4)
def _kept_apart(task: Task, besides: State) -> Mapping[Atom, set[Atom]]:
    """What never holds together with an atom, as far as actions lead; nothing of a task of which
    grounding left out a part."""
    from tpvqa.belief.states.mutexes import h2_mutexes  # numpy, which most worlds do not need

    found: dict[Atom, set[Atom]] = {}
    if not task.left_out:
        for one, other in h2_mutexes(task).pairs:
            found.setdefault(one, set()).add(other)
            found.setdefault(other, set()).add(one)
    return found
