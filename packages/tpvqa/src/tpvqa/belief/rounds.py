"""Going round in circles: it grows dearer each time."""

from collections.abc import Mapping

from tpvqa.pddl import Action

ROUNDS = 3.0
"""How often it is no surprise to come back to the same action, were every step of it progress."""


class Rounds:
    """What was done where, and what it costs to come back to it once more.

    Args:
        price: That of an action.
    """

    def __init__(self, price: float):
        self._price = price
        self._done: list[tuple[int, Action]] = []

    def acted(self, number: int, action: Action) -> None:
        """Note that an action is executed where a joint state is most probable."""
        self._done.append((number, action))

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        self._done = [(numbers.get(number, -1), action) for number, action in self._done]

    def dearer(self, action: Action, number: int, progress: float, undone: float) -> float:
        """What an action costs more each time that the trial comes back to it.

        To repeat it is no coming back; to do something else in between, and to believe again what
        was believed then, is going round in a circle. So often as faults explain it costs nothing:
        whatever was undone may have led back.

        Args:
            action: It.
            number: The joint state that is most probable now.
            progress: How often a step is one.
            undone: How often an action undoes something.
        """
        explained = ROUNDS / progress + undone * len(self._done)
        times = self._returns(action, number) - explained
        return self._price * max(0.0, times) ** 2

    def _returns(self, action: Action, number: int) -> int:
        """How often an action was begun anew where the same joint state was most probable."""
        done = self._done
        return sum(
            each == (number, action) and (not place or done[place - 1][1] != action)
            for place, each in enumerate(done)
        )
