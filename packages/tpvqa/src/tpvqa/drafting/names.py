"""Names of a task as words: "isOpen" → is open, "handempty" → hand empty, "loc-0-1" → location."""

import re
from collections.abc import Collection
from functools import lru_cache

from tpvqa.drafting.forms import is_verb, verb_form
from tpvqa.drafting.lexicon import (
    ABBREVIATIONS,
    ADJECTIVES,
    COMPOUNDS,
    INSIDE,
    PARTICLES,
    PLACES,
    PREPOSITIONS,
    RUN_TOGETHER,
    UPON,
    word_set,
)

_VOWEL = re.compile("[AEIOUY]")
"""Where one stands, capitals may be a habit: TABLE, but TMS."""
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z0-9])(?=[A-Z][a-z])")
_PREFIXES = ("is", "has", "have", "not", "get", "can")
_LONE = frozenset(
    {
        "island",
        "isolated",
        "hash",
        "hasty",
        "getaway",
        "canned",
        "candle",
        "notch",
        "noted",
        "note",
        "canister",
        "haste",
        "notice",
        "cancel",
        "canal",
        "canvas",
        "haven",
        "issue",
        "issued",
        "isolate",
    }
)


def spelled(name: str, text: str) -> str:
    """A name as its author wrote it: PDDL knows no capitals, readers do.

    Args:
        name: In lower case.
        text: Of domain and problem, in which it stands.
    """
    found = re.search(rf"(?<![\w-]){re.escape(name)}(?![\w-])", text, re.IGNORECASE)
    return name if found is None else found[0]


def words_of(name: str, known: Collection[str] = ()) -> list[str]:
    """The words of a name, in lower case.

    Args:
        name: As its author wrote it.
        known: Words that the task has besides those of the lexicon.

    >>> words_of("switchedOn"), words_of("handempty"), words_of("plate2")
    (['switched', 'on'], ['hand', 'empty'], ['plate', '2'])
    """
    spaced = name if name.isupper() else _HUMP.sub(" ", name)
    spaced = re.sub(r"(?<=[a-zA-Z])(?=\d)", " ", re.sub(r"[_\-\s]+", " ", spaced)).lower()
    words: list[str] = []
    for word in spaced.split():
        said = ABBREVIATIONS.get(word, word)
        words += said.split() if said != word else _apart(word, frozenset(known))
    return words or [name]


@lru_cache(maxsize=4096)
def _apart(word: str, known: frozenset[str]) -> list[str]:
    """A word that was written together, taken apart."""
    lexicon = known | RUN_TOGETHER | PREPOSITIONS
    whole = lexicon | ADJECTIVES | COMPOUNDS | INSIDE | UPON | PLACES | _LONE
    if len(word) < 5 or word in whole or not word.isalpha() or word.endswith(("tight", "proof")):
        return [word]
    for prefix in _PREFIXES:
        rest = word.removeprefix(prefix)
        if rest != word and len(rest) > 2 and (rest in lexicon | ADJECTIVES or prefix == "is"):
            return [prefix, *_apart(rest, known)]
    form = verb_form(word)
    form = form if form is not None and is_verb(form[0]) else None
    for size in range(2, len(word) - 1):
        first, rest = word[:size], word[size:]
        verb = verb_form(first) is not None and len(first) > 2
        if (first in lexicon or verb) and (rest in lexicon | PARTICLES or rest in ADJECTIVES):
            if form is not None and (rest in ("in", "to", "at", "ed", "on") or len(first) < 3):
                continue
            if len(rest) < 3 and not (verb or first in RUN_TOGETHER):
                continue
            return [first, rest]
    if form is None:
        for size in range(2, len(word) - 3):
            first = word[:size]
            if first in ("go", "move", "pick", "put", "turn", "switch", "drop", "get"):
                rest_words = _apart(word[size:], known)
                known_all = set(rest_words) <= lexicon | PARTICLES | ADJECTIVES | {"not", "to"}
                if known_all or (word[size:].startswith("to") and len(word) > size + 4):
                    return [
                        first,
                        *(rest_words if known_all else ["to", *_apart(word[size + 2 :], known)]),
                    ]
    return [word]


def is_number(word: str) -> bool:
    """Whether a word of a name counts or enumerates: "2", "one"."""
    return word.isdigit() or word in _COUNTING


_COUNTING = word_set("one two three four five six seven eight nine ten")


def as_written(words: str, raw: str) -> str:
    """Words of a name with the capitals that its author gave to codes: bag A1, GP saddle.

    Args:
        words: In lower case.
        raw: The name as its author wrote it.
    """
    mixed = raw != raw.upper()
    for code in re.findall(r"(?<![A-Za-z0-9])[A-Z0-9]+(?![a-z0-9])|[A-Z]\d+", raw):
        telling = mixed or not code.isalpha() or len(code) == 1 or not _VOWEL.search(code)
        if not code.isdigit() and telling:
            words = re.sub(rf"(?<!\w){code.lower()}(?!\w)", code, words)
    return words
