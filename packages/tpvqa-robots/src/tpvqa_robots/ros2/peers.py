"""Loops that want the robot of a server which does not say whose it is: one of them has it."""

from collections.abc import Set
from dataclasses import dataclass, field

from tpvqa_robots.ros2.lease import EXPIRES

LISTENS = 1.0
"""Seconds for which a newcomer hears whether somebody else has the robot."""


@dataclass
class Peers:
    """What one loop hears of the others.

    Whoever wants the robot says so; the least of their names gets it, and keeps it against whoever
    comes later, as long as it is heard.

    Attributes:
        me: This loop.
        since: From when on it can hear them, in seconds.
        holds: Whether it has the robot.
    """

    me: str
    since: float
    holds: bool = False
    _heard: dict[str, tuple[float, bool]] = field(default_factory=dict)
    _found: Set[str] = frozenset()

    def found(self, loops: Set[str], ready: bool, now: float) -> None:
        """Which loops speak, and whether the server is there: who has just come to know of another
        one, or of the server, has not listened yet."""
        if not ready or loops - self._found:
            self.since = now
        self._found = loops

    def hear(self, other: str, now: float, *, holds: bool, release: bool = False) -> None:
        """Another loop was heard, and whether it has the robot or gives it back."""
        if other == self.me:
            return
        if release:
            self._heard.pop(other, None)
        else:
            self._heard[other] = (now, holds)

    def holder(self, now: float) -> str | None:
        """Who has the robot now; None for nobody."""
        others = {name: has for name, (at, has) in self._heard.items() if now - at <= EXPIRES}
        having = [name for name, has in others.items() if has]
        if self.holds:
            having.append(self.me)
        elif not having and now - self.since >= LISTENS:
            having = [min(self.me, *others)] if others else [self.me]
        least = min(having, default=None)
        self.holds = least == self.me
        return least
