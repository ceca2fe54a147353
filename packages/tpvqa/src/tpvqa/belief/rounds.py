"""Going round in circles: it grows dearer each time."""

from collections import Counter
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
        self._begun: Counter[tuple[int, Action]] = Counter()

    def acted(self, number: int, action: Action) -> None:
        """Note that an action is executed where a joint state is most probable."""
        if not self._done or self._done[-1][1] != action:
            self._begun[number, action] += 1
        self._done.append((number, action))

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        done, self._done, self._begun = self._done, [], Counter()
        for number, action in done:
            self.acted(numbers.get(number, -1), action)

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
        times = self._begun[number, action] - explained
        return self._price * max(0.0, times) ** 2
