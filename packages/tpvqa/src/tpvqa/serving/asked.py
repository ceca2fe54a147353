"""The question in a prompt. What only says how to answer is taken off, by closed lists of words.

What else stands beside the question stays in it: a VLM that knows certain questions only then says
that it does not know this one, instead of answering another.
"""

import re
from collections.abc import Collection

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
_HOW_TO_ANSWER_MANY = frozenset(
    re.findall(r"\w+", "every each all these questions question its their key keys json object")
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
    kept = says_more(prompt)
    if not kept:
        raise Refusal(
            400, "The last message of the user asks nothing. Ask one question.", param="messages"
        )
    return kept


def says_more(text: str, allowed: Collection[str] = ()) -> str:
    """What a text says besides how to answer.

    Args:
        text: Any.
        allowed: The keys of several questions; where there are some, words that ask for them in
            JSON only say how to answer, too.
    """
    how = _HOW_TO_ANSWER | _HOW_TO_ANSWER_MANY | set(allowed) if allowed else _HOW_TO_ANSWER
    return " ".join(filter(None, (_bare(part, how) for part in _SENTENCES.split(text.strip()))))


def _bare(sentence: str, how: Collection[str]) -> str:
    """A sentence without labels; empty where it only says how to answer."""
    sentence = _LABEL.sub("", sentence.strip(), count=1) if _LABEL.match(sentence) else sentence
    if _SEVERAL_VIEWS.fullmatch(sentence) or _END.fullmatch(sentence):
        return ""
    words = set(re.findall(r"\w+", sentence.lower()))
    return "" if {"yes", "no"} <= words <= set(how) else sentence.strip()
