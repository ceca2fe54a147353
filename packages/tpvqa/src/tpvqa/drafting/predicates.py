"""Predicates that are verbs, adjectives and nouns: washed(x), clean(x), fuel(plane, level)."""

from collections.abc import Callable, Iterator

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import ROBOT, Clause, Noun, Phrases, part
from tpvqa.drafting.facts_tables import COMPARED, ELSE, HANDLING, LINKS, PICTURES, ROADS
from tpvqa.drafting.forms import Form, ing, participle, verb_form
from tpvqa.drafting.lexicon import ADJECTIVES, PARTICLES, PREPOSITIONS, STATES
from tpvqa.drafting.things import behind, plural, some
from tpvqa.questions.template import indefinite_article

HELD = ("hold", "carry", "grasp", "lift", "grip")
"""What is done to a thing that is in a hand."""
Others = Callable[[list[Noun]], list[str]]
"""Says further things with their prepositions."""


def without_kind(words: list[str], kinds: frozenset[str], *, alone: bool, acts: bool) -> list[str]:
    """The words of a predicate without what its first argument is, where they say that again:
    wheel-mounted(wheel), hose-connected-to(hose, valve), can-in-slot(can, slot),
    carrying-card(card).

    Args:
        words: Of its name.
        kinds: What the argument is called.
        alone: Whether there is no other argument.
        acts: Whether it acts by itself: then person-served(person, drink) is no served(…).
    """
    joined = len(words) > 2 and words[-1] in PREPOSITIONS
    form = verb_form(words[-2 if joined else -1])
    if len(words) > 1 and words[0] in kinds:
        done = form is not None and form[1] is Form.PARTICIPLE and (alone or joined or not acts)
        placed = len(words) > 2 and words[1] in PREPOSITIONS and not alone
        second = verb_form(words[1])
        begun = len(words) > 2 and second is not None and second[1] is Form.PARTICIPLE
        return words[1:] if done or placed or begun else words
    first = verb_form(words[0])
    doing = first is not None and first[1] is Form.ING
    return words[:1] if len(words) == 2 and alone and doing and words[1] in kinds else words


def of_verb(
    phrases: Phrases, form: tuple[str, Form], words: list[str], nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    """Clauses of a predicate whose first word is a form of a verb.

    Args:
        phrases: Says things.
        form: The verb's base, and its form.
        words: The predicate's words.
        nouns: Its arguments.
        others: Says further arguments.
    """
    base, shape = form
    extra = " ".join(words[1:])
    match shape:
        case Form.PARTICIPLE:
            yield from _done(phrases, base, words, nouns, others)
        case Form.ING:
            yield from _doing(phrases, base, extra, nouns, others)
        case _:
            yield from _does(phrases, base, extra, nouns, others)


def _done(
    phrases: Phrases, base: str, words: list[str], nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    """washed(x), inserted(x, y), visited(robot, place), toggled-on(x)."""
    things = phrases.things
    first, *rest = nouns
    said, extra = words[0], " ".join(words[1:])
    if rest:
        acting = things.act(first.objects) and not things.act(rest[0].objects)
        if acting and base in HELD and not extra:  # gripped(robot, x)
            yield Clause("is", rest[0], f"{said} by {first.said}")
            yield Clause("is", first, f"{ing(base)} {rest[0].said}")
            return
        if acting and base not in STATES | {"deliver", "take", "transport", "move", "assign"}:
            joined = " ".join([extra, rest[0].said, *others(rest[1:])])
            yield Clause("has", first, f"{participle(base)} {joined}")
            return
        if things.act(rest[0].objects) and base not in lexicon.TAKES:
            yield Clause("has", rest[0], f"{participle(base)} {first.said}")
            yield Clause("has", first, f"been {said} by {rest[0].said}")
            return
        if things.act(rest[0].objects) and base in HELD:
            held = "in" if things.hold(rest[0].objects) else "by"
            yield Clause("is", first, f"{said} {held} {rest[0].said}")
            yield Clause("is", rest[0], f"{ing(base)} {first.said}")
            return
        if rest[0].parameter in ("from", "to", "with", "by", "into"):
            tail = " ".join(others(rest))
            yield Clause("has", first, f"been {said} {extra} {tail}".replace("  ", " "))
            return
        if things.nouns(rest[0].objects) & lexicon.COLOURS and not extra:
            yield Clause("is", first, f"{said} {{{rest[0].parameter}}}")
            yield Clause("has", first, f"been {said} {{{rest[0].parameter}}}")
            return
        joint: str | None = extra if extra in PREPOSITIONS else lexicon.TAKES.get(base)
        if extra and extra not in PREPOSITIONS:
            said = f"{said} {extra}"
        place = joint in (None, "at", "on", "in") and things.are_places(rest[0].objects)
        place = place and base not in lexicon.DIRECTED
        if place and extra not in PREPOSITIONS and all(map(things.holds_things, rest[0].objects)):
            joint = None  # stored: in a box, but on a shelf
        where = (
            phrases.placed(rest[0], joint if joint in ("on", "in") else None)
            if place
            else f"{'with' if joint is None else joint} {rest[0].said}"
        )
        tail = " ".join([where.strip(), *others(rest[1:])])
        yield Clause("is", first, f"{said} {tail}")
        yield Clause("has", first, f"been {said} {tail}")
        return
    if base in lexicon.INTRANSITIVE and not extra:
        yield Clause("has", first, participle(base))
        return
    if base in ("hold", "grasp", "grip", "carry", "lift") and not extra:
        yield Clause("is", ROBOT, f"{ing(base)} {first.said}")
        yield Clause("is", first, "in the robot's hand" if base != "lift" else "lifted")
        return
    if (
        extra
        and words[1] not in PREPOSITIONS
        and not {words[-1]} & (PARTICLES | ADJECTIVES | PREPOSITIONS | lexicon.SIDES)
    ):
        yield Clause("has", part(extra, first.said), f"been {said}")
        return
    if len(words) > 2 and words[1] in PREPOSITIONS:
        extra = behind(words[1:])  # mounted-in-stand
    state = {"opened": "open", "shut": "closed"}.get(said, said)
    state = f"{state} {extra}".strip()
    been = f"been {said} {extra}".strip()
    if base in STATES or extra in PARTICLES:
        yield Clause("is", first, state)
        yield Clause("has", first, been)
        if said in ELSE:
            yield Clause("is", first, ELSE[said])
    else:
        yield Clause("has", first, been)
        yield Clause("is", first, state)


def _doing(
    phrases: Phrases, base: str, extra: str, nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    """holding(x), carrying(robot, x), driving(person, van)."""
    things = phrases.things
    first, *rest = nouns
    said = f"{ing(base)} {extra}".strip()
    if rest and base in lexicon.POSTURES and not extra:
        yield from _does(phrases, base, extra, nouns, others)  # standing(crate, place)
        return
    if rest:
        second, *more = rest
        if things.act(second.objects) and not things.act(first.objects):
            first, second = second, first
        yield Clause("is", first, " ".join([said, second.said, *others(more)]))
        if base in ("hold", "carry", "grasp", "lift"):
            joint = "in" if things.hold(first.objects) else "held by"
            yield Clause("is", second, f"{joint} {first.said}")
        return
    acts = things.act(first.objects) and base not in ("hold", "carry", "grasp", "push", "use")
    if acts or base in lexicon.ALONE:
        yield Clause("is", first, said)
        return
    if things.act(first.objects) and phrases.things.task.domain_name:
        yield Clause("is", first, f"{said} anything")
        return
    yield Clause("is", ROBOT, f"{said} {first.said}")
    if base in ("hold", "carry", "grasp"):
        yield Clause("is", first, "in the robot's hand")


def _does(
    phrases: Phrases, base: str, extra: str, nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    """contains(x, y), faces(x, y), lies-on(x, place), carry(x, gripper), runs(x)."""
    things = phrases.things
    first, *rest = nouns
    at = extra if extra in PREPOSITIONS and rest else None
    extra = "" if at else extra
    if base in lexicon.POSTURES:
        # A robot stands at what things lie on.
        by = (
            at == "at"
            and things.act(first.objects)
            and all(things.place_of(each) == "on" for each in rest[0].objects)
        )
        where = f"{at} {rest[0].said}" if by else phrases.placed(rest[0], at) if rest else extra
        place = [where, *others(rest[1:])]
        if rest and at not in ("from", "by", "to", "with"):
            yield Clause("is", first, " ".join(place))
        yield Clause("is", first, f"{ing(base)} {' '.join(place)}".strip())
        return
    if not rest and base in HANDLING and not things.act(first.objects):
        yield from _doing(phrases, base, extra, nouns, others)  # carries(x): who but the robot
        return
    if not rest:
        yield (
            Clause("is", first, f"{ing(base)} {extra}".strip())
            if (base not in lexicon.STATIVE)
            else Clause("does", first, f"{base} {extra}".strip())
        )
        return
    second, *more = rest
    if at is None and things.act(second.objects) and not things.act(first.objects):
        first, second = second, first
    tail = " ".join([second.said, *([extra] if extra else []), *others(more)])
    usual = {"belong": "to ", "look": "at ", "lead": "to ", "connect": "to "}.get(base, "")
    joint = f"{at} " if at else usual
    if base in lexicon.STATIVE:
        yield Clause("does", first, f"{base} {joint}{tail}")
        if base == "hold" and things.act(first.objects) and not things.hold(first.objects):
            yield Clause("is", second, f"held by {first.said}")
        elif base in ("contain", "hold"):
            yield Clause("is", second, f"in {first.said}")
        elif base in ("cover", "support", "touch", "block"):
            yield Clause("is", first, f"{ing(base)} {tail}")
    else:
        yield Clause("is", first, f"{ing(base)} {joint}{tail}")
        if base == "carry":
            joint = "in" if things.hold(first.objects) else "held by"
            yield Clause("is", second, f"{joint} {first.said}")


def of_noun(
    phrases: Phrases, words: list[str], nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    """Clauses of a predicate that is an adjective or a noun.

    Args:
        phrases: Says things.
        words: The predicate's words.
        nouns: Its arguments.
        others: Says further arguments.
    """
    things = phrases.things
    first, *rest = nouns
    last, said = words[-1], " ".join(words)
    kinds = things.nouns(first.objects)
    if last == "enough" and len(words) > 1 and not rest:
        yield from _enough(words, first)
    elif not rest and len(words) > 1 and _strewn(words):
        yield Clause("is", first, f"{last} with {' '.join(words[:-1])}")  # dust-covered
    elif len(words) == 2 and words[0] in ADJECTIVES and last in kinds and not rest:
        yield Clause("is", first, words[0])
        if words[0] in ELSE:
            yield Clause("is", first, ELSE[words[0]])
    elif last in ("empty", "free", "full", "busy", "clean", "dirty") and len(words) > 1:
        if all(map(_says_how, words[:-1])):
            yield Clause("is", first, said)
        else:
            yield from _hand(phrases, words, first)
    elif len(words) == 1 and last == "clear" and not rest:
        yield from _clear(phrases, first)
    elif rest and last in COMPARED:
        yield Clause("is", first, f"{said} than {rest[0].said}")
    elif rest and last == "reachable" and things.act(first.objects):
        yield Clause("can", first, f"reach {rest[0].said}")
    elif rest and said in ("color", "colour"):
        yield Clause("is", first, f"{{{rest[0].parameter}}}")
        yield Clause("is", Noun(f"the {said} of {first.said}"), f"{{{rest[0].parameter}}}")
    elif (
        len(words) > 1
        and words[0] in ADJECTIVES
        and not rest
        and (last not in ADJECTIVES | PARTICLES | kinds and verb_form(last) is None)
    ):
        yield Clause("does", first, f"have {some(words)}")
    elif rest and last in LINKS:
        yield Clause("is", first, " ".join([said, LINKS[last], rest[0].said, *others(rest[1:])]))
    elif last in ROADS and len(rest) > 0:
        a = indefinite_article(said)
        yield Clause("is", Noun("there"), f"{a} {said} from {first.said} to {rest[0].said}")
    elif last in ADJECTIVES | PARTICLES | COMPARED or last.endswith(lexicon.ENDINGS):
        yield from _adjective(phrases, words, nouns, others)
    elif rest:
        yield from _property(phrases, said, nouns, others)
    elif last in kinds or last in things.vocabulary:
        yield Clause("is", first, f"{indefinite_article(said)} {said}")
    elif len(words) > 1 and verb_form(last) is not None and all(map(_says_how, words[:-1])):
        yield Clause("is", first, said)
    elif len(words) > 1 and verb_form(last) is not None:
        yield Clause("is", part(" ".join(words[:-1]), first.said), last)


def _enough(words: list[str], first: Noun) -> Iterator[Clause]:
    """warm-enough(x), water-enough(x)."""
    *before, enough = words
    if before[-1] in ADJECTIVES:
        yield Clause("is", first, " ".join(words))
    else:
        yield Clause("does", first, f"have {enough} {' '.join(before)}")


def _strewn(words: list[str]) -> bool:
    """Whether words say what a thing is covered or filled with: dust-covered."""
    form = verb_form(words[-1])
    if form is None or form[1] is not Form.PARTICIPLE:
        return False
    return lexicon.TAKES.get(form[0]) == "with" and words[-2] in lexicon.MASS


def _hand(phrases: Phrases, words: list[str], first: Noun) -> Iterator[Clause]:
    """handempty(robot), full-ferry would be an adjective first; slot_free(slot)."""
    *held, state = words
    kinds = phrases.things.nouns(first.objects) | {first.parameter}
    if held[-1] in kinds or phrases.things.hold(first.objects):
        yield Clause("is", first, state)
        if phrases.things.hold(first.objects) and state in ("empty", "free"):
            yield Clause("is", first, "holding nothing")
        elif state in ELSE:
            yield Clause("is", first, ELSE[state])
        return
    yield Clause("is", Noun(f"{first.said}'s {' '.join(held)}", plural=plural(held[-1])), state)
    if held[-1] in lexicon.HANDS and state in ("empty", "free", "full"):
        some = {"full": "anything"}.get(state, "nothing")
        yield Clause("is", first, f"holding {some}")


def _clear(phrases: Phrases, first: Noun) -> Iterator[Clause]:
    """Nothing lies on a block; nobody stands in a field."""
    task = phrases.things.task
    stacked = any(
        set(phrases.things.standing(name, 1)) & set(first.objects)
        for name, kinds in task.predicates.items()
        if name in ("on", "stacked", "above", "stacked_on", "on_top_of") and len(kinds) > 1
    )
    if stacked:
        yield Clause("is", Noun(f"the top of {first.said}"), "clear")
        yield Clause("is", Noun("there"), f"nothing on top of {first.said}")
    else:
        yield Clause("is", first, "clear")
        yield Clause("is", Noun("there"), f"nothing {phrases.placed(first)}")


def _adjective(
    phrases: Phrases, words: list[str], nouns: list[Noun], others: Others
) -> Iterator[Clause]:
    first, *rest = nouns
    *before, state = words
    tail = " ".join(others(rest))
    if state in PARTICLES and rest:
        tail = " ".join([phrases.placed(rest[0], "on"), *others(rest[1:])])
    kinds = phrases.things.nouns(first.objects) | {first.parameter}
    upright = before[-1:] == ["side"] and state in ("up", "down")
    if not (kinds & {*before[-1:]} or upright or all(map(_says_how, before))):
        # A part of the thing, as in quick-release-open; what is wide open is the thing itself.
        yield Clause("is", part(" ".join(before), first.said), f"{state} {tail}".strip())
        return
    said = state if before and before[-1] in kinds else " ".join(words)
    yield Clause("is", first, f"{said} {tail}".strip())
    if not rest and state in ("free", "empty") and phrases.things.hold(first.objects):
        yield Clause("is", first, "holding nothing")
    elif not rest and said == "open":
        yield Clause("does", first, "stand open")
    elif not rest and said in ELSE:
        yield Clause("is", first, ELSE[said])
    elif not rest and state not in PARTICLES:
        yield Clause("does", first, f"look {said}")


def _says_how(word: str) -> bool:
    """Whether a word before a state belongs to it: wide open, tightly closed, half full. What only
    tells a part from others does not: front open."""
    if word.endswith("ly"):
        return word not in lexicon.NO_ADVERBS
    return word in lexicon.DEGREES or word in ADJECTIVES - lexicon.SIDES - lexicon.NO_ADVERBS


def _property(phrases: Phrases, said: str, nouns: list[Noun], others: Others) -> Iterator[Clause]:
    """fuel(plane, level), sample(rover, spot), colour(block, paint)."""
    things = phrases.things
    first, second, *rest = nouns
    if things.act(first.objects) and not things.nouns(second.objects) & {"level", "amount"}:
        tail = " ".join([f"of {second.said}", *others(rest)])
        yield Clause("does", first, f"have {indefinite_article(said)} {said} {tail}")
    elif things.nouns(second.objects) & {"level", "amount", "number", "count", "value"}:
        yield Clause("is", Noun(f"the {said} of {first.said}"), f"at {second.said}")
    elif said.split()[-1] in PICTURES:
        tail = " ".join([f"of {first.said}", *others([second, *rest])])
        yield Clause("is", Noun("there"), f"{indefinite_article(said)} {said} {tail}")
    elif PREPOSITIONS.isdisjoint(said.split()):
        yield Clause("is", second, f"the {said} of {first.said}")
