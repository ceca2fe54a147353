"""States that no plan leads on from."""

from tpvqa.belief.states.dead_ends import dead_ends_of
from tpvqa.pddl import State, Task


class Hopeless:
    """What a planner has found no plan from, and what surely is as hopeless.

    Once there is such a state, others of which nothing was asked must not look better than it does:
    to go on from there would seem to save the whole task. So those from where the goal is out of
    reach even if nothing were ever undone count, too.

    Args:
        task: Says what the goal is.
    """

    def __init__(self, task: Task):
        self._task = task
        self._told: set[State] = set()

    def add(self, state: State) -> None:
        """Note that no plan exists from a state."""
        self._told.add(state)

    def __contains__(self, state: State) -> bool:
        if not self._told:
            return False
        return state in self._told or dead_ends_of(self._task).holds(state)
