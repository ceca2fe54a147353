"""How English verbs go: from any form to the base, and back."""

import re
from enum import Enum, auto
from functools import cache

from tpvqa.drafting.lexicon import (
    ADJECTIVES,
    DOUBLED,
    INTRANSITIVE,
    IRREGULAR,
    PARTICLES,
    POSTURES,
    PREPOSITIONS,
    REGULAR,
    STATES,
    STATIVE,
)

_VERBS = REGULAR | STATES | STATIVE | POSTURES | INTRANSITIVE | set(IRREGULAR)

NOUNS = ("saw", "ground", "lay")
"""What reads as another word before it reads as a participle."""


class Form(Enum):
    """A form of a verb."""

    BASE = auto()
    THIRD = auto()
    ING = auto()
    PARTICIPLE = auto()


def is_verb(word: str) -> bool:
    """Whether a word is the base of a known verb: put, stack."""
    return word in _VERBS


def verb_form(word: str) -> tuple[str, Form] | None:
    """The base of a verb and which form a word is; None where it seems to be no verb.

    >>> verb_form("carries")
    ('carry', <Form.THIRD: 2>)
    >>> verb_form("table")
    """
    if word in _known_forms():
        return _known_forms()[word]
    for ending, form in (("ing", Form.ING), ("ed", Form.PARTICIPLE)):
        if word.endswith(ending) and len(word) > len(ending) + 3:
            return word[: -len(ending)], form
    return None


@cache
def _known_forms() -> dict[str, tuple[str, Form]]:
    """The forms of the verbs of the lexicon; a word that is several is the first of these."""
    found: dict[str, tuple[str, Form]] = {}
    for form, made in (
        (Form.PARTICIPLE, participle),
        (Form.BASE, str),
        (Form.PARTICIPLE, past),
        (Form.ING, ing),
        (Form.THIRD, third),
    ):
        for base in sorted(_VERBS):
            if not (form is Form.PARTICIPLE and made(base) in NOUNS):
                found.setdefault(made(base), (base, form))
    return found


def third(base: str) -> str:
    """ "carry" → "carries"."""
    if base in ("have", "be", "do", "go"):
        return {"have": "has", "be": "is", "do": "does", "go": "goes"}[base]
    if re.search(r"(?:s|x|z|ch|sh)$", base):
        return base + "es"
    return base[:-1] + "ies" if re.search(r"[^aeiou]y$", base) else base + "s"


def ing(base: str) -> str:
    """ "lie" → "lying", "put" → "putting"."""
    if base.endswith("ie"):
        return base[:-2] + "ying"
    if base.endswith("e") and not base.endswith(("ee", "oe", "ye")) and len(base) > 2:
        return base[:-1] + "ing"
    return (base + base[-1] if _doubles(base) else base) + "ing"


def past(base: str) -> str:
    """ "take" → "took", "stack" → "stacked"."""
    return IRREGULAR[base][0] if base in IRREGULAR else _regular(base)


def participle(base: str) -> str:
    """ "take" → "taken", "stack" → "stacked"."""
    return IRREGULAR[base][1] if base in IRREGULAR else _regular(base)


def _regular(base: str) -> str:
    if base.endswith("e"):
        return base + "d"
    if re.search(r"[^aeiou]y$", base):
        return base[:-1] + "ied"
    return (base + base[-1] if _doubles(base) else base) + "ed"


def _doubles(base: str) -> bool:
    if base in DOUBLED or (len(base) > 5 and base.endswith("el")):
        return True  # labelled, refuelled
    stem = base.removeprefix("un").removeprefix("re") if len(base) > 4 else base
    short = len(re.findall(r"[aeiou]+", stem)) == 1
    return short and re.search(r"[^aeiou][aeiou][^aeiouwxy]$", stem) is not None


def is_ing(word: str) -> bool:
    """Whether a word says what goes on: standing."""
    return (verb_form(word) or ("", None))[1] is Form.ING


def does_verb(word: str) -> bool:
    """Whether a word says what somebody does: holding, holds."""
    return (verb_form(word) or ("", None))[1] in (Form.ING, Form.THIRD)


def does(words: list[str]) -> bool:
    """Whether words say what something does, and where: lies on, fits in."""
    return len(words) == 2 and (verb_form(words[0]) or ("", None))[1] is Form.THIRD


def stands(words: list[str]) -> bool:
    """Whether words say no more than where something is: lies next to, stands between."""
    base, form = verb_form(words[0]) or ("", None)
    further = words[1:] != [] and (len(words) > 2 or words[1] not in PREPOSITIONS - {"between"})
    return further and base in POSTURES and form is Form.THIRD


def is_there(words: list[str]) -> bool:
    """Whether words say where something is: in lift, on left; not in door locked."""
    if len(words) < 2 or words[0] not in PREPOSITIONS or words[-1] in PREPOSITIONS:
        return False
    how = words[-1] in ADJECTIVES | PARTICLES or (verb_form(words[-1]) or ("", None))[1] in (
        Form.PARTICIPLE,
        Form.ING,
    )
    return len(words) == 2 or not how
