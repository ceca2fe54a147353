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
        self._groups = [group.atoms for group in task.mutex_groups if group.exactly_one]

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """The one state that this leads to; none where nothing held before."""
        after = state - {atom}
        for group in self._groups:
            if atom not in group or after & group:
                continue
            before = next((each for each in reversed(history) if each in group - {atom}), None)
            if before is None:
                return []
            rivals = {
                other for each in task.groups_of(before) for other in each.atoms if other != before
            }
            after = (after - rivals) | {before}
        if any(state & group and not after & group for group in self._groups):
            return []
        return [("it is as before", after)]
