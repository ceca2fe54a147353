"""Asynchronous calls to a server from synchronous code, also where an event loop already runs."""

import os
from collections.abc import Awaitable, Callable
from concurrent.futures import Future
from threading import Thread
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from anyio.from_thread import BlockingPortal
    from openai import AsyncOpenAI

T = TypeVar("T")


class Connection:
    """A client, and the event loop in a thread that its connections live in between two calls.

    The loop is anyio's blocking portal. `anyio.from_thread.start_blocking_portal` is not used, as
    a forked process, which has the portal without its thread, hangs where it lets go of that.

    Args:
        client: Closed with the loop.
    """

    def __init__(self, client: "AsyncOpenAI"):
        self.client, self._process = client, os.getpid()
        started: Future[BlockingPortal] = Future()
        self._thread = Thread(target=_serve, args=(started,), name="tpvqa-vlm", daemon=True)
        self._thread.start()
        self._portal = started.result()

    @property
    def alive(self) -> bool:
        """Whether the loop runs, and in this process."""
        return self._process == os.getpid() and self._thread.is_alive()

    def run(self, function: Callable[..., Awaitable[T]], *arguments: object) -> T:
        """What a function returns; an interrupt (Ctrl-C) while waiting cancels it."""
        future = self._portal.start_task_soon(function, *arguments)
        try:
            return future.result()
        except BaseException:
            future.cancel()
            raise

    def close(self) -> None:
        """Cancel what still runs, and end the loop. Can be called twice."""
        if self.alive:
            self.run(self.client.close)
            self.run(self._portal.stop, True)
            self._thread.join()


def _serve(started: "Future[BlockingPortal]") -> None:
    import anyio
    from anyio.from_thread import BlockingPortal

    async def serve() -> None:
        async with BlockingPortal() as portal:
            started.set_result(portal)
            await portal.sleep_until_stopped()

    try:
        anyio.run(serve)
    except BaseException as error:  # noqa: BLE001  told to whoever waits for the portal
        if not started.done():
            started.set_exception(error)
