"""A proxy between client and server that spoils replies, on this machine."""

import asyncio
import socket
import struct
import threading
from collections.abc import Callable
from enum import StrEnum
from types import TracebackType
from urllib.parse import urlsplit


class Fault(StrEnum):
    """What the proxy does to a reply, or instead of passing the request on."""

    NONE = "none"
    DROPPED = "connection closed without a word"
    RESET = "connection reset"
    DELAYED = "delayed beyond the client's patience"
    TRUNCATED = "half of the body, then the end"
    TOO_LONG = "content-length larger than the body"
    TOO_SHORT = "content-length smaller than the body"
    BUSY = "429 with Retry-After"
    BROKEN = "500"
    GARBAGE = "200 with a body that is no JSON"
    HALF_JSON = "200 with half of the JSON, and a length that fits"
    EMPTY = "200 with an empty body"
    NO_HTTP = "bytes that are no HTTP"
    DRIP = "one byte after the other, slowly"


SLOW = 0.03
"""Seconds between the bytes of a drip: far more than the client waits for a whole reply."""

Chooser = Callable[[int], Fault]
"""Number of the request → what happens to it."""


class FaultyProxy:
    """Passes requests on to a server; use it as a context manager.

    Args:
        target: The server's base URL.
        choose: What happens to each request.
        delay: Seconds that a delayed reply is late.
    """

    def __init__(self, target: str, choose: Chooser, *, delay: float = 5.0):
        place = urlsplit(target)
        self._target = place.hostname or "", place.port or 0
        self._choose, self._delay = choose, delay
        self.met: list[Fault] = []
        self._ready = threading.Event()
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self._port}/v1"

    def __enter__(self) -> "FaultyProxy":
        self._thread.start()
        assert self._ready.wait(10)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._loop.call_soon_threadsafe(self._over.set)
        self._thread.join(10)
        assert not self._thread.is_alive()

    async def _serve(self) -> None:
        self._loop, self._over = asyncio.get_running_loop(), asyncio.Event()
        self._tasks: set[asyncio.Task[None]] = set()
        server = await asyncio.start_server(self._connected, "127.0.0.1", 0)
        self._port = server.sockets[0].getsockname()[1]
        self._ready.set()
        await self._over.wait()
        server.close()
        for task in self._tasks:
            task.cancel()
        await asyncio.gather(*self._tasks, return_exceptions=True)

    async def _connected(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        self._tasks.add(task)
        try:
            while await self._one(reader, writer):
                pass
        except (ConnectionError, asyncio.IncompleteReadError, asyncio.CancelledError):
            pass
        finally:
            self._tasks.discard(task)
            writer.close()

    async def _one(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> bool:
        """Meet one request; whether the connection may have another."""
        request = await _message(reader)
        fault = self._choose(len(self.met))
        self.met.append(fault)
        if fault is Fault.DROPPED:
            return False
        if fault is Fault.RESET:
            linger = struct.pack("ii", 1, 0)
            writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, linger)
            return False
        if fault is Fault.NO_HTTP:
            writer.write(b"\x16\x03\x01 yes yes yes\r\n\r\n")
            await writer.drain()
            return False
        if fault is Fault.BUSY:
            return await _send(writer, "429 Too Many Requests", b"{}", b"Retry-After: 0.01\r\n")
        if fault is Fault.BROKEN:
            return await _send(writer, "500 Internal Server Error", b'{"error": {"message": "no"}}')
        if fault is Fault.GARBAGE:
            return await _send(writer, "200 OK", b'yes {"choices": yes}')
        if fault is Fault.EMPTY:
            return await _send(writer, "200 OK", b"")
        reply = await self._passed_on(request)
        return await self._spoilt(writer, fault, reply)

    async def _passed_on(self, request: bytes) -> bytes:
        """The reply of the server: its head and its body."""
        reader, writer = await asyncio.open_connection(*self._target)
        try:
            writer.write(request)
            await writer.drain()
            return await _message(reader)
        finally:
            writer.close()

    async def _spoilt(self, writer: asyncio.StreamWriter, fault: Fault, reply: bytes) -> bool:
        head, _, body = reply.partition(b"\r\n\r\n")
        if fault is Fault.DELAYED:
            await asyncio.sleep(self._delay)
        elif fault is Fault.HALF_JSON:
            return await _send(writer, "200 OK", body[: len(body) // 2])
        elif fault is Fault.TRUNCATED:
            writer.write(head + b"\r\n\r\n" + body[: len(body) // 2])
            await writer.drain()
            return False
        elif fault in (Fault.TOO_LONG, Fault.TOO_SHORT):
            length = len(body) + (100 if fault is Fault.TOO_LONG else -len(body) // 3)
            await _send(writer, "200 OK", body, length=length)
            await asyncio.sleep(self._delay if fault is Fault.TOO_LONG else 0)
            return False
        elif fault is Fault.DRIP:
            for at in range(len(reply)):
                writer.write(reply[at : at + 1])
                await writer.drain()
                await asyncio.sleep(SLOW)
            return True
        writer.write(reply)
        await writer.drain()
        return True


async def _message(reader: asyncio.StreamReader) -> bytes:
    """A request or a reply with its body."""
    head = await reader.readuntil(b"\r\n\r\n")
    for line in head.decode("latin-1").lower().split("\r\n"):
        if line.startswith("content-length:"):
            return head + await reader.readexactly(int(line.partition(":")[2]))
    return head


async def _send(
    writer: asyncio.StreamWriter,
    status: str,
    body: bytes,
    headers: bytes = b"",
    length: int | None = None,
) -> bool:
    size = len(body) if length is None else length
    head = f"HTTP/1.1 {status}\r\nContent-Type: application/json\r\nContent-Length: {size}\r\n"
    writer.write(head.encode() + headers + b"\r\n" + body)
    await writer.drain()
    return True
