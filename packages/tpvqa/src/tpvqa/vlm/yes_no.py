"""Is it yes or no? Reading a language model's words and the probabilities of its tokens."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from tpvqa.vlm.answer import Reply

_THOUGHTS = re.compile(r"<(think|thinking|reasoning)>.*?(</\1>|\Z)", re.DOTALL | re.IGNORECASE)
_PREAMBLE = re.compile(r"(?:the\s+)?(?:final\s+)?answer(?:\s+is)?\b\W*", re.IGNORECASE)
_WORD = re.compile(r"[^\W_]+(?:['’][^\W_]+)*")
_HEDGE = re.compile(
    r"\b(maybe|perhaps|possibly|probably|unsure|uncertain|unclear|unknown|depends"
    r"|(?:not|n['’]t)\s+(?:\w+\s+)?(?:sure|certain|clear|possible to (?:say|tell))"
    r"|(?:cannot|can['’]?t|could not|couldn['’]?t|hard to|impossible to|unable to)"
    r"\s+(?:\w+\s+)?(?:tell|say|determine|see|know))\b",
    re.IGNORECASE,
)
_ROUNDING = 1e-3  # how far above 0 rounding may lift the logarithm of a probability
# Byte-level and sentencepiece vocabularies write a leading space as one of these.
_SPACE_MARKS = str.maketrans({"Ġ": " ", "▁": " ", "Ċ": "\n"})


def still_thinking(text: str) -> bool:
    """Whether a reply ends inside its reasoning."""
    return re.match(r"\s*<(think|thinking|reasoning)>(?!.*</\1>)", text, re.I | re.S) is not None


def read_words(text: str) -> Reply:
    """What a reply says: yes or no where it is clear, otherwise *unknown*.

    It is clear where the first word after an optional "Answer:" is yes or no, the opposite word
    occurs nowhere, and nothing takes it back ("Yes, maybe", "No, I cannot tell").

    Args:
        text: The raw reply; a reasoning block in it is skipped.
    """
    said = _THOUGHTS.sub(" ", text).lstrip(" \t\r\n*_`\"'“”‘’#>-")
    preamble = _PREAMBLE.match(said)
    said = said[preamble.end() :] if preamble else said
    words = [word.casefold() for word in _WORD.findall(said)]
    if not words or words[0] not in ("yes", "no"):
        return Reply.UNKNOWN
    opposite = "no" if words[0] == "yes" else "yes"
    question_mark = re.match(r"\W*(?:yes|no)\s*\?", said, re.IGNORECASE)
    if opposite in words or question_mark or _HEDGE.search(said):
        return Reply.UNKNOWN
    return Reply.YES if words[0] == "yes" else Reply.NO


@dataclass(frozen=True, slots=True)
class Token:
    """One generated token and its likeliest alternatives.

    Attributes:
        text: The token as generated.
        alternatives: Natural logarithm of the probability of each listed token, itself included
            where the server lists it.
    """

    text: str
    alternatives: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class YesNoMass:
    """How much probability the answer token leaves for yes and for no.

    Attributes:
        yes: Probability of all ways of writing yes.
        no: Probability of all ways of writing no.
        leftover: What remains, for everything else.
    """

    yes: float
    no: float

    @property
    def leftover(self) -> float:
        """The probability of neither."""
        return max(0.0, 1.0 - self.yes - self.no)

    @property
    def p_yes(self) -> float | None:
        """P(yes | yes or no); None where both have no probability at all."""
        total = self.yes + self.no
        return min(1.0, self.yes / total) if total > 0 else None


def answer_token(tokens: Sequence[Token]) -> Token | None:
    """The first token that is itself a yes or a no, after any reasoning; None if there is none.

    Words before it ("Answer:", markup, an opening quotation mark) are passed over. Where the
    word is split over several tokens there is none, as its probability is not that of one token.
    """
    for token in _after_thoughts(tokens):
        if _meaning(token.text) is not None:
            return token
    return None


def mass(alternatives: Iterable[tuple[str, float]]) -> YesNoMass:
    """Sum the probabilities of yes and of no over case, leading space and punctuation.

    Args:
        alternatives: Tokens, each at most once, with the natural logarithms of their
            probabilities. Values that are no logarithm of a probability count as nothing.
    """
    total = {"yes": 0.0, "no": 0.0}
    for text, logarithm in alternatives:
        word = _meaning(text)
        if word is not None and logarithm < _ROUNDING:
            total[word] += math.exp(min(0.0, logarithm))
    scale = max(1.0, total["yes"] + total["no"])
    return YesNoMass(yes=total["yes"] / scale, no=total["no"] / scale)


def _meaning(token: str) -> str | None:
    word = token.translate(_SPACE_MARKS).strip(" \t\r\n*_`\"'“”‘’.,;:!()[]").casefold()
    return word if word in ("yes", "no") else None


def _after_thoughts(tokens: Sequence[Token]) -> Sequence[Token]:
    ends = [at for at, token in enumerate(tokens) if re.search(r"</\w+>", token.text)]
    if ends:
        return tokens[ends[-1] + 1 :]
    opened = "".join(token.text for token in tokens[:4]).lstrip()
    return () if re.match(r"<(think|thinking|reasoning)>", opened, re.IGNORECASE) else tokens
