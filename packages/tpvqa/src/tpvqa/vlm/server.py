"""One request to a server: what it says, or why it says nothing."""

import asyncio
import os
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from tpvqa.errors import AnswerError
from tpvqa.vlm.answer import Reply
from tpvqa.vlm.chat_completions import Dialect, Inquiry, complaint, messages, refuses_form
from tpvqa.vlm.connection import Connection
from tpvqa.vlm.http_client import ReplyTooLargeError, bounded_client, seconds_to_wait
from tpvqa.vlm.prompt import Prompt
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.server_text import ServerText
from tpvqa.vlm.surroundings import check_headers, innermost

if TYPE_CHECKING:
    from openai import APIStatusError, AsyncOpenAI


class Retry(Exception):  # noqa: N818 — a request to try again, not an error
    def __init__(self, why: str, *, pause: float | None = None, no_server: str = ""):
        super().__init__(why)
        self.why, self.pause, self.no_server = why, pause, no_server


UNDECODED = (AssertionError, LookupError, RecursionError, ValueError)
"""What openai's package raises of an error's body that says nothing it can read."""
_HUNG_UP = "Server disconnected"
"""How httpx begins to say that there was no reply at all, by the same error as of a broken one."""


class Server:
    """A server at an address, asked for one model.

    Args:
        model: As the server knows it.
        base_url: The address; None for OpenAI's.
        timeout: Seconds for one request.
    """

    def __init__(self, model: str, base_url: str | None, timeout: float):
        self.model, self.base_url, self._request_timeout = model, base_url, timeout
        self.text = ServerText("")
        self._connection: Connection | None = None
        self._speaks = False  # once a reply was neither a web page nor broken HTTP

    def close(self) -> None:
        """Close the connections. Can be called twice."""
        if self._connection is not None:
            self._connection.close()

    def connect(self) -> Connection:
        """The connection, made where there is none.

        Raises:
            AnswerError: There is no key, the address cannot be used, or the environment holds
                what cannot be sent.
        """
        if self._connection is None or not self._connection.alive:
            import openai

            key = os.environ.get("OPENAI_API_KEY", "").strip()
            if not key and self.base_url is None:
                raise AnswerError(
                    "OpenAI needs a key. Set the environment variable OPENAI_API_KEY, or name a "
                    "server of your own by --base-url."
                )
            self.text = ServerText(key)
            try:
                check_headers(key)
                http = bounded_client()
            except ValueError as error:
                raise AnswerError(f"{self.where()} cannot be asked: {error}") from None
            try:
                client = openai.AsyncOpenAI(
                    api_key=key or "none-needed",
                    base_url=self.base_url,
                    max_retries=0,
                    http_client=http,
                )
            except (openai.OpenAIError, ValueError) as error:
                raise AnswerError(f"{self.where()} cannot be asked: {error}") from error
            self._connection = Connection(client)
        return self._connection

    async def send(
        self,
        client: "AsyncOpenAI",
        inquiry: Inquiry,
        prompt: Prompt,
        dialect: Dialect,
        samples: int,
    ) -> bytes | Reading | str:
        """The body of a reply, an unknown answer, or what the server complains of.

        Raises:
            Retry: It may do better when asked again.
            AnswerError: Asking again does not help.
        """
        import openai

        count = len(inquiry.texts) if inquiry.together else 0
        parameters: dict[str, Any] = dialect.parameters(count, samples)
        said: Any = messages(inquiry, prompt)
        try:
            async with asyncio.timeout(self._request_timeout):
                response = await client.chat.completions.with_raw_response.create(
                    model=self.model,
                    messages=said,
                    timeout=self._request_timeout,
                    **parameters,
                )
        except (TimeoutError, openai.APITimeoutError):
            raise Retry(f"late: nothing within {self._request_timeout:g} s") from None
        except (openai.APIConnectionError, ReplyTooLargeError) as error:
            for cause in (error, error.__cause__):
                if isinstance(cause, ReplyTooLargeError):
                    return Reading(Reply.UNKNOWN, text=f"garbled reply: {cause}")
            cause = innermost(error.__cause__ or error)
            # httpx's, or that of its successor: nothing was sent, so asking again does not help
            if type(cause).__name__ == "LocalProtocolError":
                raise cause from None
            why = str(cause) or type(cause).__name__
            if type(cause).__name__ != "RemoteProtocolError" or why.startswith(_HUNG_UP):
                raise Retry(f"no connection: {why}", no_server="cannot be reached") from None
            no_server = "" if self._speaks else "answers with broken HTTP"
            raise Retry(f"garbled reply: {why}", no_server=no_server) from None
        except openai.APIStatusError as error:
            with suppress(RecursionError):
                return self._refused(error)
            return Reading(Reply.UNKNOWN, text="garbled reply: nested too deeply")
        except UnicodeEncodeError:  # nothing was sent, so this is no answer of the server's
            raise
        except UNDECODED as error:
            return Reading(Reply.UNKNOWN, text=f"garbled reply: {type(error).__name__}: {error}")
        if "html" in response.headers.get("content-type", ""):
            if self._speaks:  # the address is right: a gateway's page of errors
                return Reading(Reply.UNKNOWN, text="garbled reply: a web page")
            raise AnswerError(
                f"{self.where()} answers with a web page. Is the path right (usually /v1)?"
            )
        self._speaks = True
        content: bytes = response.content
        return content

    def _refused(self, error: "APIStatusError") -> Reading | str:
        status, parts = error.status_code, complaint(error.body)
        said = ", ".join(part.rstrip(". ") for part in parts.values()) or f"HTTP status {status}"
        if any("content_" in value for key, value in parts.items() if key in ("code", "type")):
            return Reading(Reply.UNKNOWN, text=f"refused: {said}")
        if 300 <= status < 400:
            there = error.response.headers.get("location", "elsewhere")
            raise AnswerError(
                f"{self.where()} sends requests on to {there[:200]}, and pictures are not sent to "
                "another address than the one given. Give the right one by --base-url."
            )
        if refuses_form(status, said):
            return said
        if status in (401, 403):
            raise AnswerError(
                f"{self.where()} refuses the key (HTTP status {status}). Set the environment "
                f"variable OPENAI_API_KEY to one that may use {self.model!r}."
            )
        if status == 404:
            raise AnswerError(
                f"{self.where()} has no model {self.model!r}, or not at this path, which "
                f"usually ends with /v1: {said}"
            )
        if "insufficient_quota" in parts.values():
            raise AnswerError(f"{self.where()}: the account has no credit left. {said}")
        if status in (408, 409, 429) or status >= 500:
            pause = seconds_to_wait(error.response.headers.get("retry-after", ""))
            raise Retry(f"HTTP status {status}: {said}", pause=pause)
        raise AnswerError(f"{self.where()} refuses to be asked (HTTP status {status}): {said}")

    def where(self) -> str:
        """The address, for messages."""
        return self.base_url or "OpenAI's server"
