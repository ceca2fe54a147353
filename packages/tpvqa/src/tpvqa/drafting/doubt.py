"""What the name of a predicate leaves open, and what of it a picture seldom shows."""

import re
from collections.abc import Sequence

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import Clause, Noun
from tpvqa.drafting.forms import Form, is_ing, verb_form
from tpvqa.drafting.lexicon import ADJECTIVES, PARTICLES, PREPOSITIONS
from tpvqa.drafting.of_nothing import WEATHER
from tpvqa.drafting.things import Things


def open_to_doubt(words: list[str], nouns: Sequence[Noun], clause: Clause) -> bool:
    """Whether a name may as well mean something else than what it was put into.

    Args:
        words: Of the predicate's name.
        nouns: Its arguments.
        clause: What it was put into.
    """
    if clause.subject.said in ("it", "anything"):
        return words[0] not in WEATHER
    coded = [at for at, word in enumerate(words) if re.match(r"\d+[a-z]", word)]
    if any(at == 0 or words[at - 1] not in PREPOSITIONS for at in coded):
        return True  # ready4show, not inflated-to-4bar
    if not nouns or " of " not in clause.subject.said or len(words) < 2:
        return False
    return (words[0] not in ADJECTIVES and is_done(words[0])) or _covering(words, clause)


def _covering(words: list[str], clause: Clause) -> bool:
    """Whether a thing may be covered with what it is asked to be covered of: lens-covered(x)."""
    form = verb_form(words[-1])
    done = form is not None and form[1] is Form.PARTICIPLE and clause.rest == words[-1]
    with_it = form is not None and lexicon.TAKES.get(form[0]) == "with"
    return done and with_it and words[-2] not in lexicon.PARTS


def either_of(words: list[str], named: Sequence[frozenset[str]]) -> bool:
    """Whether neither of two arguments is what the other is said to have: twin_of(x, y).

    Args:
        words: Of the predicate's name.
        named: What each argument may be called.
    """
    if len(named) < 2 or len(words) < 2 or words[-1] != "of":
        return False
    begun = words[0] in PREPOSITIONS or verb_form(words[0]) is not None
    return not begun and words[-2] != "top" and not any(words[-2] in each for each in named)


def lacks_a_word(clause: Clause, nouns: Sequence[Noun], things: Things) -> bool:
    """Whether a question breaks off at a preposition, or joins a place to a verb without one:
    filled-with(x), grows(plant, bed).

    Args:
        clause: What the name was put into.
        nouns: Its arguments.
        things: The task's things.
    """
    said = clause.rest.split()
    verbal = len(said) > 1 and (is_done(said[-2]) or is_ing(said[-2]))
    if verbal and said[-1] in PREPOSITIONS - PARTICLES:
        return True
    if len(nouns) < 2 or not clause.subject.objects or things.act(clause.subject.objects):
        return False
    verb, _, of = clause.rest.partition(" ")
    return is_ing(verb) and of == nouns[1].said and things.are_places(nouns[1].objects)


def seldom_shown(words: list[str]) -> bool:
    """Whether a name says what a picture seldom shows: inspected, warm-enough."""
    said = words[:-1] if words[-1] == "enough" and len(words) > 1 else words
    return said[-1] in lexicon.UNSEEN


def is_done(word: str) -> bool:
    """Whether a word says what was done with a thing: washed."""
    form = verb_form(word)
    return form is not None and form[1] is Form.PARTICIPLE


def is_misread(clause: Clause) -> bool:
    """Whether it is of what is no thing: "the trolley in of the {t}"."""
    named, of, _ = clause.subject.said.partition(" of ")
    words = named.split()
    if not of or words[1:] in (["inside"], ["outside"], ["back"]):
        return False
    return not PREPOSITIONS.isdisjoint(words) or words[-1] in PARTICLES
