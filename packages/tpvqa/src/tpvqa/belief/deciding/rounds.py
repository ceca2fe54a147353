"""Going round in circles: it grows dearer each time."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from tpvqa.belief.deciding.doing import moved
from tpvqa.belief.deciding.far_off import Ranked
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
        led_on: Whether it led to another joint state then, itself or by being repeated.
        belief: What was believed then.
    """

    whole: int = 0
    last: int = 0
    led_on: bool = False
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
        self._fault = self._led_on = 0
        self._paid = -1
        self._begun: dict[_Begun, _Times] = {}
        self._latest: tuple[int, _Times] | None = None

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
            if self._latest is not None:
                self._latest[1].led_on = self._latest[0] != number
            self._led_on = self._last_led_on(number)
            times = self._begun.setdefault((number, action), _Times())
            if self._idle(times, ranked):
                self._in_vain, self._paid = self._in_vain + 1, self._steps
            times.whole += 1
            times.last, times.belief = self._steps, dict(ranked)
            self._latest = number, times
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
                there.last, there.led_on, there.belief = times.last, times.led_on, kept
            if self._latest is not None and self._latest[1] is times:
                self._latest = numbers.get(number, -1), there
        if self._expected is not None:
            self._expected = tuple(numbers.get(number, -1) for number in self._expected)

    def dearer(self, action: Action, ranked: Ranked, progress: float, undone: float) -> float:
        """What an action costs more each time that the trial comes back to it.

        To repeat it is no coming back; to do something else in between, and to believe again what
        was believed then, is going round in a circle. So often as faults explain it costs nothing:
        whatever was undone may have led back. They do not explain a round in which, as is believed,
        everything led where it was to lead, and after which nothing else is believed than before:
        one more of these costs the more, the more there were of them, wherever. It is paid by who
        begins it anew, once, and not by what led nowhere then, and is only come back to.

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

    def _last_led_on(self, number: int) -> int:
        """The step before which something last led to another joint state, where this one is the
        most probable now."""
        led = self._latest is not None and self._latest[0] != number
        return self._steps if led else self._led_on

    def _idle(self, times: _Times, ranked: Ranked) -> bool:
        """Whether what was done since something was begun last was a round in vain, which nothing
        was paid for yet."""
        number = ranked[0][0]
        on_purpose = times.whole > 0 and times.last >= self._last_fault(number)
        begun = times.led_on or self._last_led_on(number) <= times.last
        unpaid = self._paid <= times.last
        return on_purpose and begun and unpaid and moved(ranked, times.belief) < NO_NEWS
