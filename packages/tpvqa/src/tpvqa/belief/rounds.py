"""Going round in circles: it grows dearer each time."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tpvqa.belief.doing import moved
from tpvqa.belief.far_off import Ranked
from tpvqa.pddl import Action

ROUNDS = 3.0
"""How often it is no surprise to come back to the same action, were every step of it progress."""
NO_NEWS = 0.1
"""Who comes back with less of the belief moved has found out nothing on the way."""

_Begun = tuple[int, Action]
"""Where something was begun: the joint state that was most probable, and an action."""


@dataclass(slots=True)
class _Times:
    """How often something was begun at one place.

    Attributes:
        whole: In all.
        last: At which step it was begun last.
        belief: What was believed then.
    """

    whole: int = 0
    last: int = 0
    belief: Mapping[int, float] = field(default_factory=dict)


class Rounds:
    """What was done where, and what it costs to come back to it once more.

    Args:
        price: That of an action.
    """

    def __init__(self, price: float):
        self._price = price
        self._steps = self._in_vain = 0
        self._before: Action | None = None
        self._expected: tuple[int, ...] | None = None
        self._fault = 0
        self._begun: dict[_Begun, _Times] = {}

    def acted(self, action: Action, ranked: Ranked, intended: int | None) -> None:
        """Note that an action is executed.

        Args:
            action: It.
            ranked: What is believed.
            intended: The joint state to which it leads from the most probable one, if it works.
        """
        number = ranked[0][0]
        self._fault = self._last_fault(number)
        if action != self._before:
            times = self._begun.setdefault((number, action), _Times())
            self._in_vain += self._idle(times, ranked)
            times.whole += 1
            times.last, times.belief = self._steps, dict(ranked)
        self._before, self._steps = action, self._steps + 1
        self._expected = (number,) if intended is None else (number, intended)

    def renumbered(self, numbers: Mapping[int, int]) -> None:
        """Go on with other numbers of the joint states."""
        begun, self._begun = self._begun, {}
        for (number, action), times in begun.items():
            kept = {numbers[n]: each for n, each in times.belief.items() if n in numbers}
            there = self._begun.setdefault((numbers.get(number, -1), action), _Times())
            there.whole += times.whole
            if times.last >= there.last:
                there.last, there.belief = times.last, kept
        if self._expected is not None:
            self._expected = tuple(numbers.get(number, -1) for number in self._expected)

    def dearer(self, action: Action, ranked: Ranked, progress: float, undone: float) -> float:
        """What an action costs more each time that the trial comes back to it.

        To repeat it is no coming back; to do something else in between, and to believe again what
        was believed then, is going round in a circle. So often as faults explain it costs nothing:
        whatever was undone may have led back. They do not explain a round in which, as is believed,
        everything led where it was to lead, and after which nothing else is believed than before:
        one more of these costs the more, the more there were of them, wherever.

        Args:
            action: It.
            ranked: What is believed now.
            progress: How often a step is one.
            undone: How often an action undoes something.
        """
        times = self._begun.get((ranked[0][0], action))
        if times is None:
            return 0.0
        over = max(0.0, times.whole - ROUNDS / progress - undone * self._steps)
        again = action != self._before and self._idle(times, ranked)
        return self._price * float(over**2 + (again * (self._in_vain + 1)) ** 2)

    def _last_fault(self, number: int) -> int:
        """The step before which it last came to another joint state than what was done leads to,
        where this one is the most probable now."""
        unexpected = self._expected is not None and number not in self._expected
        return self._steps if unexpected else self._fault

    def _idle(self, times: _Times, ranked: Ranked) -> bool:
        """Whether what was done since something was begun last was a round in vain."""
        on_purpose = times.whole > 0 and times.last >= self._last_fault(ranked[0][0])
        return on_purpose and moved(ranked, times.belief) < NO_NEWS
