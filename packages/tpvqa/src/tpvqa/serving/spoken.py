"""An answer as a language model would say it: one word, with the probabilities of all it may say.

The words are yes, no, "unknown" and "cannot see". Each is one token. What is an abstention has
little or no probability on yes and no, so that who reads probabilities abstains, too.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from random import Random
from typing import Any

from tpvqa.vlm.answer import Answer, Reply

YES, NO = Reply.YES.value, Reply.NO.value
_LEAST = -9999.0
"""What stands for the logarithm of nothing, for which JSON has no number; OpenAI has the same."""
_COLDEST = 1e-6
"""A temperature below it is 0: whatever is less sure than the surest word never comes."""
_MOST_LEFT = 0.49
"""Of the probability, for neither yes nor no where the answer is one of them."""


@dataclass(frozen=True, slots=True)
class Spoken:
    """What is said, and what else might have been.

    Attributes:
        word: What is said.
        odds: The probability of each word; None where the VLM gives none.
        why: Why there is no yes or no; empty where there is one.
    """

    word: str
    odds: Mapping[str, float] | None
    why: str = ""

    def sampled(self, temperature: float, random: Random) -> str:
        """One word drawn at a temperature; what is surest at 0."""
        if temperature < _COLDEST or self.odds is None:
            return self.word
        words = [word for word, p in self.odds.items() if p > 0]
        logarithms = [math.log(self.odds[word]) / temperature for word in words]
        weights = [math.exp(each - max(logarithms)) for each in logarithms]
        return random.choices(words, weights)[0]

    def within(self, words: Collection[str]) -> "Spoken":
        """The same where only some words may be said: any other is *unknown*."""
        unknown = Reply.UNKNOWN.value
        if self.odds is None or set(self.odds) <= set(words):
            return self if self.word in words else replace(self, word=unknown)
        odds: dict[str, float] = {}
        for word, p in self.odds.items():
            said = word if word in words else unknown
            odds[said] = odds.get(said, 0.0) + p
        return replace(self, word=self.word if self.word in words else unknown, odds=odds)

    def tokens(self, word: str) -> int:
        """How many tokens a word has."""
        return 1

    def logprobs(self, word: str, top: int) -> dict[str, Any] | None:
        """The probabilities as chat completions give them, for a word that was said.

        Args:
            word: What was said.
            top: How many alternatives to list.
        """
        if self.odds is None:
            return None
        ordered = sorted(self.odds, key=lambda each: -(self.odds or {})[each])
        listed = [_token(each, self.odds[each]) for each in ordered[:top]]
        said = _token(word, self.odds[word])
        return {"content": [{**said, "top_logprobs": listed}], "refusal": None}


def spoken(answer: Answer) -> Spoken:
    """What a language model would say that gives this answer.

    P(yes) is yes / (yes + no) of the probabilities. What is left of them is that the picture does
    not show it, or for neither word.
    """
    word, p_yes = answer.reply.value, answer.p_yes
    unseen = answer.p_cannot_see
    shares = (p_yes, unseen, answer.leftover)
    if not all(each is None or 0.0 <= each <= 1.0 for each in shares):  # NaN neither
        unknown = Reply.UNKNOWN.value
        return Spoken(unknown, {unknown: 1.0}, "the VLM gives a probability that is none")
    if answer.reply in (Reply.YES, Reply.NO):
        if p_yes is None:
            return Spoken(word, None)
        left = unseen if unseen is not None else answer.leftover or 0.0
        other = Reply.UNKNOWN if unseen is None else Reply.CANNOT_SEE
        return Spoken(word, _shared(p_yes, min(left, _MOST_LEFT), other.value))
    why = answer.text or "the VLM does not say why"
    sure = answer.reply is Reply.CANNOT_SEE and (unseen or 0.0) > 0.5
    if not sure or p_yes is None or unseen is None:
        return Spoken(word, {word: 1.0}, why)
    return Spoken(word, _shared(p_yes, unseen, word), "the picture does not show it")


def _shared(p_yes: float, left: float, other: str) -> dict[str, float]:
    odds = {YES: p_yes * (1.0 - left), NO: (1.0 - p_yes) * (1.0 - left)}
    return odds | {other: left} if left > 0 else odds


def certain(text: str, top: int) -> dict[str, Any]:
    """A token that nothing else could have been, as chat completions give it."""
    token = _token(text, 1.0)
    return {**token, "top_logprobs": [token][:top]}


def _token(word: str, p: float) -> dict[str, Any]:
    logarithm = math.log(p) if p > 0 else _LEAST
    return {"token": word, "logprob": logarithm, "bytes": list(word.encode())}
