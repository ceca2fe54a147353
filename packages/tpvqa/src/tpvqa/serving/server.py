"""The process that serves: its socket, and its end.

At the first Ctrl-C or SIGTERM no more questions are taken; those that wait are answered for some
seconds, and the rest is told that the server ends. The second ends it at once.
"""

import asyncio
import socket
from collections.abc import Callable
from types import FrameType
from typing import Self

import uvicorn

from tpvqa.errors import TpvqaError
from tpvqa.plugins import Closing
from tpvqa.serving.app import Endpoint, Limits
from tpvqa.serving.desk import Counts, Desk
from tpvqa.serving.door import Door, is_loopback
from tpvqa.vlm.protocol import VLM

_LAST_BYTES = 2
"""Seconds for replies that are being sent at the end."""
_IDLE = 60
"""Seconds until a connection without requests is closed."""
_MOST_CONNECTIONS = 500


class Serving:
    """A VLM behind an endpoint. Use it as a context manager, and call `run` in it.

    Args:
        vlm: Who answers; closed at the end.
        model: What it is called; its own name by default.
        host: Where to listen.
        port: The same; 0 for a free one.
        token: What whoever asks has to give; None for nothing.
        limits: How much is taken.

    Raises:
        TpvqaError: The address cannot be used, or it is not loopback and there is no token.
    """

    def __init__(
        self,
        vlm: VLM,
        *,
        model: str | None = None,
        host: str = "127.0.0.1",
        port: int = 8000,
        token: str | None = None,
        limits: Limits | None = None,
    ):
        if token is None and not is_loopback(host):
            raise TpvqaError(f"At {host} others can reach the server, so it needs a token.")
        self.model = model or vlm.name
        self._limits = limits or Limits()
        self._vlm, self._host = vlm, host
        self._desk = Desk(vlm, most=self._limits.waiting, patience=self._limits.patience)
        self._socket = _bound(host, port)
        app = Endpoint(self.model, self._desk, Door(token), self._limits).app
        self._server = _Server(
            uvicorn.Config(
                app,
                access_log=False,
                lifespan="off",
                limit_concurrency=_MOST_CONNECTIONS,
                log_config=None,
                proxy_headers=False,
                server_header=False,
                timeout_graceful_shutdown=_LAST_BYTES,
                timeout_keep_alive=_IDLE,
                ws="none",
            )
        )
        self._server.ended = self._end

    @property
    def address(self) -> str:
        """What a client is given as the base URL."""
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"http://{host}:{self._socket.getsockname()[1]}/v1"

    @property
    def counts(self) -> Counts:
        """What came of the questions so far."""
        return self._desk.counts

    def run(self, ready: Callable[[], None] = lambda: None) -> None:
        """Serve until a signal or `stop`.

        Args:
            ready: Called when questions are taken.
        """
        asyncio.run(self._run(ready))

    def stop(self) -> None:
        """End as at a signal; from any thread."""
        self._server.handle_exit(0, None)

    def close(self) -> None:
        """Let go of socket and VLM. Can be called twice."""
        self._socket.close()
        if isinstance(self._vlm, Closing):
            self._vlm.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    async def _run(self, ready: Callable[[], None]) -> None:
        self._loop = asyncio.get_running_loop()
        self._ending: asyncio.Task[None] | None = None
        self._desk.open()
        self._loop.call_soon(ready)  # the socket listens already
        await self._server.serve(sockets=[self._socket])
        self._desk.tell_all()

    def _end(self) -> None:
        """Begin to end, in whatever thread or signal."""

        def begin() -> None:
            self._desk.close()
            self._ending = self._loop.create_task(self._wind_down())

        self._loop.call_soon_threadsafe(begin)

    async def _wind_down(self) -> None:
        end = self._loop.time() + self._limits.ending
        while self._desk.waiting and self._loop.time() < end:
            await asyncio.sleep(0.02)
        self._desk.tell_all()
        self._server.should_exit = True


class _Server(uvicorn.Server):
    ended: Callable[[], None]
    _told = False

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        if self._told:
            self.should_exit = self.force_exit = True
        else:
            self._told = True
            self.ended()


def _bound(host: str, port: int) -> socket.socket:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        bound = socket.socket(family, kind, protocol)
    except OSError as error:
        raise TpvqaError(f"The host {host!r} is not known here ({error.strerror}).") from error
    try:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        bound.bind(address)
        bound.listen(socket.SOMAXCONN)
    except OSError as error:
        bound.close()
        raise TpvqaError(
            f"Port {port} at {host} cannot be used ({error.strerror}). Name another with --port, "
            "or 0 for a free one."
        ) from error
    return bound
