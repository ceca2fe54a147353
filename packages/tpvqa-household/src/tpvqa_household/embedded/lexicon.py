"""The questions that the embedded network has words for."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cached_property

from tpvqa_household.embedded.rewording import rewordings

_FILLERS = frozenset({"is", "are", "there", "it", "to", "here", "now", "of", "please"})
"""Words that a question may have or lack and still be the same question."""

_SAID = re.compile(r"\w+|[^\w\s.,;:?¿¡'\"“”()-]")
"""Words of any script, and signs that may mean something."""


def words(question: str) -> tuple[str, ...]:
    """A question as lower-case words, without punctuation, articles and possessive s.

    >>> words("Is the plate in a robot's hand?")
    ('is', 'plate', 'in', 'robot', 'hand')
    """
    text = question.lower().replace("’", "'").replace("'s", " ").replace("_", " ")
    said = _SAID.findall(text.rstrip(" ?!."))
    return tuple(word for word in said if word not in ("a", "an", "the"))


def _content(spoken: Sequence[str]) -> tuple[str, ...]:
    return tuple(word for word in spoken if word not in _FILLERS)


@dataclass(frozen=True, slots=True)
class Unknown:
    """Why a question is not answered."""

    reason: str


@dataclass(frozen=True)
class Lexicon:
    """The closed vocabulary, and the questions that training asked.

    A question is known if training asked it up to letter case, punctuation, articles and words
    such as "here" or "please", or in words that simply mean the same (`rewording`). Anything else
    is unknown, also where every word is known: the network would only guess.

    Attributes:
        vocabulary: The words; token 0 is padding, word i is token i + 1.
        questions: All questions of the training, as `words` gives them, joined by blanks.
    """

    vocabulary: tuple[str, ...]
    questions: tuple[str, ...]

    @classmethod
    def of(cls, questions: Iterable[str]) -> "Lexicon":
        """The lexicon of all given questions."""
        spoken = sorted({words(question) for question in questions})
        vocabulary = sorted({word for question in spoken for word in question})
        return cls(tuple(vocabulary), tuple(" ".join(question) for question in spoken))

    @classmethod
    def from_json(cls, data: Mapping[str, Sequence[str]]) -> "Lexicon":
        """Read what `to_json` gave."""
        return cls(tuple(data["vocabulary"]), tuple(data["questions"]))

    def to_json(self) -> dict[str, list[str]]:
        """As plain JSON values."""
        return {"vocabulary": list(self.vocabulary), "questions": list(self.questions)}

    @cached_property
    def longest(self) -> int:
        """Words of the longest question."""
        return max(len(question.split()) for question in self.questions)

    @cached_property
    def _token(self) -> Mapping[str, int]:
        return {word: i + 1 for i, word in enumerate(self.vocabulary)}

    @cached_property
    def _by_content(self) -> Mapping[tuple[str, ...], tuple[str, ...]]:
        found: dict[tuple[str, ...], tuple[str, ...]] = {}
        for question in self.questions:
            spoken = tuple(question.split())
            found.setdefault(_content(spoken), spoken)
            found[spoken] = spoken
        return found

    def _meant(self, spoken: tuple[str, ...]) -> tuple[str, ...] | None:
        """The known question that is meant; None where there is none."""
        for each in (spoken, *(tuple(other.split()) for other in rewordings(" ".join(spoken)))):
            known = self._by_content.get(each) or self._by_content.get(_content(each))
            if known is not None:
                return known
        return None

    def tokens(self, question: str) -> tuple[int, ...] | Unknown:
        """The tokens of the known question that a question amounts to."""
        spoken = words(question)
        known = self._meant(spoken)
        if known is not None:
            return tuple(self._token[word] for word in known)
        foreign = [word for word in spoken if word not in self._token and word not in _FILLERS]
        if foreign:
            return Unknown(f"no word for {', '.join(dict.fromkeys(foreign))}")
        near = get_close_matches(" ".join(spoken), self.questions, n=1, cutoff=0.5)
        hint = f"; the nearest is {near[0]!r}" if near else ""
        return Unknown(f"no such question in training{hint}")
