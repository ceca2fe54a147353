"""What a disturbance leads to where no world file says it."""

from collections.abc import Sequence

from tpvqa.pddl import Atom, State, Task


class BackToBefore:
    """An undone fact gives way to what held before it in its groups.

    A thing that is no longer in the hand is where it was taken from; the hand is free again. A
    fact without an exactly-one group is false again.

    Args:
        task: Gives the mutex groups.
    """

    def __init__(self, task: Task):
        self._task = task
        self._homes: dict[Atom, list[State]] = {}
        self._rivals: dict[Atom, State] = {}
        for group in task.mutex_groups:
            for each in group.atoms if group.exactly_one else ():
                self._homes.setdefault(each, []).append(group.atoms)

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """The one state that this leads to; none where nothing held before."""
        after = state - {atom}
        for group in self._homes.get(atom, ()):
            if after & group:
                continue
            before = next((each for each in reversed(history) if each in group - {atom}), None)
            if before is None:
                return []
            after = (after - self._rivals_of(before)) | {before}
        if any(not after & group for gone in state - after for group in self._homes.get(gone, ())):
            return []
        return [("it is as before", after)]

    def _rivals_of(self, atom: Atom) -> State:
        """The facts that do not hold together with one."""
        known = self._rivals.get(atom)
        if known is None:
            groups = (group.atoms for group in self._task.groups_of(atom))
            known = self._rivals[atom] = frozenset[Atom]().union(*groups) - {atom}
        return known
