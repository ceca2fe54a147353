"""Several questions in one request: their form, as a JSON schema asks for it, and their answers.

The form is an object with one word for each key; the question of a key stands in the prompt behind
"key:". Each is answered as if it had been asked alone, so no answer depends on another.
"""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, Literal

from pydantic import Field, ValidationError

from tpvqa.serving.asked import question_in, says_more
from tpvqa.serving.refusal import Refusal
from tpvqa.serving.spoken import Spoken, certain
from tpvqa.told import ToldModel, first_fault
from tpvqa.vlm.answer import Reply

MOST_QUESTIONS = 64
"""In one request."""

_NEEDED = frozenset({Reply.YES.value, Reply.NO.value, Reply.UNKNOWN.value})


class _Word(ToldModel):
    enum: list[str]


class _Object(ToldModel):
    type: Literal["object"]
    properties: dict[str, _Word] = Field(min_length=1, max_length=MOST_QUESTIONS)


class _Named(ToldModel):
    schema_: _Object = Field(alias="schema")


class ResponseFormat(ToldModel):
    """`response_format` of a request, as far as it is read."""

    type: str
    json_schema: Any = None


Form = Mapping[str, frozenset[str]]
"""The keys of a reply in their order, with the words that each may have."""


def form_of(wanted: ResponseFormat | None) -> Form | None:
    """The form that a reply is to have; None for one word.

    Raises:
        Refusal: It is none that can be kept to.
    """
    if wanted is None or wanted.type == "text":
        return None
    if wanted.type != "json_schema":
        raise _refused("can be 'text', or 'json_schema' with one word for each question")
    try:
        schema = _Named.model_validate(wanted.json_schema).schema_
    except ValidationError as error:
        first = first_fault(error)
        place = ".".join(("json_schema", *map(str, first["loc"])))
        raise _refused(
            f"has to be the schema of an object whose properties each have an enum ({place}: "
            f"{re.sub(chr(10), ' ', first['msg'])})"
        ) from None
    for key, word in schema.properties.items():
        if not re.fullmatch(r"\w{1,40}", key):
            raise _refused("has a key that is no word of letters, digits and _, at most 40")
        if not set(word.enum) >= _NEEDED:
            raise _refused(
                f"has a question that may not be answered with unknown: let the enum of {key} "
                "have yes, no and unknown"
            )
    return {key: frozenset(word.enum) for key, word in schema.properties.items()}


def questions_in(prompt: str, form: Form) -> list[str]:
    """The questions of a prompt, in the order of the form.

    >>> form = dict.fromkeys(("q1", "q2"), frozenset())
    >>> questions_in("q1: Is it open?\\nq2: Is it red?\\nAnswer q1 and q2 with yes or no.", form)
    ['Is it open?', 'Is it red?']

    What else the prompt says, but for how to answer, is put before each of them, as it may be about
    all.

    Raises:
        Refusal: A key has no question, or several.
    """
    first, *pairs = re.split(rf"(?<!\w)({'|'.join(map(re.escape, form))}):[ \t]*", prompt)
    beside, asked = [first], dict[str, str]()
    for key, text in zip(pairs[::2], pairs[1::2], strict=True):
        if key in asked:
            raise _unclear(f"{key}: stands twice in it")
        asked[key], _, after = text.partition("\n")
        beside.append(after)
    for key in form:
        if not asked.get(key, "").strip():
            raise _unclear(f"there is no question behind {key}: in it")
    more = says_more("\n".join(beside), allowed=form)
    return [question_in(f"{more} {asked[key]}") for key in form]


@dataclass(frozen=True, slots=True)
class SpokenTogether:
    """Several answers as a language model would say them: one object in JSON.

    Attributes:
        each: What is said to each key.
        why: Always empty: an abstention is a word of its own here.
    """

    each: Mapping[str, Spoken]
    why: str = ""

    def sampled(self, temperature: float, random: Random) -> str:
        """The object with each word drawn at a temperature."""
        return json.dumps({key: one.sampled(temperature, random) for key, one in self.each.items()})

    def logprobs(self, said: str, top: int) -> dict[str, Any] | None:
        """The probabilities of the tokens of what was said; None where one word has none.

        Each word is a token, and so is what stands between two words, which is certain.
        """
        words = json.loads(said)
        tokens, between = [], '{"'
        for key, one in self.each.items():
            found = one.logprobs(words[key], top)
            if found is None:
                return None
            tokens += [certain(f'{between}{key}": "', top), *found["content"]]
            between = '", "'
        return {"content": [*tokens, certain('"}', top)], "refusal": None}

    def tokens(self, said: str) -> int:
        """How many tokens what was said has."""
        return 2 * len(self.each) + 1


def spoken_together(said: Sequence[Spoken], form: Form) -> SpokenTogether:
    """Answers in the order of the form, in words that it allows."""
    pairs = zip(form.items(), said, strict=True)
    return SpokenTogether({key: one.within(words) for (key, words), one in pairs})


def _refused(why: str) -> Refusal:
    return Refusal(
        400, f"response_format {why}.", param="response_format", code="unsupported_value"
    )


def _unclear(why: str) -> Refusal:
    return Refusal(
        400,
        "The keys of response_format are to be found in the last message, each once and with its "
        f'question, such as "q1: Is it open?" in a line of its own; {why}.',
        param="messages",
    )
