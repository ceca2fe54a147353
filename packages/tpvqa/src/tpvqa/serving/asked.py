"""The question in a prompt. What only says how to answer is taken off, by closed lists of words.

What else stands beside the question stays in it: a VLM that knows certain questions only then says
that it does not know this one, instead of answering another.
"""

import re

from tpvqa.serving.refusal import Refusal

LONGEST = 2_000
"""Characters of a prompt."""

_SENTENCES = re.compile(r"(?<=[.?!])\s+|\s*\n\s*")
_SEVERAL_VIEWS = re.compile(r"These \d+ pictures show the same moment from several views\.")
_LABEL = re.compile(r"(?:question|q)\s*:\s*", re.IGNORECASE)
_END = re.compile(r"(?:short |final )?(?:answer|a)\s*:", re.IGNORECASE)
_HOW_TO_ANSWER = frozenset(
    re.findall(
        r"\w+",
        "please only just answer reply respond say with by in using one a single the word words "
        "either exactly of yes or no unknown and nothing else",
    )
)


def question_in(prompt: str) -> str:
    """The question of a prompt, such as "Is it open? Answer with one word, yes or no."

    >>> question_in("Question: Is the fridge open? Answer yes or no.")
    'Is the fridge open?'

    Raises:
        Refusal: There is none, or the prompt is too long.
    """
    if len(prompt) > LONGEST:
        raise Refusal(
            400,
            f"The text has {len(prompt)} characters; {LONGEST} are taken. Ask one question.",
            param="messages",
        )
    kept = [part for part in map(_bare, _SENTENCES.split(prompt.strip())) if part]
    if not kept:
        raise Refusal(
            400, "The last message of the user asks nothing. Ask one question.", param="messages"
        )
    return " ".join(kept)


def _bare(sentence: str) -> str:
    """A sentence without labels; empty where it only says how to answer."""
    sentence = _LABEL.sub("", sentence.strip(), count=1) if _LABEL.match(sentence) else sentence
    if _SEVERAL_VIEWS.fullmatch(sentence) or _END.fullmatch(sentence):
        return ""
    words = set(re.findall(r"\w+", sentence.lower()))
    return "" if {"yes", "no"} <= words <= _HOW_TO_ANSWER else sentence.strip()
