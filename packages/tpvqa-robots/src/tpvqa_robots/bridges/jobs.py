"""Work in threads that a tick looks in on, and whose turn it is at what serves one at a time."""

import atexit
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import count
from threading import Event, Lock, Thread
from time import monotonic
from typing import Any, Generic, TypeVar
from weakref import WeakSet, WeakValueDictionary

T = TypeVar("T")
AT_EXIT = 2.0
"""Seconds that are left, when the program ends, to what still runs: a robot comes to a stand."""


class Job(Generic[T]):
    """Something that is being done in a thread; it begins at once.

    Where the program ends meanwhile, `cancel` is set, and the thread is waited for a little.

    Args:
        work: Is given `cancel`; what it returns or raises is told by `result`.
        name: Of the thread.
        cancel: Set once nobody wants it any more; one of its own by default.

    Attributes:
        cancel: The same.
    """

    def __init__(self, work: Callable[[Event], T], name: str, cancel: Event | None = None):
        self.cancel = cancel or Event()
        self._work, self._began, self._over = work, monotonic(), Event()
        self._made: list[T] = []
        self._error: Exception | None = None
        _BEGUN.add(self)
        Thread(target=self._run, name=name, daemon=True).start()

    def _run(self) -> None:
        try:
            self._made.append(self._work(self.cancel))
        except Exception as error:  # noqa: BLE001 — told by whoever asks for the result
            self._error = error
        except SystemExit as error:  # the program is not a plug-in's to end
            self._error = RuntimeError(f"SystemExit: {error}")
        finally:
            self._over.set()

    @property
    def over(self) -> bool:
        """Whether it has come to its end."""
        return self._over.is_set()

    @property
    def seconds(self) -> float:
        """How long ago it began."""
        return monotonic() - self._began

    def result(self) -> T:
        """What the work returned, once it is over.

        Raises:
            Exception: Whatever it raised.
        """
        if self._error is not None:
            raise self._error
        return self._made[0]

    def drop(self, wait: float = 0.0) -> bool:
        """Set `cancel`; whether the work is over within so many seconds."""
        self.cancel.set()
        return self._over.wait(wait)


_BEGUN: WeakSet[Job[Any]] = WeakSet()


@atexit.register
def _stand_still() -> None:
    running = [job for job in list(_BEGUN) if not job.over]
    for job in running:
        job.cancel.set()
    until = monotonic() + AT_EXIT
    for job in running:
        job.drop(max(until - monotonic(), 0.0))


class Turn:
    """What a part does for one at a time.

    Attributes:
        lock: Held by whoever has it.
        numbers: Numbers of what is done so, from 1.
    """

    def __init__(self) -> None:
        self.lock, self.numbers = Lock(), count(1)

    @contextmanager
    def waited_for(self, seconds: float, whose: str) -> Iterator[None]:
        """Have it, once others have had it.

        Raises:
            TimeoutError: They did not let go of it within so many seconds.
        """
        if not self.lock.acquire(timeout=seconds):
            raise TimeoutError(f"{whose} was busy with something else for {seconds:g} s")
        try:
            yield
        finally:
            self.lock.release()


_TURNS: WeakValueDictionary[tuple[str, int], Turn] = WeakValueDictionary()
_FINDING = Lock()


def turn(what: str, part: object) -> Turn:
    """The same one for everybody who wants the same of the same part.

    Whoever keeps it has to keep the part, too.

    Args:
        what: The part does.
        part: A world or a VLM.
    """
    with _FINDING:
        found = _TURNS.get((what, id(part)))
        if found is None:
            found = _TURNS[what, id(part)] = Turn()
        return found
