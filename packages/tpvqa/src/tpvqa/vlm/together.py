"""Answers to several questions in one reply: each read by itself, from one JSON object."""

import itertools
import json
import re
from bisect import bisect_right
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from tpvqa.vlm.answer import Reply
from tpvqa.vlm.chat_completions import (
    ENDED_BY_ITSELF,
    LONGEST_REPLY,
    Choice,
    agreed,
    choices_of,
    tokens_of,
)
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.reply_shape import unwrapped
from tpvqa.vlm.yes_no import Token, mass, meaning


def read_together(body: str | bytes, count: int, choices: int = 0) -> list[list[Reading]]:
    """Read the body of a reply to so many questions.

    An answer that is missing, doubled, or none of yes, no and unknown is *unknown* by itself; where
    there is no JSON object at all, every answer is.

    Args:
        body: What the server sent.
        count: How many questions it was asked.
        choices: How many samples it was asked for; what it says beyond them is not read. 0 where
            one reply was asked for: what others say otherwise is *unknown*.

    Returns:
        For each choice the readings, in the order of the questions.
    """
    found = choices_of(body)
    if isinstance(found, Reading):
        return [[found] * count]
    if not choices:
        return [[agreed(each) for each in zip(*(_read(one, count) for one in found), strict=True)]]
    return [_read(choice, count) for choice in found[:choices]]


def _read(choice: Choice, count: int) -> list[Reading]:
    message, ended = choice.message, (choice.finish_reason or "stop").lower()
    said = message.content or ""

    def none(why: str, *, cut: bool = False) -> list[Reading]:
        return [Reading(Reply.UNKNOWN, text=why, cut_short=cut)] * count

    if len(said) > LONGEST_REPLY:
        return none(f"a reply of {len(said)} characters: {said[:200]}")
    if message.refusal:
        return none(f"refused: {message.refusal[:200]}")
    if ended == "length":
        return none("cut short", cut=True)
    if ended not in ENDED_BY_ITSELF or message.calls:
        return none(f"ended by {ended[:40]!r}: {said[:200]}")
    if message.role not in (None, "assistant"):
        return none(f"not said by the model as an answer: {said[:200]}")
    try:
        pairs = json.loads(unwrapped(said), object_pairs_hook=tuple, parse_int=float)
    except (ValueError, RecursionError):
        return none(f"no JSON: {said[:200]}" if said.strip() else "empty reply")
    if not isinstance(pairs, tuple):
        return none(f"no JSON object: {said[:200]}")
    times, told = Counter(key for key, _ in pairs), dict(pairs)
    tokens = _Tokens(tokens_of(choice.logprobs), said)
    return [
        _one(f"q{at}", times[f"q{at}"], told.get(f"q{at}"), tokens) for at in range(1, count + 1)
    ]


def _one(key: str, times: int, value: object, tokens: "_Tokens") -> Reading:
    if times != 1:
        return Reading(Reply.UNKNOWN, text="answered twice" if times else "not in the reply")
    word = value.strip().lower() if isinstance(value, str) else ""
    if word not in ("yes", "no"):
        shown = json.dumps(value)[:200] if isinstance(value, str) else "not a text"
        return Reading(Reply.UNKNOWN, text=shown if word == "unknown" else f"no answer: {shown}")
    reading = Reading(Reply(word), text=word)
    token = tokens.answering(key)
    if token is None or meaning(token.text) != word:
        return reading
    found = mass(token.alternatives.items())
    if found is None:
        return reading
    if found.p_yes is None or found.leftover > 0.5 or (found.p_yes > 0.5) != (word == "yes"):
        why = f"its tokens say otherwise: {word}"
        return Reading(Reply.UNKNOWN, "logprobs", why, leftover=found.leftover)
    return replace(reading, source="logprobs", p_yes=found.p_yes, leftover=found.leftover)


class _Tokens:
    """The tokens of a reply.

    Args:
        tokens: As the server lists them.
        said: The reply's text. Where tokens and text do not fit together, no token counts.
    """

    def __init__(self, tokens: Sequence[Token], said: str):
        written = "".join(token.text for token in tokens)
        fits = said.strip() in (written.strip(), _unfenced(written))
        self._tokens = tokens if fits else ()
        self._written = written if fits else ""
        self._ends = list(itertools.accumulate(len(token.text) for token in self._tokens))

    def answering(self, key: str) -> Token | None:
        """The token that begins a key's answer; None where there is no such token."""
        places = list(re.finditer(rf'"{key}"\s*:\s*"\s*', self._written))
        at = bisect_right(self._ends, places[0].end()) if len(places) == 1 else len(self._ends)
        return self._tokens[at] if at < len(self._ends) else None


def _unfenced(written: str) -> str | None:
    """What stands in a code fence; None where there is none.

    llama.cpp's content leaves out the white space and the fence around what its tokens say.
    """
    fenced = written.strip()
    if len(fenced) < 6 or not (fenced.startswith("```") and fenced.endswith("```")):
        return None
    return fenced[3:-3].removeprefix("json").strip()
