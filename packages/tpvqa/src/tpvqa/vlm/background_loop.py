"""Asynchronous calls from synchronous code, also where an event loop already runs."""

import asyncio
import os
from collections.abc import Coroutine
from threading import Lock, Thread
from typing import Any, TypeVar

T = TypeVar("T")
_SECONDS_TO_END = 2.0


class BackgroundLoop:
    """An event loop in a thread of its own, started when it is first needed.

    Connections live in it from one call to the next. Safe to call from several threads.
    """

    def __init__(self) -> None:
        self._lock = Lock()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._process = 0
        self._thread: Thread | None = None

    def run(self, coroutine: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine to its end and return what it returns.

        An interrupt (Ctrl-C) while waiting cancels it.
        """
        try:
            future = asyncio.run_coroutine_threadsafe(coroutine, self._started())
        except BaseException:
            coroutine.close()
            raise
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise

    @property
    def fresh(self) -> bool:
        """Whether the next `run` starts a new loop: what lived in an old one is gone."""
        return self._loop is None or self._process != os.getpid()

    def close(self) -> None:
        """Cancel what still runs and end the thread. Can be called twice; `run` starts it again."""
        with self._lock:
            loop, self._loop = self._loop, None
        if loop is not None and self._process == os.getpid():
            asyncio.run_coroutine_threadsafe(_cancel_all(), loop)
            if self._thread is not None:
                self._thread.join(_SECONDS_TO_END)

    def _started(self) -> asyncio.AbstractEventLoop:
        with self._lock:
            # A forked process inherits the loop, but not the thread that runs it.
            if self._loop is None or self._process != os.getpid():
                self._loop, self._process = asyncio.new_event_loop(), os.getpid()
                self._thread = Thread(
                    target=_run, args=(self._loop,), name="tpvqa-vlm", daemon=True
                )
                self._thread.start()
            return self._loop


async def _cancel_all() -> None:
    others = asyncio.all_tasks() - {asyncio.current_task()}
    for task in others:
        task.cancel()
    await asyncio.gather(*others, return_exceptions=True)
    asyncio.get_running_loop().stop()


def _run(loop: asyncio.AbstractEventLoop) -> None:
    asyncio.set_event_loop(loop)
    try:
        loop.run_forever()
    finally:
        loop.close()
