"""How English verbs go: from any form to the base, and back."""

import re
from enum import Enum, auto

from tpvqa.drafting.lexicon import (
    INTRANSITIVE,
    IRREGULAR,
    POSTURES,
    REGULAR,
    STATES,
    STATIVE,
)

_VERBS = REGULAR | STATES | STATIVE | POSTURES | INTRANSITIVE | set(IRREGULAR)
_OF_PARTICIPLES = {participle: base for base, (_, participle) in IRREGULAR.items()}
_OF_PAST = {past: base for base, (past, _) in IRREGULAR.items()}


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
    if word in _OF_PARTICIPLES:
        return _OF_PARTICIPLES[word], Form.PARTICIPLE
    if word in _VERBS:
        return word, Form.BASE
    if word in _OF_PAST:
        return _OF_PAST[word], Form.PARTICIPLE
    for ending, form in (("ing", Form.ING), ("ed", Form.PARTICIPLE), ("s", Form.THIRD)):
        if word.endswith(ending) and len(word) > len(ending) + 2:
            known = [base for base in _bases(word, ending) if base in _VERBS]
            if known:
                return known[0], form
            if ending == "ed" or (ending == "ing" and len(word) > 6):
                return _bases(word, ending)[0], form
    return None


def _bases(word: str, ending: str) -> list[str]:
    stem = word[: -len(ending)]
    found = [stem]
    if ending == "s":
        found = [stem, *([stem[:-1]] if stem.endswith("e") else [])]
        return [*found, stem[:-2] + "y"] if stem.endswith("ie") else found
    if len(stem) > 2 and stem[-1] == stem[-2] and stem[-1] not in "sl":
        found.insert(0, stem[:-1])
    if stem.endswith("i") and ending == "ed":
        found.insert(0, stem[:-1] + "y")
    found.append(stem + "e")
    if len(stem) > 2 and stem[-1] == stem[-2]:
        found.append(stem[:-1])
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
    if len(base) > 5 and base.endswith("el"):
        return True  # labelled, refuelled
    stem = base.removeprefix("un").removeprefix("re") if len(base) > 4 else base
    short = len(re.findall(r"[aeiou]+", stem)) == 1
    return short and re.search(r"[^aeiou][aeiou][^aeiouwxy]$", stem) is not None
