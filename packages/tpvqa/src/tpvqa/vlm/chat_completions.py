"""The wire: what is sent to a chat completions server, and what its reply says."""

import base64
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from pydantic import Field, ValidationError

from tpvqa.observation import Frame
from tpvqa.told import ToldModel, check_names
from tpvqa.vlm.answer import Reply
from tpvqa.vlm.prompt import Prompt
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.reply_shape import read_words, still_thinking
from tpvqa.vlm.yes_no import Token, answer_token, mass, meaning, says, spelt

_ROOM_TO_THINK = 2048
_TOKENS_OF_AN_ANSWER = 12  # in JSON, key and all
ENDED_BY_ITSELF = ("stop", "eos", "eos_token", "end_turn", "stop_sequence")
_MOST_CHOICES = 64
LONGEST_REPLY = 100_000  # characters, reasoning included


@dataclass(frozen=True, slots=True)
class Dialect:
    """What a server and model turned out to understand.

    Attributes:
        logprobs: How many alternatives of each token to ask for; 0 asks for none.
        limit: The parameter that limits the length, None for no limit.
        tokens: That limit. Short answers suffice, but reasoning counts too.
        temperature: Whether a temperature may be given.
        schema: How the form of a reply to several questions is asked for; None for words alone.
        several: Whether `n` may be given.
    """

    logprobs: int = 20
    limit: str | None = "max_tokens"
    tokens: int = 12
    temperature: bool = True
    schema: str | None = "json_schema"
    several: bool = True

    def parameters(self, together: int = 0, samples: int = 0) -> dict[str, Any]:
        """The optional parameters of a request.

        Args:
            together: How many questions it has, where they are asked together; 0 for one alone.
            samples: How many samples are wanted; 0 for the likeliest reply.
        """
        parameters: dict[str, Any] = {}
        if together and self.schema == "json_schema":
            parameters["response_format"] = answers_schema(together)
        elif together and self.schema:
            parameters["response_format"] = {"type": self.schema}
        if samples > 1 and self.several:
            parameters["n"] = samples
        if self.logprobs and not samples:
            parameters |= {"logprobs": True, "top_logprobs": self.logprobs}
        if self.limit:
            parameters[self.limit] = self.tokens + _TOKENS_OF_AN_ANSWER * together
        if self.temperature:
            parameters["temperature"] = 1 if samples else 0
        return parameters

    def after_refusal(self, complaint: str) -> "Dialect | None":
        """The dialect to try next after a request was refused; None where nothing is left.

        Args:
            complaint: What the server said, with the name of the parameter where it gave one.
        """
        complaint = complaint.lower()
        if self.schema and re.search(r"response_format|json_?schema|json_object", complaint):
            return replace(self, schema="json_object" if self.schema == "json_schema" else None)
        if self.several and re.search(
            r"(?<![a-z])['\"`]?n['\"`]?(?![a-z'])|multiple completions", complaint
        ):
            return replace(self, several=False)
        if self.logprobs and re.search(r"log_?prob", complaint):
            at_most = re.search(
                r"(?:(?:<=|at most|more than|equal to)\s*|maximum\D*+)(\d+)", complaint
            )
            fewer = int(at_most[1]) if at_most else 0
            return replace(self, logprobs=fewer if 0 < fewer < self.logprobs else 0)
        if self.limit and re.search(r"max_(completion_)?tokens|output.token", complaint):
            other = {"max_tokens": "max_completion_tokens", "max_completion_tokens": None}
            return replace(self, limit=other[self.limit])
        if self.temperature and "temperature" in complaint:
            return replace(self, temperature=False)
        return None

    def bare(self) -> "Dialect":
        """Nothing optional at all."""
        return Dialect(logprobs=0, limit=None, temperature=False, schema=None, several=False)

    def with_room_to_think(self) -> "Dialect | None":
        """More tokens, for models that reason first; None where that was tried."""
        if self.limit is None or self.tokens >= _ROOM_TO_THINK:
            return None
        return replace(self, tokens=_ROOM_TO_THINK)


@dataclass(frozen=True, slots=True)
class Inquiry:
    """What one request asks.

    Attributes:
        texts: The questions.
        frames: The pictures of now.
        before: Those of before the last action, where they are shown.
        together: Whether the answers are wanted as one JSON object.
    """

    texts: tuple[str, ...]
    frames: tuple[Frame, ...]
    before: tuple[Frame, ...] = ()
    together: bool = False


def answers_schema(count: int) -> dict[str, Any]:
    """The form of a reply to so many questions: q1, q2, …, each yes, no or unknown."""
    keys = [f"q{at}" for at in range(1, count + 1)]
    each = {"type": "string", "enum": ["yes", "no", "unknown"]}
    schema = {
        "type": "object",
        "properties": dict.fromkeys(keys, each),
        "required": keys,
        "additionalProperties": False,
    }
    named = {"name": "answers", "strict": True, "schema": schema}
    return {"type": "json_schema", "json_schema": named}


def messages(asked: Inquiry, prompt: Prompt) -> list[dict[str, Any]]:
    """What a server is sent: examples first, then the pictures, then what is asked about them."""
    said: list[dict[str, Any]] = []
    if prompt.system:
        said.append({"role": "system", "content": prompt.system})
    for example in prompt.examples:
        shown = Inquiry((example.question,), example.pictures, together=asked.together)
        answer = json.dumps({"q1": example.answer}) if asked.together else example.answer
        said += [_turn(shown, prompt), {"role": "assistant", "content": answer}]
    return [*said, _turn(asked, prompt)]


def _turn(asked: Inquiry, prompt: Prompt) -> dict[str, Any]:
    pictures = (*asked.before, *asked.frames)
    counts = {"pictures": len(pictures), "before": len(asked.before)}
    if asked.together:
        text = prompt.many(asked.texts, **counts)
    else:
        text = prompt.one(asked.texts[0], **counts)
    content: list[dict[str, Any]] = [
        {"type": "image_url", "image_url": {"url": data_url(frame)}} for frame in pictures
    ]
    return {"role": "user", "content": [*content, {"type": "text", "text": text}]}


def data_url(frame: Frame) -> str:
    """A picture inside an address, as the API takes it."""
    return f"data:{frame.media_type};base64,{base64.b64encode(frame.data).decode('ascii')}"


class _Alternative(ToldModel):
    token: str
    logprob: Any = None


class _Token(_Alternative):
    top_logprobs: list[_Alternative] | None = None


class _Logprobs(ToldModel):
    content: list[_Token] | None = None


class _Message(ToldModel):
    role: str | None = None
    content: str | None = None
    refusal: str | None = None
    tool_calls: Any = None
    function_call: Any = None  # what tool calls were before; some servers still send it

    @property
    def calls(self) -> bool:
        """Whether it asks for a tool, and so says nothing to a person."""
        return bool(self.tool_calls or self.function_call)


class Choice(ToldModel):
    message: _Message
    finish_reason: str | None = None
    # Its shape is checked apart: broken probabilities must not cost a clear word.
    logprobs: Any = None


class _Completion(ToldModel):
    choices: list[Choice] = Field(min_length=1)
    error: Any = None


def read_completion(body: str | bytes, question: str | None = None) -> Reading:
    """Read the body of a reply. Whatever cannot be read is *unknown*, with the reason.

    A word counts (see `reply_shape`) where the reply ended by itself, and where the probabilities
    of its tokens, if there are any, say the same as the word.

    Args:
        body: What the server sent.
        question: What was asked, where that is known.
    """
    return agreed(read_choices(body, question))


def agreed(readings: Sequence[Reading]) -> Reading:
    """What the choices of a reply say, of which one was asked for."""
    if len({reading.reply for reading in readings}) > 1:
        said = " / ".join(reading.text for reading in readings)
        return Reading(Reply.UNKNOWN, text=f"several answers: {said[:200]}")
    return readings[0]


def read_choices(
    body: str | bytes, question: str | None = None, choices: int = _MOST_CHOICES
) -> list[Reading]:
    """Read each choice of a reply by itself, as `read_completion` does, up to so many; one at
    least."""
    found = choices_of(body)
    if isinstance(found, Reading):
        return [found]
    return [_read_choice(choice, question) for choice in found[:choices]]


def choices_of(body: str | bytes) -> list[Choice] | Reading:
    """The choices of a reply, or why there are none."""
    try:
        check_names(body)  # of two contents one would count, and nobody knows which is meant
        completion = _Completion.model_validate_json(body)
    except (ValidationError, ValueError, RecursionError):
        shown = body if isinstance(body, str) else body.decode("utf-8", "replace")
        return Reading(Reply.UNKNOWN, text=f"garbled reply: {shown[:200]}")
    if completion.error:
        return Reading(
            Reply.UNKNOWN, text=f"the server reports an error: {completion.error!s:.200}"
        )
    return completion.choices[:_MOST_CHOICES]


def _read_choice(choice: Choice, question: str | None) -> Reading:
    message, ended = choice.message, (choice.finish_reason or "stop").lower()
    said, cut = message.content or "", ended == "length"
    if len(said) > LONGEST_REPLY:
        return Reading(Reply.UNKNOWN, text=f"a reply of {len(said)} characters: {said[:200]}")
    if message.refusal:
        return Reading(Reply.UNKNOWN, text=f"refused: {message.refusal[:200]}")
    if not said.strip():
        return Reading(Reply.UNKNOWN, text="cut short" if cut else "empty reply", cut_short=cut)
    if not cut and ended not in ENDED_BY_ITSELF:
        return Reading(Reply.UNKNOWN, text=f"ended by {ended[:40]!r}: {said}")
    if message.calls or message.role not in (None, "assistant"):
        return Reading(Reply.UNKNOWN, text=f"not said by the model as an answer: {said}")
    word = read_words(said, question, cut=cut)
    if word is Reply.UNKNOWN:
        cut = cut and (still_thinking(said) or read_words(said, question) is not Reply.UNKNOWN)
        return Reading(word, text=said, cut_short=cut)
    return weighed(word, said, tokens_of(choice.logprobs))


def weighed(word: Reply, said: str, tokens: Sequence[Token]) -> Reading:
    """A clear word, with the probabilities of its tokens; *unknown* where these say otherwise."""
    token = answer_token(tokens)
    found = None if token is None else mass(token.alternatives.items())
    if token is None or found is None:
        other = spelt(tokens)
        if other and not said.strip().startswith(other) and not says(word.value, other):
            return Reading(Reply.UNKNOWN, text=f"its tokens say otherwise ({other[:40]!r}): {said}")
        return Reading(word, text=said)
    p_yes = found.p_yes
    if p_yes is None or found.leftover > 0.5:
        return Reading(Reply.UNKNOWN, "logprobs", said, leftover=found.leftover)
    sides = (p_yes > 0.5, p_yes < 0.5)
    if sides != (word is Reply.YES, word is Reply.NO) or meaning(token.text) != word.value:
        text = f"its tokens say otherwise (P(yes) = {p_yes:.3f}): {said}"
        return Reading(Reply.UNKNOWN, "logprobs", text, leftover=found.leftover)
    return Reading(word, "logprobs", said, p_yes=p_yes, leftover=found.leftover)


def tokens_of(logprobs: Any) -> list[Token]:
    try:
        content = _Logprobs.model_validate(logprobs).content or []
    except ValidationError:
        return []
    return [Token(token.token, _alternatives(token)) for token in content]


def _alternatives(token: _Token) -> dict[str, float]:
    """The logarithms of what a token could have been; tokens that are spelt alike count together.

    A vocabulary may have several such, with and without a space before them, say.
    """
    found: dict[str, float] = {}
    for each in token.top_logprobs or ():
        logarithm = _logarithm(each.logprob)
        if each.token in found:
            logarithm = _together(found[each.token], logarithm)
        found[each.token] = logarithm
    return {token.token: _logarithm(token.logprob), **found}


def _together(one: float, other: float) -> float:
    if not (one <= 0 and other <= 0):
        return math.nan
    both = math.exp(one) + math.exp(other)
    return min(0.0, math.log(both)) if both else -math.inf


def _logarithm(told: object) -> float:
    """A number that is told; NaN where it is none."""
    try:
        return float(told) if isinstance(told, (int, float)) else math.nan
    except OverflowError:
        return math.nan


def refuses_form(status: int, said: str) -> bool:
    """Whether a server complains of how it is asked, so that the same again would not help.

    OpenAI forbids logprobs of its reasoning models with 403, llama.cpp answers a picture that the
    model cannot take with 500.
    """
    if status in (400, 415, 422):
        return True
    of_logprobs = status in (403, 500, 501) and re.search(r"log_?prob", said, re.I)
    pictures = r"(image|picture|vision|multimodal).*(not|un)[ -]?support|unsupported.*image"
    return bool(of_logprobs or (status >= 500 and re.search(pictures, said, re.I)))


def complaint(body: object) -> Mapping[str, str]:
    """The parts of an error's body that say what is wrong: message, param, code."""
    if isinstance(body, (str, bytes)):
        try:
            body = json.loads(body)
        except ValueError:
            return {"message": str(body)[:500]}
    inner = body.get("error", body) if isinstance(body, Mapping) else body
    if not isinstance(inner, Mapping):
        return {"message": str(inner)[:500]}
    parts = {key: inner.get(key) for key in ("message", "param", "code", "type", "detail")}
    return {key: str(value)[:500] for key, value in parts.items() if value is not None}
