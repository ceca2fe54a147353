"""The bodies of requests and replies, as OpenAI's chat completions have them."""

import json
import re
import time
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from random import Random
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError, field_validator
from pydantic_core import PydanticCustomError

from tpvqa.serving.refusal import Refusal
from tpvqa.serving.several import Form, ResponseFormat, SpokenTogether, form_of
from tpvqa.serving.spoken import NO, YES, Spoken
from tpvqa.told import ToldModel, check_names, first_fault

MOST_CHOICES = 16
_MOST_MESSAGES = 1000
_MOST_PARTS = 1000


class _ImageURL(ToldModel):
    url: str


class _ImagePart(ToldModel):
    type: Literal["image_url"]
    image_url: _ImageURL


class _TextPart(ToldModel):
    type: Literal["text"]
    text: str


class _Content(ToldModel):
    content: list[Annotated[_ImagePart | _TextPart, Field(discriminator="type")]] = Field(
        max_length=_MOST_PARTS
    )


class _Message(ToldModel):
    role: str
    content: Any = None


class _StreamOptions(ToldModel):
    include_usage: bool | None = None


class _Request(ToldModel):
    """What of a request is read; what else a client says is let pass."""

    model: str
    messages: list[_Message] = Field(min_length=1, max_length=_MOST_MESSAGES)
    logprobs: bool | None = None
    top_logprobs: int | None = Field(None, ge=0, le=20)
    max_tokens: int | None = Field(None, ge=1)
    max_completion_tokens: int | None = Field(None, ge=1)
    n: int | None = Field(None, ge=1, le=MOST_CHOICES)
    temperature: float | None = Field(None, ge=0, le=2)
    seed: int | None = None
    stream: bool | None = None
    stream_options: _StreamOptions | None = None
    response_format: ResponseFormat | None = None

    @field_validator(
        *("top_logprobs", "max_tokens", "max_completion_tokens", "n", "temperature", "seed"),
        mode="before",
    )
    @classmethod
    def _number(cls, value: object) -> object:
        if isinstance(value, bool):
            raise PydanticCustomError("no_number", "true and false are no numbers")
        return value


@dataclass(frozen=True, slots=True)
class Asking:
    """What a request asks.

    Attributes:
        model: Of whom.
        text: The words of the last message.
        urls: The addresses of its pictures.
        top: Alternatives to list of each token; None where no probabilities are wanted.
        choices: How many replies.
        temperature: 0 where none is given: the surest word.
        seed: Makes draws the same again.
        stream: Whether the reply is wanted as a stream of events.
        usage: Whether that stream is to end with what was used.
        form: The form of a reply to several questions; None for one question, one word.
    """

    model: str
    text: str
    urls: tuple[str, ...]
    top: int | None
    choices: int
    temperature: float
    seed: int | None
    stream: bool
    usage: bool
    form: Form | None = None


def read_request(body: bytes) -> Asking:
    """Read the body of a request. Only the last message is read: it holds question and pictures.

    Raises:
        Refusal: It is no such request, or asks for what is not to be had.
    """
    _see_names(body)
    try:
        request = _Request.model_validate_json(body)
    except ValidationError as error:
        raise _refusal(error, "") from None
    if request.top_logprobs is not None and not request.logprobs:
        raise Refusal(400, "top_logprobs needs logprobs: true.", param="top_logprobs")
    form = form_of(request.response_format)
    last = request.messages[-1]
    place = f"messages.{len(request.messages) - 1}"
    if last.role != "user":
        raise Refusal(
            400, f"The last message is the {last.role}'s; it has to be the user's.", param=place
        )
    if isinstance(last.content, str):
        texts, urls = [last.content], []
    else:
        try:
            parts = _Content(content=last.content).content
        except ValidationError as error:
            raise _refusal(error, place) from None
        texts = [part.text for part in parts if isinstance(part, _TextPart)]
        urls = [part.image_url.url for part in parts if isinstance(part, _ImagePart)]
    options = request.stream_options
    return Asking(
        model=request.model,
        text="\n".join(texts),
        urls=tuple(urls),
        top=(request.top_logprobs or 0) if request.logprobs else None,
        choices=request.n or 1,
        temperature=request.temperature or 0.0,
        seed=request.seed,
        stream=bool(request.stream),
        usage=bool(options and options.include_usage),
        form=form,
    )


def _see_names(body: bytes) -> None:
    """Of two values of one name another reader would take the other.

    Raises:
        Refusal: A name is given twice.
    """
    try:
        check_names(body)
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError):
        pass  # the model that it is read into says so
    except ValueError as error:
        raise Refusal(400, f"The body is no clear request: {error} in one object.") from None


def _refusal(error: ValidationError, place: str) -> Refusal:
    first = first_fault(error)
    param = ".".join(part for part in (place, *map(str, first["loc"])) if part)
    message = re.sub(r"\s+", " ", first["msg"])
    if not param:
        return Refusal(400, f"The body is no request in JSON: {message}.")
    return Refusal(400, f"{param}: {message}.", param=param)


class Reply:
    """What is replied to a request.

    Args:
        asking: What was asked.
        prompt_words: How many words the questions in it have.
        said: What the VLM says.
        random: Draws, where a temperature is given.
    """

    def __init__(
        self, asking: Asking, prompt_words: int, said: Spoken | SpokenTogether, random: Random
    ):
        self._asking, self._said = asking, said
        self._words = [said.sampled(asking.temperature, random) for _ in range(asking.choices)]
        self._prompt_words = prompt_words
        self._id = f"chatcmpl-{uuid.uuid4().hex}"
        self._created = int(time.time())

    @property
    def body(self) -> dict[str, Any]:
        """The reply in one piece."""
        choices = [
            {
                "index": index,
                "message": {"role": "assistant", **self._spoken(word)},
                "logprobs": self._logprobs(word),
                "finish_reason": "stop",
            }
            for index, word in enumerate(self._words)
        ]
        return {**self._head("chat.completion"), "choices": choices, "usage": self._usage}

    def events(self) -> Iterator[dict[str, Any]]:
        """The reply as a stream."""
        head = self._head("chat.completion.chunk")
        if self._asking.usage:
            head["usage"] = None
        for index, word in enumerate(self._words):
            delta = {"role": "assistant", **self._spoken(word)}
            more = {"logprobs": self._logprobs(word), "finish_reason": None}
            yield {**head, "choices": [{"index": index, "delta": delta, **more}]}
            end = {"index": index, "delta": {}, "logprobs": None, "finish_reason": "stop"}
            yield {**head, "choices": [end]}
        if self._asking.usage:
            yield {**head, "choices": [], "usage": self._usage}

    def _head(self, kind: str) -> dict[str, Any]:
        return {
            "id": self._id,
            "object": kind,
            "created": self._created,
            "model": self._asking.model,
        }

    def _spoken(self, word: str) -> dict[str, Any]:
        return {"content": word, "refusal": None if word in (YES, NO) else self._said.why or None}

    def _logprobs(self, word: str) -> dict[str, Any] | None:
        return None if self._asking.top is None else self._said.logprobs(word, self._asking.top)

    @property
    def _usage(self) -> dict[str, int]:
        """In words, which are the tokens here; pictures are not counted."""
        asked, said = self._prompt_words, sum(map(self._said.tokens, self._words))
        return {
            "prompt_tokens": asked,
            "completion_tokens": said,
            "total_tokens": asked + said,
        }
