"""How late a machine is: what is promised in fractions of a second is so for one that is free."""

import threading
import time
from types import TracebackType

import pytest

TICK = 0.005
MOST = 0.25


class Lag:
    """Measures the longest time by which a short sleep was too long, as long as it is entered."""

    def __init__(self) -> None:
        self._worst, self._over = 0.0, threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> "Lag":
        self._thread.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._over.set()
        self._thread.join()

    def _watch(self) -> None:
        while not self._over.is_set():
            began = time.monotonic()
            time.sleep(TICK)
            self._worst = max(self._worst, time.monotonic() - began - TICK)

    def allows(self, seconds: float) -> float:
        """What may be taken for `seconds`: four hands in a row may each have had to wait.

        Where one waits longer than `MOST` nothing can be told: that is no machine to measure on.
        """
        if self._worst > MOST:
            pytest.skip(f"a processor was waited for {self._worst:.2f} s")
        return seconds + 4 * self._worst
