"""What effects say of an action's parameters: what moves, where from and where to."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

from tpvqa.drafting import lexicon
from tpvqa.drafting.forms import Form, verb_form
from tpvqa.drafting.lexicon import PREPOSITIONS, word_set
from tpvqa.drafting.things import Things
from tpvqa.pddl.schema import ActionSchema

_SOURCES = ("from", "source", "start", "src", "sloc", "origin", "cur", "curpos", "current")
_TARGETS = ("to", "into", "onto", "dest", "destination", "target", "eloc", "end", "next", "nextpos")
_LOCATING = lexicon.POSTURES | word_set(
    "load insert stow put place stack park locate mount store set dock shelve position pack"
)
_JOINING = word_set("with by")
"""Prepositions behind which nothing is where something goes."""


@dataclass(frozen=True, slots=True)
class End:
    """Where something comes from, or goes.

    Attributes:
        source: Whether it comes from there.
        preposition: How the domain says it: on, in.
        fact: By which predicate what is there; empty where the name alone tells.
    """

    source: bool
    preposition: str | None = None
    fact: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Roles:
    """The parameters of an action by what becomes of them.

    Attributes:
        changing: Those that effects speak of.
        ends: Those where something comes from, and where it goes.
        moved: What goes there.
        reversed: Of an action that brings about its own verb, "cover" of covers(lid, box): what it
            is done to, and with what.
        counted: Those that only say how much is left of something, or what it no longer points at.
    """

    changing: frozenset[str]
    ends: dict[str, End] = field(default_factory=dict)
    moved: str = ""
    reversed: tuple[str, ...] = ()
    counted: frozenset[str] = frozenset()


def roles_of(schema: ActionSchema, things: Things) -> Roles:
    """The roles of an action's parameters."""
    names = [p.name for p in schema.parameters]
    changing = frozenset(
        word for effect in schema.effects for word in effect.literal.arguments if word in names
    )
    ends: dict[str, End] = {}
    moved = ""
    for predicate, arguments, positive in _placing(schema, things):
        *subject, place = arguments
        if place in names and place not in ends:
            kind = next(p.type for p in schema.parameters if p.name == place)
            ends[place] = End(
                not positive, _preposition(predicate, things, kind), (predicate, *subject)
            )
            moved = moved or (subject[0] if subject else "")
        elif place in names and ends[place].source == positive:
            del ends[place]  # it is both left and reached
    changed = list(_changed(schema, names))
    counted = frozenset(name for pair in changed for name in pair if ends) - frozenset(ends)
    counted |= _turned_from(schema, things)
    ends = ends or (changed[0] if changed else {})
    for name in names:
        plain = name.lstrip("?").split("-")[-1].split("_")[-1]
        if plain in _SOURCES or plain in _TARGETS:
            ends[name] = replace(ends.get(name, End(source=True)), source=plain in _SOURCES)
    return Roles(changing, ends, moved, _reversed(schema, things), counted)


def _placing(schema: ActionSchema, things: Things) -> Iterator[tuple[str, tuple[str, ...], bool]]:
    """The effects that say where something is: at(x, place), robot_in(place)."""
    unary: dict[str, set[bool]] = {}
    for effect in schema.effects:
        unary.setdefault(effect.literal.predicate, set()).add(effect.literal.positive)
    for effect in schema.effects:
        literal = effect.literal
        words = things.words(literal.predicate)
        form = verb_form(words[0])
        joints = PREPOSITIONS - _JOINING
        located = not joints.isdisjoint((words[0], words[-1])) and (
            literal.positive or not _directed(words)
        )
        located = located or (form is not None and form[0] in _LOCATING)
        if not located or not literal.arguments:
            continue
        if len(literal.arguments) > 1 or len(unary[literal.predicate]) > 1:
            yield literal.predicate, literal.arguments, literal.positive


def _directed(words: list[str]) -> bool:
    return any((verb_form(word) or ("", None))[0] in lexicon.DIRECTED for word in words)


def _turned_from(schema: ActionSchema, things: Things) -> frozenset[str]:
    """What something is turned away from: s of an action that ends (pointed-at ?t ?s) alone."""
    brought = {w for e in schema.effects if e.literal.positive for w in e.literal.arguments}
    ended = (e.literal for e in schema.effects if not e.literal.positive)
    found = {
        each.arguments[-1]
        for each in ended
        if len(each.arguments) > 1 and _directed(things.words(each.predicate))
    }
    return frozenset(found - brought)


def _preposition(predicate: str, things: Things, kind: str) -> str | None:
    words = things.words(predicate)
    found = next((word for word in words if word in PREPOSITIONS and word != "at"), None)
    form = verb_form(words[0])
    joint = lexicon.TAKES.get(form[0]) if form is not None else None
    if all(map(things.holds_things, things.of_kind(kind))):  # stored: in a box, but on a shelf
        joint = None
    return found or (joint if joint not in ("at", "") else None)


def _changed(schema: ActionSchema, names: list[str]) -> Iterator[dict[str, End]]:
    """What a thing no longer has, and has instead: fuel(plane, low), fuel(plane, full)."""
    for gone in schema.effects:
        for come in schema.effects:
            before, after = gone.literal, come.literal
            if (
                not before.positive
                and after.positive
                and before.predicate == after.predicate
                and len(before.arguments) == 2
                and before.arguments[0] == after.arguments[0]
                and {before.arguments[1], after.arguments[1]} <= set(names)
                and before.arguments[1] != after.arguments[1]
            ):
                yield {before.arguments[1]: End(source=True), after.arguments[1]: End(source=False)}


def _reversed(schema: ActionSchema, things: Things) -> tuple[str, ...]:
    verb = things.words(schema.name)[0]
    for effect in schema.effects:
        literal = effect.literal
        words = things.words(literal.predicate)
        if len(words) > 1:
            continue  # hangs-on says where what was hung up is
        form = verb_form(words[0])
        if literal.positive and form == (verb, Form.THIRD) and len(literal.arguments) == 2:
            return (literal.arguments[1], literal.arguments[0])
    return ()
