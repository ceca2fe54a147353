"""Predicates of nothing in particular: handempty(), raining(), holding-can()."""

from collections.abc import Iterator

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import ROBOT, Clause, Noun, part
from tpvqa.drafting.facts_tables import HELD, UNNAMED
from tpvqa.drafting.forms import Form, verb_form
from tpvqa.drafting.lexicon import ADJECTIVES, PARTICLES, PREPOSITIONS, word_set
from tpvqa.drafting.things import behind, some

WEATHER = ("raining", "snowing", "freezing", "burning")
"""What it does, whoever it is."""
_OF_ROBOTS = word_set(
    "free idle ready busy moving docked holding charging charged parked "
    "standing armed tired hungry awake broken alive home crashed"
)


def of_nothing(words: list[str]) -> Iterator[Clause]:
    """Clauses of a predicate without arguments.

    Args:
        words: Its words.
    """
    if words[0] in ("have", "has") and len(words) > 1:
        yield Clause("does", ROBOT, f"have {some(words[1:])}")
        return
    if words[0] in HELD and not {*words[1:]} & UNNAMED and len(words) > 1:
        yield Clause("is", ROBOT, f"{words[0]} {some(words[1:])}")
        return
    form = verb_form(words[0])
    if len(words) == 1 or (form and form[1] is Form.ING):
        moving = form is not None and form[1] is Form.ING and words[0] not in WEATHER
        done = form is not None and form[1] is Form.PARTICIPLE
        who = Noun("anything") if done else Noun("it")
        who = Noun("the task") if words[0] in ("done", "finished", "completed") else who
        who = ROBOT if words[0] in _OF_ROBOTS or moving else who
        yield Clause("is", who, " ".join(words))
        return
    if (form and form[1] is Form.PARTICIPLE) or (
        words[0] in ADJECTIVES and words[0] not in lexicon.SWITCHED
    ):
        if words[1] in PARTICLES:
            yield Clause("is", ROBOT, " ".join(words))
            return
        named = ("hands" if word == "handed" else word for word in words[1:])  # free-handed
        words = [*named, words[0]]  # free_hands: the hands are free
    split = next(
        (
            at
            for at, word in enumerate(words)
            if at
            and (
                word in PREPOSITIONS | ADJECTIVES | PARTICLES
                or (verb_form(word) or ("", None))[1] in (Form.PARTICIPLE, Form.ING)
            )
        ),
        None,
    )
    if split is None:
        return
    subject = " ".join(words[:split])
    own = words[split - 1] in lexicon.PARTS_OF_ROBOTS and words[0] != "robot"
    whose = "robot's " if own else ""
    noun = part(f"{whose}{subject}")
    rest = behind(words[split:])
    yield Clause("is", noun, rest)
    if rest in ("empty", "free") and own:
        yield Clause("is", noun, "free" if rest == "empty" else "empty")
