"""The images API of OpenAI and of servers that speak it: variations, edits, generations."""

import asyncio
import importlib.util
import os
import time
import uuid
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, NoReturn

from tpvqa.addresses import checked_address
from tpvqa.chance import chance
from tpvqa.errors import GeneratorError, MissingExtraError, PictureRefused
from tpvqa.pictures import MOST_BYTES
from tpvqa.vlm.connection import Connection
from tpvqa.vlm.http_client import ReplyTooLargeError, bounded_client, seconds_to_wait
from tpvqa.vlm.server import UNDECODED
from tpvqa.vlm.server_text import ServerText
from tpvqa.vlm.surroundings import check_headers, innermost
from tpvqa.worlds.pictures import digest
from tpvqa_household.images.sources.generator import Drawn, Original
from tpvqa_household.images.sources.images_reply import (
    Elsewhere,
    complaint,
    read_reply,
    whole,
)
from tpvqa_household.images.sources.picture_file import as_png, read_picture, square

if TYPE_CHECKING:
    from openai import APIStatusError

SIDE = 512
"""Of a picture that is sent, and of what DALL-E 2 is asked for."""
_LONGEST_PAUSE = 30.0
_LARGEST = 2 * MOST_BYTES  # of a reply: in base64 a picture takes a third more


class _Again(Exception):  # noqa: N818 — a request to try again, not an error
    def __init__(self, why: str, *, pause: float | None = None, garbled: bool = False):
        super().__init__(why)
        self.why, self.pause, self.garbled = why, pause, garbled


class OpenAIImages:
    """Asks a server for one picture a request.

    DALL-E 2 varies a picture without words, as the paper had it done; every other model is asked
    to edit it, with a prompt. The API knows no seeds: a seed only tells one request from another.
    Requests carry a key of their own (`Idempotency-Key`), so that a server that knows this header
    makes, and charges, a picture once however often it is asked for. The key of the account comes
    from the environment only (`OPENAI_API_KEY`) and is sent to no address that a reply names.

    Args:
        model: The model's name, as the server knows it.
        base_url: The server's address with its path, e.g. "http://localhost:8000/v1"; by default
            `OPENAI_BASE_URL`, or else OpenAI's.
        price: Dollars a picture, if known.
        per_minute: Requests a minute at most; None for no limit but the server's.
        size: What is asked for, e.g. "1024x1024"; by default 512x512 of DALL-E 2, and of others
            what they make.
        deadline: Seconds for one picture with all that is tried again.
        request_timeout: Seconds for one request.
        retries: How often a request is repeated after 408, 409, 429, 5xx, a broken connection, a
            timeout or a garbled reply.

    Raises:
        MissingExtraError: The `openai` package is not installed.
        GeneratorError: The address is not one.
    """

    remote = True

    def __init__(
        self,
        model: str,
        *,
        base_url: str | None = None,
        price: float | None = None,
        per_minute: float | None = None,
        size: str | None = None,
        deadline: float = 300.0,
        request_timeout: float = 120.0,
        retries: int = 5,
    ) -> None:
        if importlib.util.find_spec("openai") is None:
            raise MissingExtraError("openai", "openai", f"The generator 'openai:{model}'")
        self.model, self.price, self.requests = model, price, 0
        self.base_url = base_url or os.environ.get("OPENAI_BASE_URL") or None
        if self.base_url:
            try:
                checked_address(self.base_url)
            except ValueError as error:
                raise GeneratorError(f"openai:{model}: {error}.") from None
        self._text = ServerText("")
        self._size = size or ("512x512" if model == "dall-e-2" else None)
        self._deadline, self._request_timeout = deadline, request_timeout
        self._retries = retries
        self._spacing = 60.0 / per_minute if per_minute else 0.0
        self._next_turn = 0.0
        self._connection: Connection | None = None

    @property
    def name(self) -> str:
        """ "openai:MODEL"."""
        return f"openai:{self.model}"

    @property
    def settings(self) -> str:
        """The size that is asked for."""
        return self._size or ""

    def vary(self, original: Original, *, seed: int) -> Drawn:
        """A variation of a picture, or an edit by its prompt."""
        png = as_png(square(read_picture(original.data), SIDE))
        sent: dict[str, Any] = {"image": ("picture.png", png, "image/png"), **self._form()}
        images = self._connect().client.images.with_raw_response
        ask: Callable[..., Any] = images.create_variation
        if self.model != "dall-e-2":
            ask = images.edit
            sent["prompt"] = original.prompt
        return self._insist(ask, sent, seed, of=digest(original.data))

    def generate(self, prompt: str, *, seed: int) -> Drawn:
        """A picture from words."""
        images = self._connect().client.images.with_raw_response
        return self._insist(images.generate, {"prompt": prompt, **self._form()}, seed, of="")

    def close(self) -> None:
        """Close the connections. Can be called twice."""
        connection, self._connection = self._connection, None
        if connection is not None:
            connection.close()

    def _form(self) -> dict[str, Any]:
        form: dict[str, Any] = {"model": self.model, "n": 1}
        if self._size:
            form["size"] = self._size
        if self.model.startswith("dall-e"):
            # Others refuse to be told; these would give an address that soon forgets the picture.
            form["response_format"] = "b64_json"
        return form

    def _connect(self) -> Connection:
        if self._connection is None:
            import openai

            key = os.environ.get("OPENAI_API_KEY", "").strip()
            if not key and self.base_url is None:
                raise GeneratorError(
                    "OpenAI needs a key. Set the environment variable OPENAI_API_KEY, or name a "
                    "server of your own by --base-url."
                )
            self._text = ServerText(key)
            try:
                check_headers(key)
                client = openai.AsyncOpenAI(
                    api_key=key or "none-needed",
                    base_url=self.base_url,
                    max_retries=0,
                    http_client=bounded_client(most=_LARGEST),
                )
            except (openai.OpenAIError, ValueError) as error:
                raise GeneratorError(f"{self._where()} cannot be asked: {error}") from error
            self._connection = Connection(client)
        return self._connection

    def _insist(
        self, ask: Callable[..., Any], sent: dict[str, Any], seed: int, *, of: str
    ) -> Drawn:
        """Ask for one picture; the one place that all that a server says comes out of."""
        try:
            return self._drawn(ask, sent, seed, of=of)
        except GeneratorError as error:
            raise type(error)(self._text(str(error))) from None

    def _drawn(self, ask: Callable[..., Any], sent: dict[str, Any], seed: int, *, of: str) -> Drawn:
        """Ask for one picture, again after failures that may pass."""
        time.sleep(max(0.0, self._next_turn - time.monotonic()))
        end = time.monotonic() + self._deadline
        found: bytes | Elsewhere | None = None
        times = garbled = 0
        while True:
            # The same for each repetition, in a later process too; but a garbled picture would
            # only be given again.
            decides = (self.name, self.settings, sent.get("prompt"), of, seed, garbled)
            key = str(uuid.uuid5(uuid.NAMESPACE_OID, repr(decides)))
            try:
                if found is None:
                    headers = {"extra_headers": {"Idempotency-Key": key}}
                    found = self._request(ask, {**sent, **headers}, end)
                if isinstance(found, Elsewhere):
                    found = self._fetch(found, end)
                return Drawn(found)
            except _Again as again:
                times, garbled = times + 1, garbled + again.garbled
                why = again.why if times == 1 else f"{again.why}, {times} times"
                if times > self._retries:
                    raise GeneratorError(f"{self._where()}: {why}") from None
                pause = _pause(again, times - 1, seed)
                if found is None:
                    pause = max(pause, self._next_turn - time.monotonic())
                if time.monotonic() + pause >= end:
                    raise GeneratorError(
                        f"{self._where()}: {why}; asking again in {pause:.1f} s would be later "
                        f"than the {self._deadline:g} s that one picture has"
                    ) from None
                time.sleep(pause)

    def _request(self, ask: Callable[..., Any], sent: dict[str, Any], end: float) -> Any:
        import openai

        self._next_turn = time.monotonic() + self._spacing
        timeout = max(0.1, min(self._request_timeout, end - time.monotonic()))
        self.requests += 1
        try:
            return read_reply(self._connect().run(_asked, ask, sent, timeout))
        except (TimeoutError, openai.APITimeoutError):
            raise _Again(f"late: not whole within {timeout:g} s") from None
        except (openai.APIConnectionError, ReplyTooLargeError) as error:
            cause = innermost(error.__cause__ or error)
            if isinstance(cause, ReplyTooLargeError):
                raise _Again(f"garbled reply: {cause}", garbled=True) from None
            raise _Again(f"no connection: {str(cause) or type(cause).__name__}") from None
        except openai.APIStatusError as error:
            self._refused(error)
        except UNDECODED as error:
            raise _Again(str(error), garbled=True) from None

    def _fetch(self, at: Elsewhere, end: float) -> bytes:
        timeout = max(0.1, min(self._request_timeout, end - time.monotonic()))
        try:
            return whole(self._connect().run(_fetched, at.url, timeout))
        except TimeoutError:
            raise _Again(f"the picture's address: not whole within {timeout:g} s") from None
        except ReplyTooLargeError as error:
            raise GeneratorError(f"{at.url}: {error}") from None
        except Exception as error:  # noqa: BLE001  of httpx, or of its successor
            raise _Again(f"the picture's address: {error}") from None

    def _refused(self, error: "APIStatusError") -> NoReturn:
        status, parts = error.status_code, complaint(error.body)
        said = ", ".join(parts.values()) or f"HTTP status {status}"
        reasons = {parts.get("code", ""), parts.get("type", "")}
        if any(word in reason for reason in reasons for word in ("content_", "moderation")):
            raise PictureRefused(f"refused: {said}")
        if status in (401, 403):
            raise GeneratorError(
                f"{self._where()} refuses the key (HTTP status {status}). Set the environment "
                f"variable OPENAI_API_KEY to one that may use {self.model!r}."
            )
        if status == 404:
            raise GeneratorError(
                f"{self._where()} has no model {self.model!r}, or no images API at this path, "
                f"which usually ends with /v1: {said}"
            )
        if reasons & {"insufficient_quota", "billing_hard_limit_reached"}:
            raise GeneratorError(f"{self._where()}: the account has no credit left. {said}")
        if status in (408, 409, 429) or status >= 500:
            pause = seconds_to_wait(error.response.headers.get("retry-after", ""))
            raise _Again(f"HTTP status {status}: {said}", pause=pause)
        raise GeneratorError(f"{self._where()} refuses to be asked (HTTP status {status}): {said}")

    def _where(self) -> str:
        return self.base_url or "OpenAI's server"


def _pause(again: _Again, attempt: int, seed: int) -> float:
    """Seconds until the next attempt: what the server asked for, or twice as long each time."""
    if again.pause is not None:
        return again.pause
    spread = 0.75 + 0.5 * chance(0, 0, "pause", seed, attempt).random()
    return float(min(_LONGEST_PAUSE, 0.5 * 2**attempt * spread))


async def _asked(ask: Callable[..., Any], sent: Mapping[str, Any], seconds: float) -> bytes:
    """The body of a reply. The client's own limit is of each part, which may be a byte."""
    async with asyncio.timeout(seconds):
        reply = await ask(**sent, timeout=seconds)
    content: bytes = reply.content
    return content


async def _fetched(url: str, seconds: float) -> bytes:
    async with asyncio.timeout(seconds), bounded_client(most=_LARGEST) as client:
        reply = await client.get(url, timeout=seconds, follow_redirects=True)
    reply.raise_for_status()
    content: bytes = reply.content
    return content
