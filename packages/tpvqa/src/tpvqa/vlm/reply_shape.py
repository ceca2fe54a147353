"""What shape a language model's reply must have to count as yes or no.

A model is asked for one word. What it says counts only in one of two shapes; all else is *unknown*,
as a wrong yes or no does more harm than an abstention.

First its wrapping is taken off, a dozen layers at most: white space, quotes, Markdown emphasis and
code fences around the whole; reasoning before the answer (`<think>…</think>`);
`<answer>…</answer>`; a label ("Answer:", "The final answer is"); the JSON object
`{"answer": "yes"}` with that field alone. What is left must have 2,000 characters at most and be

1. **the word alone**, yes or no, with at most one full stop or exclamation mark after it; or
2. **the word, a separator** (one of `, . ; : ! –` or a new line) **and one or two clauses, each of
   which answers the question in its own words** and says the same as the word. A clause answers it
   if it has a verb (is, has, does, …) after its subject, and apart from articles, pronouns of the
   third person and such verbs holds only words of the question, in the question's order.
   - After *yes* it denies nothing.
   - After *no* it denies that with exactly one "not" or "no" ("there is no plate in the sink"), or
     has in place of a word of the question exactly one that excludes it: *closed* for *open*. With
     both it contradicts itself: "the closed fridge is open".
   - That something is there, or not there, answers a question that asks that ("Is there …?");
     elsewhere it does with all that the question names: "there is no fridge" says nothing of
     whether it is open. Of the picture itself it answers nothing: "there is no image".

So whatever else is said takes the reply out of both shapes: doubt, percentages, a person ("I"), a
contradiction, an excuse, another language, a word that only begins with yes or no. There is no list
of phrases to be kept. Words are English, in ASCII letters.

Whoever asks waits while a reply is read, and a reply may be made to be read slowly: every pattern
here takes time in proportion to the text.
"""

import itertools
import re
from collections.abc import Sequence

from tpvqa.vlm.answer import Reply

_THOUGHTS = r"<(think|thinking|reasoning)>"
_WRAPPINGS = tuple(
    re.compile(pattern, re.DOTALL | re.IGNORECASE | re.ASCII)
    for pattern in (
        r"```(?:json|text)?[ \t]*+\n?(?P<inside>[^`]*)```",
        r"`(?P<inside>[^`]*)`",
        r"<answer>(?P<inside>[^<>]*)</answer>",
        r'\{\s*"answer"\s*:\s*"(?P<inside>[^"\\{}]*)"\s*\}',
        r'"(?P<inside>[^"]*)"',
        r"'(?P<inside>[^']*)'",
        r"\*(?P<inside>[^*]*)\*",
        r"_(?P<inside>[^_]*)_",
    )
)
_LABEL = re.compile(
    r"(?:the\s+)?(?:final\s+)?answer(?:\s*:\s*|\s+is(?:\s*:\s*|\s+))(?P<inside>.*)",
    re.DOTALL | re.IGNORECASE | re.ASCII,
)
_REASONING = re.compile(
    rf"(?:{_THOUGHTS}(?:(?!</?\1>).)*</\1>"
    r"|(?:(?!</?think>).)*</think>)(?P<inside>.*)",  # some servers leave out how it begins
    re.DOTALL | re.IGNORECASE | re.ASCII,
)
_EMPHASIS = re.compile(r"(?<![\w*])(\*{1,3}|_{2})(?![\s*_])([^*_\n]*[^\s*_])\1(?![\w*])")
_STRAIGHT = str.maketrans("“”„«»‘’‚", '"""""\'\'\'')
_ALONE = re.compile(r"""(["'*_]?)(yes|no)([.!]?)\1([.!]?)""", re.IGNORECASE | re.ASCII)
_MORE = re.compile(
    r"(yes|no)(?:\s*[,.;:!]\s+|\s+[-–—]+\s+|\s*—\s*|\s*\n\s*)(\S.*)",
    re.IGNORECASE | re.ASCII | re.DOTALL,
)
_CLAUSE_ENDS = re.compile(r"[.!;]\s+|\n\s*")
_CLAUSE = re.compile(r"[a-z]+(?:['-][a-z]+)*(?: [a-z]+(?:['-][a-z]+)*)*", re.ASCII)
_MOST_CLAUSES = 2
_MOST_WRAPPINGS = 12
_LONGEST = 2000
"""Characters of an answer without its wrapping."""

_SLIGHT = frozenset(
    ["the", "a", "an", "it", "its", "is", "are", "there", "they", "does", "do", "has", "have"]
)
_VERBS = frozenset(
    ["is", "are", "was", "were", "does", "do", "did", "has", "have", "had", "can", "could", "will"]
)
_DENIALS = frozenset(("not", "no"))
_BEGINNINGS = frozenset(
    ["the", "a", "an", "in", "on", "at", "of", "to", "from", "under", "near", "with", "no"]
)
_SHORT = (("cannot", "can not"), ("can't", "can not"), ("n't", " not"), ("'re", " are"))
_EXCLUDING = {
    "closed": ("open", "opened"),
    "shut": ("open", "opened"),
    "open": ("closed", "shut"),
    "opened": ("closed", "shut"),
    "off": ("on",),
    "on": ("off",),
    "dirty": ("clean", "cleaned", "washed"),
    "clean": ("dirty",),
    "empty": ("full", "filled", "hand", "gripper", "holding", "held"),
    "full": ("empty",),
    "whole": ("halved", "cut", "sliced"),
    "wet": ("dry",),
    "dry": ("wet",),
    "locked": ("unlocked",),
    "unlocked": ("locked",),
    "lit": ("unlit",),
    "unlit": ("lit",),
}
"""A word, and those which cannot be true of a thing that it is true of."""
_STATES = frozenset(word for each in _EXCLUDING.values() for word in each) - {"hand", "gripper"}
"""What is said of a thing. A hand may itself be empty, where it was asked what it holds."""
_EXISTING = frozenset(["there", "has", "have"])
_ABOUT_THE_REPLY = frozenset(
    ["answer", "question", "image", "picture", "photo", "information", "idea", "way", "problem"]
)


def still_thinking(text: str) -> bool:
    """Whether a reply ends inside its reasoning."""
    return re.match(rf"\s*{_THOUGHTS}(?!.*</\1>)", text, re.I | re.S) is not None


def read_words(text: str, question: str | None = None, *, cut: bool = False) -> Reply:
    """What a reply says: yes or no where it has one of the two shapes, otherwise *unknown*.

    Args:
        text: The raw reply.
        question: What was asked. Where that is not known, a clause may name any things, and
            only the states and places that this module knows.
        cut: Whether the reply ended at a limit of its length. Then it has to end with a full
            stop: what looks like a "No" may be the beginning of "Not sure".
    """
    said = unwrapped(text)
    if len(said) > _LONGEST or (cut and not said.endswith((".", "!"))):
        return Reply.UNKNOWN
    alone = _ALONE.fullmatch(said)
    if alone and not (alone[3] and alone[4]):
        return Reply(alone[2].lower())
    more = _MORE.fullmatch(said)
    if more is None:
        return Reply.UNKNOWN
    reply = Reply(more[1].lower())
    parts = map(str.strip, _CLAUSE_ENDS.split(_without_stop(more[2])))
    clauses = [clause for clause in parts if clause]
    if len(clauses) > _MOST_CLAUSES:
        return Reply.UNKNOWN
    same = [_answers(clause, reply is Reply.YES, question) for clause in clauses]
    return reply if same and all(same) else Reply.UNKNOWN


def unwrapped(text: str) -> str:
    """A reply without its wrapping; nothing is left of one that is wrapped too deeply."""
    said = _without(_REASONING, text.strip())
    said = _unpacked(said)
    return _unpacked(_without(_LABEL, said))


def _unpacked(said: str) -> str:
    """Without what stands around the whole of it."""
    for _ in range(_MOST_WRAPPINGS):
        before = said
        said = _EMPHASIS.sub(r"\2", said.translate(_STRAIGHT))
        for wrapping in _WRAPPINGS:
            said = _without(wrapping, said)
        if said == before:
            return said
    return ""


def _without(wrapping: re.Pattern[str], said: str) -> str:
    found = wrapping.fullmatch(said)
    return (found["inside"] if found else said).strip()


def _answers(clause: str, yes: bool, question: str | None) -> bool:
    """Whether a clause answers the question by itself, and with this word."""
    words = _words(clause)
    verbs = _VERBS.intersection(words)
    if not verbs or words[0] in _VERBS or (words[-1] in _BEGINNINGS and not _ends(words, question)):
        return False
    denials = sum(word in _DENIALS for word in words)
    told = [word for word in words if word not in _SLIGHT | _DENIALS | _VERBS]
    if question is None:
        asked = _nameable(words)
    else:
        asked = _words(question.strip().rstrip("?"))
        if _DENIALS.intersection(asked):
            return False  # does "no" deny it, or agree?
    if not verbs <= _SLIGHT.union(asked):
        return False  # "it was open" says nothing of now
    if question is not None and _beside_the_question(words, told, asked):
        return False
    excluding = [word for word in told if word not in asked and _excludes(word, asked)]
    same = [_stem(word) for word in told if word not in excluding]
    if question is not None and any(_beside_its_opposite(word, same, asked) for word in excluding):
        return False
    if question is None:
        fits = set(same) <= set(map(_stem, asked))
        return fits and (denials == 0 if yes else denials == 1 or (denials == 0 and bool(told)))
    wanted = iter(map(_stem, asked))
    in_order = all(word in wanted for word in same)
    return in_order and denials + len(excluding) == (0 if yes else 1)


def _beside_the_question(words: Sequence[str], told: Sequence[str], asked: Sequence[str]) -> bool:
    """Whether a clause says that something is there, and not what was asked of it.

    "There is no image" does not say that no plate is in it, "there is no fridge" not that it is
    closed.
    """
    content = [word for word in asked if word not in _SLIGHT | _DENIALS | _VERBS]
    for before, word in itertools.pairwise(["", *content]):
        if word in _ABOUT_THE_REPLY and word in told and before in _BEGINNINGS:
            at = told.index(word)
            if at == 0 or told[at - 1] != before:
                return True
    new = _EXISTING.intersection(words).difference(asked)
    return bool(new) and len(told) < len(content)


def _nameable(words: Sequence[str]) -> list[str]:
    """The words that a clause may hold where the question is not known."""
    named = [
        after
        for before, after in itertools.pairwise(words)
        if before in ("the", "a", "an", "no") and after not in _ABOUT_THE_REPLY
    ]
    owned = [word for word in ("gripper", "hand", "door") if word in words]
    return [*named, *owned, *_EXCLUDING, "in", "on", "under", "at"]


def _words(clause: str) -> list[str]:
    """The words of a clause; none where it holds anything but words."""
    text = " ".join(clause.lower().split())
    if not _CLAUSE.fullmatch(text):
        return []
    for short, long in _SHORT:
        text = text.replace(short, long)
    text = re.sub(r"\b(it|there)'s\b", r"\1 is", text)
    return [re.sub(r"'s?$", "", word) for word in text.split()]


def _ends(words: Sequence[str], question: str | None) -> bool:
    """Whether a last word such as "on" ends the question, too: "the lamp is on"."""
    return question is None or _words(question.strip().rstrip("?"))[-1:] == [words[-1]]


def _excludes(word: str, asked: Sequence[str]) -> bool:
    return any(other in asked for other in _EXCLUDING.get(word, ()))


def _beside_its_opposite(word: str, same: Sequence[str], asked: Sequence[str]) -> bool:
    """Whether what a word excludes, and was asked for, is said as often, and so denied by nothing.

    Of states what is asked for stands last: "the cut apple is whole" denies "Is the cut apple
    halved?". And "the lamp on the table is off" says "on" once, where it was asked twice.
    """
    wanted = next((each for each in reversed(asked) if each in _STATES), None)
    if wanted not in _EXCLUDING[word]:
        return False
    stem = _stem(wanted)
    return same.count(stem) >= sum(_stem(each) == stem for each in asked)


def _without_stop(text: str) -> str:
    return re.sub(r"[.!]$", "", text.strip())


def _stem(word: str) -> str:
    return re.sub(r"(?<=[a-z]{3})(?:ed|es|s|e)$", "", word)
