"""States that no plan leads on from."""

from tpvqa.belief.states.dead_ends import KEPT, dead_ends_of
from tpvqa.pddl import State, Task


class Hopeless:
    """What a planner has found no plan from, and what surely is as hopeless.

    Once there is such a state, others of which nothing was asked must not look better than it does:
    to go on from there would seem to save the whole task. So those from where the goal is out of
    reach even if nothing were ever undone count, too.

    Args:
        task: Says what the goal is.

    Attributes:
        near: A state like those that are asked about, probably none of them; None where none is
            known. They are told the quicker by it.
    """

    def __init__(self, task: Task):
        self._task = task
        self._told: set[State] = set()
        self._known: dict[State, bool] = {}
        self.near: State | None = None

    def add(self, state: State) -> None:
        """Note that no plan exists from a state."""
        self._told.add(state)
        self._known[state] = True

    def __contains__(self, state: State) -> bool:
        if not self._told:
            return False
        known = self._known.get(state)
        if known is None:
            if len(self._known) >= KEPT:
                self._known.clear()
            known = self._known[state] = state in self._told or self._dead_end(state)
        return known

    def _dead_end(self, state: State) -> bool:
        ends = dead_ends_of(self._task)
        near = self.near if self.near is not None and not ends.holds(self.near) else None
        return ends.holds(state, alive=near)
