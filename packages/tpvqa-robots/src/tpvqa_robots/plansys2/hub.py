"""What a performer and PlanSys2's executor agree on over `actions_hub`, without ROS.

The executor asks who can do an action (REQUEST), performers answer (RESPONSE), one is taken
(CONFIRM), the others are not (REJECT). It tells what it is about (FEEDBACK) and how it ended
(FINISH); the executor may stop it (CANCEL), and hears no more of it then. Written from the messages
of plansys2_msgs and the behaviour of plansys2_executor's ActionExecutor and ActionExecutorClient.
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from threading import Event, RLock

COMMITTED = 30.0
"""Seconds for which an answer is good: an executor deals for no longer."""


class Kind(IntEnum):
    """The types of `ActionExecution`."""

    REQUEST = 1
    RESPONSE = 2
    CONFIRM = 3
    REJECT = 4
    FEEDBACK = 5
    FINISH = 6
    CANCEL = 7


@dataclass(frozen=True, slots=True)
class Said:
    """An `ActionExecution`.

    Attributes:
        kind: What it is.
        node: Who asked (REQUEST), whom it is for (CONFIRM, REJECT, CANCEL), or who says it.
        action: The action's name.
        arguments: What it is done to.
        success: Of a FINISH.
        completion: How much is done, from 0 to 1.
        status: For people.
    """

    kind: Kind
    node: str
    action: str
    arguments: tuple[str, ...]
    success: bool = False
    completion: float = 0.0
    status: str = ""


@dataclass
class Work:
    """An action that was confirmed."""

    action: str
    arguments: tuple[str, ...]
    cancelled: Event


class Performer:
    """One performer, who does one thing at a time.

    Args:
        name: What it calls itself.
        can: Whether it can do an action.
        begin: Begins work that was confirmed; returns at once.
        say: Speaks on the hub.
        clock: Seconds that only grow.
    """

    def __init__(
        self,
        name: str,
        can: Callable[[str, tuple[str, ...]], bool],
        begin: Callable[[Work], None],
        say: Callable[[Said], None],
        clock: Callable[[], float],
    ):
        self.name, self._can, self._begin = name, can, begin
        self._say, self._clock = say, clock
        self._offered: tuple[str, tuple[str, ...]] | None = None
        self._until = 0.0
        self._work: Work | None = None
        self._lock = RLock()

    @property
    def work(self) -> Work | None:
        """What it is at."""
        return self._work

    def hear(self, said: Said) -> None:
        """Something was said on the hub."""
        with self._lock:
            wanted = (said.action, said.arguments)
            mine = said.node == self.name
            match said.kind:
                case Kind.REQUEST:
                    self._asked(wanted)
                case Kind.REJECT if mine and wanted == self._offered:
                    self._offered = None
                case Kind.CONFIRM if mine:
                    self._confirmed(wanted)
                case Kind.CANCEL if mine and self._work is not None and self._is(wanted):
                    self._work.cancelled.set()

    def tell(self, status: str) -> None:
        """Say what it is about. How much is done no skill tells, so that it stays 0."""
        with self._lock:
            work = self._work
            if work is not None and not work.cancelled.is_set():
                self._say(
                    Said(Kind.FEEDBACK, self.name, work.action, work.arguments, status=status)
                )

    def finish(self, *, success: bool, status: str) -> None:
        """Say how it ended, unless it was cancelled: then nobody listens; and be free again."""
        with self._lock:
            work, self._work = self._work, None
            if work is not None and not work.cancelled.is_set():
                self._end(work.action, work.arguments, success=success, status=status)

    def _is(self, wanted: tuple[str, tuple[str, ...]]) -> bool:
        work = self._work
        return work is not None and wanted == (work.action, work.arguments)

    def _asked(self, wanted: tuple[str, tuple[str, ...]]) -> None:
        """Answer, where it is free and can."""
        free = self._offered is None or self._clock() > self._until
        if self._work is None and (free or wanted == self._offered) and self._can(*wanted):
            self._offered, self._until = wanted, self._clock() + COMMITTED
            self._say(Said(Kind.RESPONSE, self.name, *wanted))

    def _confirmed(self, wanted: tuple[str, tuple[str, ...]]) -> None:
        """Begin what was offered. What was not, or is being done, is not done again."""
        if self._is(wanted):
            return
        if self._work is not None or wanted != self._offered or self._clock() > self._until:
            self._end(*wanted, success=False, status="it was not offered, or no longer")
            return
        self._offered = None
        self._work = Work(*wanted, Event())
        self._begin(self._work)

    def _end(self, action: str, arguments: tuple[str, ...], *, success: bool, status: str) -> None:
        done = 1.0 if success else 0.0
        said = Said(Kind.FINISH, self.name, action, arguments, success, done, status)
        self._say(said)
