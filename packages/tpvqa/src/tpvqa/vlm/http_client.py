"""The HTTP client for a server that is not trusted: no redirects, and replies of bounded size."""

from collections.abc import AsyncIterator, Awaitable, Callable
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime
from typing import TYPE_CHECKING, Any

from tpvqa.vlm.surroundings import why_no_client

if TYPE_CHECKING:
    from openai import DefaultAsyncHttpxClient

MOST_BYTES = 4 * 2**20
"""Of a reply in words: 2,000 tokens with 20 alternatives each have 3.5 MB."""


class ReplyTooLargeError(Exception):
    """A reply goes on beyond what it may have, or is compressed though nobody asked for that."""


def _bound(most: int) -> Callable[[Any], Awaitable[None]]:
    """Let no more be read of a response than it may have, and as what JSON is written in.

    Its class is httpx's or that of httpx's successor, whichever openai uses.
    """

    async def bound(response: Any) -> None:
        encoding = response.headers.get("content-encoding", "").strip().lower()
        if encoding not in ("", "identity"):  # a few bytes can become gigabytes
            raise ReplyTooLargeError("it is compressed, which was not asked for")
        response.encoding = "utf-8"  # JSON's; some a server may name take minutes to decode
        parts = response.aiter_raw

        async def bounded(chunk_size: int | None = None) -> AsyncIterator[bytes]:
            left = most
            async for part in parts(chunk_size):
                left -= len(part)
                if left < 0:
                    raise ReplyTooLargeError(f"it has more than {most // 2**20} MiB")
                yield part

        response.aiter_raw = bounded

    return bound


def seconds_to_wait(retry_after: str, now: datetime | None = None) -> float | None:
    """What the header Retry-After asks for, as seconds or as a date; None where it is neither."""
    if retry_after.replace(".", "", 1).isdecimal():
        return float(retry_after)
    try:
        until = parsedate_to_datetime(retry_after)
    except (ValueError, OverflowError):
        return None
    if until.tzinfo is None:
        until = until.replace(tzinfo=UTC)
    return max(0.0, (until - (now or datetime.now(UTC))).total_seconds())


def bounded_client(*, most: int = MOST_BYTES) -> "DefaultAsyncHttpxClient":
    """A client that sends to the address that it is given, and reads no more than it should.

    Args:
        most: How many bytes a reply may have.

    Raises:
        ValueError: There can be none with the environment's proxies or certificates. The message
            names what to mend.
    """
    from openai import DefaultAsyncHttpxClient

    try:
        return DefaultAsyncHttpxClient(
            follow_redirects=False,
            headers={"Accept-Encoding": "identity"},
            event_hooks={"response": [_bound(most)]},
        )
    except Exception as error:  # noqa: BLE001  httpx and ssl raise of many kinds
        raise ValueError(why_no_client(error)) from None
