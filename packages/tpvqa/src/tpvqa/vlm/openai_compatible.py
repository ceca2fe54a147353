"""Any OpenAI-compatible server as the VLM: OpenAI, vLLM, llama.cpp, Ollama, LM Studio, ..."""

import asyncio
import hashlib
import importlib.util
import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tpvqa.addresses import checked_address
from tpvqa.errors import AnswerError, BudgetError, MissingExtraError, PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.plugins import PlainArguments
from tpvqa.questions.question import Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.capabilities import NeedsPictures, SeesBefore
from tpvqa.vlm.chat_completions import (
    Dialect,
    Inquiry,
    read_choices,
    read_completion,
)
from tpvqa.vlm.pictures import grey_frame
from tpvqa.vlm.prompt import load_prompt, shipped_prompt
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.sampled import frequency
from tpvqa.vlm.sent_pictures import LONGEST, SentPictures
from tpvqa.vlm.server import Retry, Server
from tpvqa.vlm.surroundings import innermost, what_to_look_at
from tpvqa.vlm.timed_reading import Key, TimedReading, answer_from, key_of, pause_before
from tpvqa.vlm.together import read_together
from tpvqa.vlm.usage import Budget, Usage, usage_told

if TYPE_CHECKING:
    from openai import AsyncOpenAI


class OpenAICompatibleVLM(NeedsPictures, SeesBefore, PlainArguments):
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
        together: As all that follow: the settings of that name in `config.parts.VLMConfig` and
            `config.model.Limits`.

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
        together: bool = False,
        samples: int = 1,
        before_after: bool = False,
        picture_size: int = LONGEST,
        picture_quality: str | None = None,
        prompt: str | None = None,
        max_requests: int | None = None,
        max_tokens_spent: int | None = None,
        max_cost: float | None = None,
        price_prompt: float | None = None,
        price_completion: float | None = None,
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
        self._concurrency, self._deadline, self._retries = concurrency, deadline, retries
        self.together, self.samples, self.before_after = together, samples, before_after
        self._prompt = shipped_prompt() if prompt is None else load_prompt(Path(prompt))
        self._sent = SentPictures(picture_size, picture_quality)
        given = price_prompt is not None or price_completion is not None
        prices = (price_prompt or 0.0, price_completion or 0.0) if given else None
        self.budget = Budget(
            requests=max_requests, tokens=max_tokens_spent, cost=max_cost, prices=prices
        )
        self._sampling = False  # once the server turned out to give no logprobs
        self._dialect = Dialect()
        self._server = Server(model, self.base_url, request_timeout)
        self._looked_at: tuple[object, ...] = ()
        self._known: dict[Key, TimedReading] = {}

    @classmethod
    def from_spec(
        cls,
        arguments: str,
        *,
        base_url: str | None = None,
        together: bool = False,
        samples: int = 1,
        before_after: bool = False,
        picture_size: int = LONGEST,
        picture_quality: str | None = None,
        prompt: str | None = None,
        max_requests: int | None = None,
        max_tokens_spent: int | None = None,
        max_cost: float | None = None,
        price_prompt: float | None = None,
        price_completion: float | None = None,
    ) -> "OpenAICompatibleVLM":
        """Make it from the model's name, which may have colons itself.

        Raises:
            PluginError: No model is named.
            PromptError: The prompt's file is wrong.
        """
        options = {key: value for key, value in locals().items() if key not in ("cls", "arguments")}
        if not arguments:
            said = "Write openai:MODEL, and --base-url for a server of your own."
            raise PluginError(f"'openai' does not say which model. {said}")
        return cls(arguments, **options)

    @property
    def parameters(self) -> dict[str, str]:
        """All that an answer depends on besides pictures and question."""
        found = {
            "model": self.model,
            "prompt": self._prompt.digest,
            "picture_size": self._sent.longest,
            "picture_quality": self._sent.quality,
            "samples": self.samples,
            "together": self.together,
            "before_after": self.before_after,
        }
        return {name: str(value) for name, value in found.items()}

    @property
    def usage(self) -> Usage:
        """What was spent so far."""
        return self.budget.spent

    def snapshot(self) -> dict[str, Any]:
        """What was spent, so that a budget holds when the trial is gone on with."""
        return self.budget.snapshot()

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Count what was spent before, too; see `Budget.restore`."""
        self.budget.restore(snapshot)

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
            said = "Choose a world with pictures, or a noise model such as oracle:0.9."
            raise AnswerError(f"{self.name} looks at pictures, and this world shows none. {said}")
        earlier = observation.before if self.before_after else None
        before = () if earlier is None else tuple(earlier.frames.values())
        data = (hashlib.sha256(frame.data).digest() for frame in (*before, *frames))
        looked_at = (observation.look, len(before), *data)
        if looked_at != self._looked_at:
            self._looked_at, self._known = looked_at, {}
        keys = [key_of(each, compares=bool(before)) for each in questions]
        missing = [key for key in dict.fromkeys(keys) if key not in self._known]
        now = self._known | self._ask_missing(missing, frames, before)
        self._known = {key: outcome for key, outcome in now.items() if outcome.final}
        return [answer_from(q, now[key]) for q, key in zip(questions, keys, strict=True)]

    def _ask_missing(
        self, missing: Sequence["Key"], frames: tuple[Frame, ...], before: tuple[Frame, ...]
    ) -> dict["Key", TimedReading]:
        """Put questions into requests: each its own, or all that are shown the same pictures."""
        frames, before = tuple(map(self._sent, frames)), tuple(map(self._sent, before))
        groups: list[list[Key]] = [[key] for key in missing]
        if self.together:
            groups = [[key for key in missing if key[1] is kind] for kind in (False, True)]
        groups = [group for group in groups if group]
        asked = [
            Inquiry(
                tuple(text for text, _ in group),
                frames,
                before if group[0][1] else (),
                self.together,
            )
            for group in groups
        ]
        outcomes = self._ask_all(asked)
        return {
            key: each
            for group, found in zip(groups, outcomes, strict=True)
            for key, each in zip(group, found, strict=True)
        }

    def check(self) -> None:
        """Ask one question about a grey picture, whatever the answer.

        Raises:
            AnswerError: As `ask` does.
        """
        self._ask_all([Inquiry(("Is this picture grey?",), (grey_frame(),), (), self.together)])

    def close(self) -> None:
        """Close the connections. Can be called twice."""
        self._server.close()

    def _ask_all(self, asked: Sequence[Inquiry]) -> list[list[TimedReading]]:
        """Ask; the one place that all that a server says comes out of."""
        connection = self._server.connect()
        self.budget.see(len(asked))
        try:
            outcomes = connection.run(self._ask_side_by_side, connection.client, asked)
        except BudgetError:
            raise
        except AnswerError as error:
            raise AnswerError(self._server.text(str(error))) from None
        except Exception as error:  # noqa: BLE001  its text may be the server's
            why = self._server.text(f"{type(error).__name__}: {error}").rstrip(".")
            raise AnswerError(
                f"{self._server.where()} cannot be asked: {why}.{what_to_look_at()}"
            ) from None
        return [
            [
                replace(
                    each, reading=replace(each.reading, text=self._server.text(each.reading.text))
                )
                for each in found
            ]
            for found in outcomes
        ]

    async def _ask_side_by_side(
        self, client: "AsyncOpenAI", asked: Sequence[Inquiry]
    ) -> list[list[TimedReading]]:
        turn = asyncio.Semaphore(1 if self.budget.blind else self._concurrency)
        end = asyncio.get_running_loop().time() + self._deadline

        async def one(inquiry: Inquiry) -> list[TimedReading]:
            started = time.monotonic()
            failures: list[Retry] = []
            try:
                async with asyncio.timeout_at(end), turn:
                    started = time.monotonic()
                    return await self._ask_with_retries(client, inquiry, failures, end)
            except TimeoutError:
                why = f"late: nothing within {self._deadline:g} s"
                if failures:
                    why += f"; before that {failures[-1].why}"
            except BudgetError as spent:  # the rest of the step is answered
                why = str(spent)
            none = Reading(Reply.UNKNOWN, text=why)
            late = TimedReading(none, time.monotonic() - started, final=False)
            return [late] * len(inquiry.texts)

        try:
            async with asyncio.TaskGroup() as asking:
                tasks = [asking.create_task(one(inquiry)) for inquiry in asked]
        except ExceptionGroup as group:  # what is raised in an `except*` stays in a group
            raise innermost(group) from None
        outcomes = [task.result() for task in tasks]
        first = outcomes[0][0] if outcomes else None
        if first and all(each.no_server for found in outcomes for each in found):
            raise AnswerError(
                f"{self._server.where()} {first.no_server} ({first.reading.text}). Is the server "
                "running, and is the address right, with its path (usually /v1)?"
            )
        return outcomes

    async def _ask_with_retries(
        self,
        client: "AsyncOpenAI",
        inquiry: Inquiry,
        failures: list[Retry],
        end: float,
    ) -> list[TimedReading]:
        """Ask, again after failures that may pass, which `failures` grows by; no pause begins that
        would go beyond `end`, the deadline by the loop's clock."""
        started = time.monotonic()
        while True:
            try:
                readings = await self._ask_well(client, inquiry)
                seconds = time.monotonic() - started
                return [TimedReading(reading, seconds) for reading in readings]
            except Retry as retry:
                failures.append(retry)
            last, times = failures[-1], len(failures)
            why = last.why if times == 1 else f"{last.why.rstrip('.')}, {times} times"
            if times <= self._retries:
                pause = pause_before(last, times - 1, inquiry.texts[0])
                if asyncio.get_running_loop().time() + pause < end:
                    await asyncio.sleep(pause)
                    continue
                why += (
                    f"; asking again in {round(pause, 1):g} s would be later than the "
                    f"{self._deadline:g} s that all questions have"
                )
            failed = TimedReading(
                Reading(Reply.UNKNOWN, text=why),
                time.monotonic() - started,
                no_server=last.no_server,
                final=False,
            )
            return [failed] * len(inquiry.texts)

    async def _ask_well(self, client: "AsyncOpenAI", inquiry: Inquiry) -> list[Reading]:
        """Ask for the likeliest reply; where it comes without a probability, for samples."""
        if not self._sampling:
            (readings,) = (await self._ask_as_understood(client, inquiry, 0))[:1]
            words = [each for each in readings if each.source == "word" and each.p_yes is None]
            clear = any(each.reply is not Reply.UNKNOWN for each in words)
            if self.samples == 1 or not clear or any(e.source == "logprobs" for e in readings):
                return readings
            self._sampling = True
        drawn: list[list[Reading]] = []
        while len(drawn) < self.samples:
            drawn += await self._ask_as_understood(client, inquiry, self.samples - len(drawn))
        drawn = drawn[: self.samples]
        return [
            frequency([each[at] for each in drawn], self.samples)
            for at in range(len(inquiry.texts))
        ]

    async def _ask_as_understood(
        self, client: "AsyncOpenAI", inquiry: Inquiry, samples: int
    ) -> list[list[Reading]]:
        """Ask, finding out what the server understands; for each choice a reading a question."""
        dialect = self._dialect
        while True:
            said = await self._request(client, inquiry, dialect, samples)
            if isinstance(said, list):
                self._dialect = dialect
                cut = any(reading.cut_short for readings in said for reading in readings)
                longer = dialect.with_room_to_think() if cut else None
                if longer is None:
                    return said
                dialect = longer
                continue
            next_dialect = dialect.after_refusal(said)
            if next_dialect is None and dialect != dialect.bare():
                next_dialect = dialect.bare()
            if next_dialect is None:
                raise AnswerError(
                    f"{self._server.where()} refuses to be asked: {said}. Does the model "
                    f"{self.model!r} take pictures?"
                )
            dialect = next_dialect

    async def _request(
        self, client: "AsyncOpenAI", inquiry: Inquiry, dialect: Dialect, samples: int
    ) -> list[list[Reading]] | str:
        """One request; what the server complains of where it refuses its form."""
        self.budget.begin()
        told = Usage(1)
        try:
            body = await self._server.send(client, inquiry, self._prompt, dialect, samples)
            if isinstance(body, bytes):
                told = usage_told(body)
        finally:
            self.budget.end(told)
        if isinstance(body, str):
            return body
        count = len(inquiry.texts)
        if isinstance(body, Reading):
            return [[body] * count]
        if inquiry.together:
            return read_together(body, count, samples)
        if samples:
            return [[each] for each in read_choices(body, inquiry.texts[0], samples)]
        return [[read_completion(body, inquiry.texts[0])]]
