"""Is it yes or no? Reading the probabilities of a language model's tokens."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from tpvqa.vlm.reply_shape import read_words

__all__ = ["Token", "YesNoMass", "answer_token", "mass", "meaning", "read_words", "says", "spelt"]

_ROUNDING = 1e-3  # how far above 0 rounding may lift the logarithm of a probability
# Byte-level and sentencepiece vocabularies write a leading space as one of these.
_SPACE_MARKS = str.maketrans({"Ġ": " ", "▁": " ", "Ċ": "\n"})


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
        unlisted: Where one of the two is not listed, as much as it may have all the same.
        leftover: What remains, for everything else.
    """

    yes: float
    no: float
    unlisted: float = 0.0

    @property
    def leftover(self) -> float:
        """The probability of neither."""
        return max(0.0, 1.0 - self.yes - self.no)

    @property
    def p_yes(self) -> float | None:
        """P(yes | yes or no), no surer than what is listed; None where both have no probability."""
        if self.yes + self.no <= 0:
            return None
        yes, no = self.yes or self.unlisted, self.no or self.unlisted
        return min(1.0, yes / (yes + no))


def spelt(tokens: Sequence[Token]) -> str:
    """What tokens say together, as far as they are there."""
    return "".join(token.text.translate(_SPACE_MARKS) for token in tokens).strip()


def says(word: str, text: str) -> bool:
    """Whether a text has a word as a whole, in whatever case: no "no" is in "unknown"."""
    letter = r"[^\W\d_]"
    # Not `IGNORECASE`, to which other letters are an s.
    return re.search(rf"(?<!{letter}){word}(?!{letter})", text.lower()) is not None


def answer_token(tokens: Sequence[Token]) -> Token | None:
    """The first token that is itself a yes or a no, after any reasoning; None if there is none.

    Words before it ("Answer:", markup, an opening quotation mark) are passed over. Where the
    word is split over several tokens there is none, as its probability is not that of one token.
    """
    for token in _after_thoughts(tokens):
        if meaning(token.text) is not None:
            return token
    return None


def mass(alternatives: Iterable[tuple[str, float]]) -> YesNoMass | None:
    """Sum the probabilities of yes and of no over case, leading space and punctuation.

    What is listed are the likeliest tokens. So one of the two that is not listed is no likelier
    than the last of them, and than all that they leave.

    Args:
        alternatives: Tokens, each at most once, with the natural logarithms of their
            probabilities. Where that of a yes or a no is none, there is nothing to go by: None.
    """
    total = {"yes": 0.0, "no": 0.0}
    listed, words = [], set()
    for text, logarithm in alternatives:
        word, sound = meaning(text), logarithm < _ROUNDING
        probability = math.exp(min(0.0, logarithm)) if sound else 0.0
        if sound:
            listed.append(probability)
        if word is not None:
            if not sound:
                return None
            words.add(word)
            total[word] += probability
    unlisted = min(max(0.0, 1.0 - sum(listed)), min(listed)) if len(words) == 1 else 0.0
    scale = max(1.0, total["yes"] + total["no"])
    return YesNoMass(total["yes"] / scale, total["no"] / scale, unlisted)


def meaning(token: str) -> str | None:
    """ "yes" or "no" where a token says that, in whatever case and punctuation."""
    # Not `casefold`, which makes an s of other letters.
    word = token.translate(_SPACE_MARKS).strip(" \t\r\n*_`\"'“”‘’.,;:!()[]{}").lower()
    return word if word in ("yes", "no") else None


def _after_thoughts(tokens: Sequence[Token]) -> Sequence[Token]:
    ends = [at for at, token in enumerate(tokens) if re.search(r"</\w+>", token.text)]
    if ends:
        return tokens[ends[-1] + 1 :]
    opened = "".join(token.text for token in tokens[:4]).lstrip()
    return () if re.match(r"<(think|thinking|reasoning)>", opened, re.IGNORECASE) else tokens
