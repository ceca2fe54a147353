"""Any OpenAI-compatible server as the VLM: OpenAI, vLLM, llama.cpp, Ollama, LM Studio, ..."""

import asyncio
import hashlib
import importlib.util
import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from tpvqa.addresses import checked_address
from tpvqa.chance import chance
from tpvqa.errors import AnswerError, MissingExtraError, PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.plugins import PlainArguments
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures
from tpvqa.vlm.chat_completions import (
    INSTRUCTION,
    Dialect,
    Reading,
    complaint,
    messages,
    read_completion,
    refuses_form,
)
from tpvqa.vlm.connection import Connection
from tpvqa.vlm.pictures import grey_frame
from tpvqa.vlm.server_text import ServerText

if TYPE_CHECKING:
    from openai import APIStatusError, AsyncOpenAI

_LONGEST_PAUSE = 8.0


@dataclass(frozen=True, slots=True)
class _TimedReading:
    reading: Reading
    seconds: float
    unreachable: bool = False
    final: bool = True  # a failure may pass; a reading stays


class _Retry(Exception):  # noqa: N818 — a request to try again, not an error
    def __init__(self, why: str, *, pause: float | None = None, unreachable: bool = False):
        super().__init__(why)
        self.why, self.pause, self.unreachable = why, pause, unreachable


class OpenAICompatibleVLM(NeedsPictures, PlainArguments):
    """Asks a server with the pictures and one question a request, several at a time.

    P(yes) comes from the logprobs of the first answer token, P(yes) = yes / (yes + no) summed
    over case and leading-space variants (`Answer.source` is "logprobs"); servers and reasoning
    models that give none are read by their bare word, without a probability ("word"). Whatever
    is not clearly yes or no, is missing, garbled, refused or late is *unknown*, with the reason
    as the answer's text. What a server refuses (logprobs, a length limit, a temperature) is left
    out from then on.

    The key comes from the environment only (`OPENAI_API_KEY`); servers that need none are asked
    without. Within an observation the same question is asked once.

    Args:
        model: The model's name, as the server knows it.
        base_url: The server's address with its path, e.g. "http://localhost:8000/v1"; by default
            `OPENAI_BASE_URL`, or else OpenAI's.
        concurrency: How many requests may be under way at once.
        deadline: Seconds for all questions of a call together; what is missing then is *unknown*.
        request_timeout: Seconds for one request before it is tried again.
        retries: How often a request is repeated after 408, 409, 429, 5xx, a broken connection
            or a timeout.
        instruction: What is said after each question.

    Raises:
        MissingExtraError: The `openai` package is not installed.
        AnswerError: The address is not one, or holds a password.
    """

    def __init__(
        self,
        model: str,
        *,
        base_url: str | None = None,
        concurrency: int = 4,
        deadline: float = 60.0,
        request_timeout: float = 30.0,
        retries: int = 3,
        instruction: str = INSTRUCTION,
    ) -> None:
        if importlib.util.find_spec("openai") is None:
            raise MissingExtraError("openai", "openai", f"The VLM 'openai:{model}'")
        self.model = model
        self.base_url = base_url or os.environ.get("OPENAI_BASE_URL") or None
        if self.base_url:
            try:
                checked_address(self.base_url)
            except ValueError as error:
                raise AnswerError(f"openai:{model}: {error}.") from None
        self._concurrency, self._deadline = concurrency, deadline
        self._request_timeout, self._retries = request_timeout, retries
        self._instruction = instruction
        self._dialect = Dialect()
        self._text = ServerText("")
        self._connection: Connection | None = None
        self._looked_at: tuple[object, ...] = ()
        self._known: dict[str, _TimedReading] = {}

    @classmethod
    def from_spec(cls, arguments: str, *, base_url: str | None = None) -> "OpenAICompatibleVLM":
        """Make it from the model's name, which may have colons itself.

        Raises:
            PluginError: No model is named.
        """
        if not arguments:
            raise PluginError(
                "'openai' does not say which model. Write openai:MODEL, and --base-url for a "
                "server of your own."
            )
        return cls(arguments, base_url=base_url)

    @property
    def name(self) -> str:
        """ "openai:MODEL"."""
        return f"openai:{self.model}"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        """Answer every question, in order.

        Raises:
            AnswerError: Nothing answers at the address, the key is refused, the model does not
                exist or takes no pictures, or the observation has none.
        """
        frames = tuple(observation.frames.values())
        if not frames:
            raise AnswerError(
                f"{self.name} looks at pictures, and this world shows none. Choose a world with "
                "pictures, or a noise model such as oracle:0.9."
            )
        looked_at = (observation.look, *(hashlib.sha256(frame.data).digest() for frame in frames))
        if looked_at != self._looked_at:
            self._looked_at, self._known = looked_at, {}
        asked = dict.fromkeys(question.text for question in questions)
        missing = [text for text in asked if text not in self._known]
        outcomes = self._ask_all(frames, missing)
        now = self._known | dict(zip(missing, outcomes, strict=True))
        self._known = {text: outcome for text, outcome in now.items() if outcome.final}
        return [_answer(question, now[question.text]) for question in questions]

    def check(self) -> None:
        """Ask one question about a grey picture, whatever the answer.

        Raises:
            AnswerError: As `ask` does.
        """
        self._ask_all((grey_frame(),), ("Is this picture grey?",))

    def close(self) -> None:
        """Close the connections. Can be called twice."""
        if self._connection is not None:
            self._connection.close()

    def _connect(self) -> Connection:
        if self._connection is None or not self._connection.alive:
            import openai

            from tpvqa.vlm.http_client import bounded_client

            key = os.environ.get("OPENAI_API_KEY", "").strip()
            if not key and self.base_url is None:
                raise AnswerError(
                    "OpenAI needs a key. Set the environment variable OPENAI_API_KEY, or name a "
                    "server of your own by --base-url."
                )
            if not key.isascii():
                raise AnswerError("OPENAI_API_KEY has characters that no key has. Set it again.")
            self._text = ServerText(key)
            try:
                client = openai.AsyncOpenAI(
                    api_key=key or "none-needed",
                    base_url=self.base_url,
                    max_retries=0,
                    http_client=bounded_client(),
                )
            except (openai.OpenAIError, ValueError) as error:
                raise AnswerError(f"{self._where()} cannot be asked: {error}") from error
            self._connection = Connection(client)
        return self._connection

    def _ask_all(self, frames: Sequence[Frame], texts: Sequence[str]) -> list[_TimedReading]:
        """Ask; the one place that all that a server says comes out of."""
        connection = self._connect()
        try:
            outcomes = connection.run(self._ask_side_by_side, connection.client, frames, texts)
        except AnswerError as error:
            raise AnswerError(self._text(str(error))) from None
        except Exception as error:  # noqa: BLE001  its text may be the server's
            why = self._text(f"{type(error).__name__}: {error}")
            raise AnswerError(f"{self._where()} cannot be asked: {why}") from None
        return [
            replace(each, reading=replace(each.reading, text=self._text(each.reading.text)))
            for each in outcomes
        ]

    async def _ask_side_by_side(
        self, client: "AsyncOpenAI", frames: Sequence[Frame], texts: Sequence[str]
    ) -> list[_TimedReading]:
        turn = asyncio.Semaphore(self._concurrency)
        end = asyncio.get_running_loop().time() + self._deadline

        async def one(text: str) -> _TimedReading:
            started = time.monotonic()
            failures: list[_Retry] = []
            try:
                async with asyncio.timeout_at(end), turn:
                    started = time.monotonic()
                    return await self._ask_with_retries(client, frames, text, failures, end)
            except TimeoutError:
                why = f"late: nothing within {self._deadline:g} s"
                if failures:
                    why += f"; before that {failures[-1].why}"
                late = Reading(Reply.UNKNOWN, text=why)
                return _TimedReading(late, time.monotonic() - started, final=False)

        try:
            async with asyncio.TaskGroup() as asking:
                tasks = [asking.create_task(one(text)) for text in texts]
        except ExceptionGroup as group:  # what is raised in an `except*` stays in a group
            refused, other = group.split(AnswerError)
            if refused is None or other is not None:
                raise
            raise refused.exceptions[0] from None
        outcomes = [task.result() for task in tasks]
        if outcomes and all(outcome.unreachable for outcome in outcomes):
            raise AnswerError(
                f"{self._where()} cannot be reached ({outcomes[0].reading.text}). Is the server "
                "running, and is the address right, with its path (usually /v1)?"
            )
        return outcomes

    async def _ask_with_retries(
        self,
        client: "AsyncOpenAI",
        frames: Sequence[Frame],
        text: str,
        failures: list[_Retry],
        end: float,
    ) -> _TimedReading:
        """Ask one question, again after failures that may pass.

        Args:
            client: The connection.
            frames: The pictures.
            text: The question.
            failures: Grows by what failed, so that the reason is known where the time ends.
            end: The deadline, by the loop's clock. No pause begins that would go beyond it.
        """
        started = time.monotonic()
        while True:
            try:
                reading = await self._ask_as_understood(client, frames, text)
                return _TimedReading(reading, time.monotonic() - started)
            except _Retry as retry:
                failures.append(retry)
            last, times = failures[-1], len(failures)
            why = last.why if times == 1 else f"{last.why}, {times} times"
            if times <= self._retries:
                pause = _pause(last, times - 1, text)
                if asyncio.get_running_loop().time() + pause < end:
                    await asyncio.sleep(pause)
                    continue
                why += (
                    f"; asking again in {round(pause, 1):g} s would be later than the "
                    f"{self._deadline:g} s that all questions have"
                )
            return _TimedReading(
                Reading(Reply.UNKNOWN, text=why),
                time.monotonic() - started,
                unreachable=last.unreachable,
                final=False,
            )

    async def _ask_as_understood(
        self, client: "AsyncOpenAI", frames: Sequence[Frame], text: str
    ) -> Reading:
        """Ask one question, finding out what the server understands."""
        dialect = self._dialect
        while True:
            said = await self._request(client, frames, text, dialect)
            if isinstance(said, Reading):
                self._dialect = dialect
                longer = dialect.with_room_to_think() if said.cut_short else None
                if longer is None:
                    return said
                dialect = longer
                continue
            next_dialect = dialect.after_refusal(said)
            if next_dialect is None and dialect != dialect.bare():
                next_dialect = dialect.bare()
            if next_dialect is None:
                raise AnswerError(
                    f"{self._where()} refuses to be asked: {said}. Does the model {self.model!r} "
                    "take pictures?"
                )
            dialect = next_dialect

    async def _request(
        self, client: "AsyncOpenAI", frames: Sequence[Frame], text: str, dialect: Dialect
    ) -> Reading | str:
        """One request; what the server complains of where it refuses its form."""
        import openai

        from tpvqa.vlm.http_client import ReplyTooLargeError

        parameters: dict[str, Any] = dialect.parameters()
        try:
            async with asyncio.timeout(self._request_timeout):
                response = await client.chat.completions.with_raw_response.create(
                    model=self.model,
                    messages=messages(frames, text, self._instruction),  # type: ignore[arg-type]
                    timeout=self._request_timeout,
                    **parameters,
                )
        except (TimeoutError, openai.APITimeoutError):
            raise _Retry(f"late: nothing within {self._request_timeout:g} s") from None
        except (openai.APIConnectionError, ReplyTooLargeError) as error:
            for cause in (error, error.__cause__):
                if isinstance(cause, ReplyTooLargeError):
                    return Reading(Reply.UNKNOWN, text=f"garbled reply: {cause}")
            why = str(error.__cause__ or error) or type(error.__cause__).__name__
            raise _Retry(f"no connection: {why}", unreachable=True) from None
        except openai.APIStatusError as error:
            return self._refused(error)
        if "html" in response.headers.get("content-type", ""):
            raise AnswerError(
                f"{self._where()} answers with a web page. Is the path right (usually /v1)?"
            )
        return read_completion(response.content, text)

    def _refused(self, error: "APIStatusError") -> Reading | str:
        status, parts = error.status_code, complaint(error.body)
        said = ", ".join(parts.values()) or f"HTTP status {status}"
        if any("content_" in value for key, value in parts.items() if key in ("code", "type")):
            return Reading(Reply.UNKNOWN, text=f"refused: {said}")
        if 300 <= status < 400:
            there = error.response.headers.get("location", "elsewhere")
            raise AnswerError(
                f"{self._where()} sends requests on to {there[:200]}, and pictures are not sent to "
                "another address than the one given. Give the right one by --base-url."
            )
        if refuses_form(status, said):
            return said
        if status in (401, 403):
            raise AnswerError(
                f"{self._where()} refuses the key (HTTP status {status}). Set the environment "
                f"variable OPENAI_API_KEY to one that may use {self.model!r}."
            )
        if status == 404:
            raise AnswerError(
                f"{self._where()} has no model {self.model!r}, or not at this path, which "
                f"usually ends with /v1: {said}"
            )
        if "insufficient_quota" in parts.values():
            raise AnswerError(f"{self._where()}: the account has no credit left. {said}")
        if status in (408, 409, 429) or status >= 500:
            pause = error.response.headers.get("retry-after", "")
            wanted = float(pause) if pause.replace(".", "", 1).isdecimal() else None
            raise _Retry(f"HTTP status {status}: {said}", pause=wanted)
        raise AnswerError(f"{self._where()} refuses to be asked (HTTP status {status}): {said}")

    def _where(self) -> str:
        return self.base_url or "OpenAI's server"


def _pause(retry: _Retry, attempt: int, text: str) -> float:
    """Seconds until the next attempt: what the server asked for, or twice as long each time."""
    if retry.pause is not None:
        return retry.pause
    spread = 0.75 + 0.5 * chance(0, 0, "pause", text, attempt).random()
    return float(min(_LONGEST_PAUSE, 0.5 * 2**attempt * spread))


def _answer(question: Question, outcome: _TimedReading) -> Answer:
    reading = outcome.reading
    return Answer(
        question=question,
        reply=reading.reply,
        p_yes=reading.p_yes,
        source=reading.source,
        text=reading.text,
        leftover=reading.leftover,
        seconds=outcome.seconds,
    )
