"""The command line: words → calls, no logic of its own."""

import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from types import FrameType

__all__ = ["main"]

TWICE = 2.0
"""Seconds in which a second SIGTERM is the first once more, as `timeout` sends it: it must not
break off the end."""


def main() -> None:
    """Run the command line; see `tpvqa.cli.app.main`. Ctrl-C while it is loaded ends it, too."""
    with _sigterm_as_ctrl_c():
        try:
            from tpvqa.cli.app import main as run
        except KeyboardInterrupt:
            print("interrupted", file=sys.stderr)
            sys.exit(130)
        run()


@contextmanager
def _sigterm_as_ctrl_c() -> Iterator[None]:
    """Whoever ends the program by SIGTERM loses no more, and is told no less, than by Ctrl-C.

    Where it is ignored, or somebody else has an answer to it, that stays.
    """
    main_thread = threading.current_thread() is threading.main_thread()
    if not main_thread or signal.getsignal(signal.SIGTERM) is not signal.SIG_DFL:
        yield
        return
    program, told = os.getpid(), -inf

    def end(number: int, frame: FrameType | None) -> None:
        nonlocal told
        if os.getpid() != program:  # a fork has nothing to keep
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)
        elif time.monotonic() - told > TWICE:
            told = time.monotonic()
            raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
