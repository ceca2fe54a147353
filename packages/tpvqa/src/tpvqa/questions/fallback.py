"""Readable words for facts and actions that nobody gave words for, from their names alone."""

import re
from collections.abc import Sequence

from tpvqa.questions.template import indefinite_article

_PREPOSITIONS = {
    "above", "across", "against", "along", "around", "at", "atop", "before", "behind",
    "below", "beneath", "beside", "between", "by", "for", "from", "in", "inside", "into",
    "near", "of", "off", "on", "onto", "out", "outside", "over", "through", "to", "toward",
    "towards", "under", "underneath", "upon", "with", "within",
}  # fmt: skip
_VERBS = {
    "belongs": "belong", "blocks": "block", "connects": "connect", "contains": "contain",
    "covers": "cover", "exists": "exist", "faces": "face", "fits": "fit", "has": "have",
    "holds": "hold", "knows": "know", "leads": "lead", "leaks": "leak", "likes": "like",
    "needs": "need", "owns": "own", "requires": "require", "serves": "serve",
    "supports": "support", "touches": "touch", "wants": "want", "works": "work",
}  # fmt: skip
_LINKS = {
    **dict.fromkeys(("connected", "linked", "attached", "joined", "adjacent", "next"), "to"),
    **dict.fromkeys(("smaller", "larger", "bigger", "taller", "heavier", "lighter"), "than"),
}
_RUN_TOGETHER = {
    "goto": "go to", "moveto": "move to", "pickup": "pick up", "putdown": "put down",
    "turnon": "turn on", "turnoff": "turn off", "switchon": "switch on",
    "switchoff": "switch off", "handempty": "hand empty",
}  # fmt: skip
_IRREGULAR = {
    "be": "was", "begin": "began", "bend": "bent", "bring": "brought", "build": "built",
    "catch": "caught", "cut": "cut", "dig": "dug", "do": "did", "draw": "drew",
    "drink": "drank", "drive": "drove", "eat": "ate", "feed": "fed", "fill": "filled",
    "find": "found", "fly": "flew", "fold": "folded", "get": "got", "give": "gave",
    "go": "went", "hang": "hung", "have": "had", "hit": "hit", "hold": "held", "keep": "kept",
    "lay": "laid", "lead": "led", "leave": "left", "let": "let", "light": "lit",
    "make": "made",
    "meet": "met", "put": "put", "read": "read", "ride": "rode", "run": "ran", "see": "saw",
    "sell": "sold", "send": "sent", "set": "set", "shake": "shook", "shut": "shut",
    "sit": "sat", "slide": "slid", "spread": "spread", "stand": "stood", "stick": "stuck",
    "sweep": "swept", "swing": "swung", "take": "took", "tear": "tore", "throw": "threw",
    "wind": "wound", "write": "wrote",
}  # fmt: skip


def words_of(name: str) -> str:
    """A PDDL name as words: "toy_eggplant" → "toy eggplant", "plate2" → "plate 2"."""
    spaced = re.sub(r"(?<=[a-z])(?=\d)", " ", re.sub(r"[_\-\s]+", " ", name)).strip()
    return _RUN_TOGETHER.get(spaced, spaced) or name


def question_about(predicate: str, parameters: Sequence[str]) -> str:
    """A question about a predicate, with a placeholder for each parameter.

    >>> question_about("in_hand", ["x", "h"])
    'Is the {x} in hand ({h})?'
    >>> question_about("connected", ["a", "b"])
    'Is the {a} connected to the {b}?'
    """
    words = words_of(predicate).split()
    if not parameters:
        return f"Is it true: {' '.join(words)}?"
    first, rest = f"the {{{parameters[0]}}}", list(parameters[1:])
    if words[0] in ("is", "are") and len(words) > 1:
        words = words[1:]
    if words[0] in _VERBS and (rest or len(words) > 1 or words[0] != "has"):
        verb = _VERBS[words[0]]
        if rest:
            tail = " ".join([f"the {{{rest[0]}}}", *words[1:]])
            return f"Does {first} {verb} {tail}{_in_brackets(rest[1:])}?"
        noun = [indefinite_article(words[1])] if verb == "have" else []
        return " ".join(["Does", first, verb, *noun, *words[1:]]) + "?"
    if words[0] == "can" and len(words) > 1:
        return f"Can {first} {' '.join(words[1:])}{_in_brackets(rest)}?"
    if rest and words[-1] in _LINKS:
        words = [*words, _LINKS[words[-1]]]
    if rest and (words[-1] in _PREPOSITIONS | {"than"} or words[-1].endswith("ing")):
        return f"Is {first} {' '.join(words)} the {{{rest[0]}}}{_in_brackets(rest[1:])}?"
    return f"Is {first} {' '.join(words)}{_in_brackets(rest)}?"


def say(action: str, parameters: Sequence[str]) -> str:
    """How an action is said, with a placeholder for each parameter.

    >>> say("place_on", ["a", "b"])
    'place the {a} on the {b}'
    >>> say("pick_up", ["x", "where", "h"])
    'pick up the {x} ({where}, {h})'
    """
    words = words_of(action).split()
    if not parameters:
        return " ".join(words)
    first, rest = f"the {{{parameters[0]}}}", list(parameters[1:])
    if rest and len(words) > 1 and words[-1] in _PREPOSITIONS:
        verb, preposition = " ".join(words[:-1]), words[-1]
        return f"{verb} {first} {preposition} the {{{rest[0]}}}{_in_brackets(rest[1:])}"
    return f"{' '.join(words)} {first}{_in_brackets(rest)}"


def past(sentence: str) -> str:
    """A sentence that begins with a verb, in the past tense: "place the …" → "placed the …"."""
    verb, space, rest = sentence.partition(" ")
    return _past_of(verb) + space + rest


def _past_of(verb: str) -> str:
    low = verb.lower()
    if low in _IRREGULAR:
        return _IRREGULAR[low]
    if not low.isalpha():
        return verb
    if low.endswith("e"):
        return verb + "d"
    if re.search(r"[^aeiou]y$", low):
        return verb[:-1] + "ied"
    one_syllable = len(re.findall(r"[aeiou]", low)) == 1
    if one_syllable and re.search(r"[^aeiou][aeiou][^aeiouwxy]$", low):
        return verb + verb[-1] + "ed"
    return verb + "ed"


def _in_brackets(parameters: Sequence[str]) -> str:
    return f" ({', '.join(f'{{{name}}}' for name in parameters)})" if parameters else ""
