"""Actions put into words: what their names say, and what their effects say of their parameters."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

from tpvqa.drafting import lexicon
from tpvqa.drafting.clauses import Noun, Phrases
from tpvqa.drafting.forms import is_verb, past
from tpvqa.drafting.lexicon import BARE, PARTICLES, PREPOSITIONS, word_set
from tpvqa.drafting.roles import End, Roles, roles_of
from tpvqa.pddl.schema import ActionSchema

_MOVING = word_set(
    "go move drive walk fly sail travel navigate climb turn roll ride run swim "
    "step head ascend descend jump transport carry deliver bring push cross "
    "pass refuel rotate slide tow haul drag pull convey shuttle guide lead escort"
)
_INTO = word_set("load insert pour put drop throw stow pack")
_JOINS = {
    **dict.fromkeys(("insert", "plug", "stuff", "slot", "screw"), "into"),
    **dict.fromkeys(("unplug", "extract", "remove", "eject", "withdraw", "unclip"), "from"),
    **dict.fromkeys(("detach", "disconnect", "unhook", "unhitch", "unscrew", "untie"), "from"),
    **dict.fromkeys(("clip", "attach", "hitch", "fasten", "tie", "bolt", "hook", "clamp"), "to"),
}
"""What joins a verb to the second thing that it is about."""
_TAKING = word_set("pick take fetch collect get grab")
_PLACING = _INTO | _TAKING | {"unstack"}
_PLACING |= {verb for verb, joint in lexicon.TAKES.items() if joint in ("in", "into", "on", "at")}
"""Verbs that say themselves how a thing is where it goes: put on, load into."""
_DIRECT = word_set("board enter leave exit cross reach visit")
"""Verbs whose direct object is where somebody goes, or comes from."""
_WAYS = word_set("up down left right forward forwards backward backwards north south east west")
_UNSAID = word_set("first second third half not")
"""Words of names that are left out, and may be what matters."""
_PASSING = word_set("through over under across around behind past along beyond")
"""What stands before a thing, not before how something is done: by hand, on foot, with care."""
_IN = word_set("in on at into onto")
_LETTING = word_set("go idle rest run cool dry soak settle stand wait drip drain fall loose")
"""What a thing is let do, or be."""
_SEEKING = word_set("find search seek look detect")


@dataclass(frozen=True, slots=True)
class Spoken:
    """An action in words.

    Attributes:
        say: As a command.
        done: Once it is done.
        unsure: Whether it reads as if somebody should say it otherwise.
    """

    say: str
    done: str
    unsure: bool = False


class Actions:
    """Puts the actions of a task into words.

    Args:
        phrases: Says the task's things.
    """

    def __init__(self, phrases: Phrases):
        self._phrases = phrases
        self._things = phrases.things

    def said(self, schema: ActionSchema) -> Spoken:
        """An action as a command, and once it is done: "stack the {x} on the {y}", "stacked …"."""
        nouns = {
            p.name: self._phrases.noun(p.name.lstrip("?"), self._things.of_kind(p.type))
            for p in schema.parameters
        }
        words = [
            word for word in self._things.words(schema.name) if not word.isdigit() or not nouns
        ]
        verb, rest = _verb_first(words)
        roles = roles_of(schema, self._things)
        mentioned = {name: noun for name, noun in nouns.items() if name in roles.changing}
        mentioned = self._without_the_only_one(mentioned or dict(list(nouns.items())[:2]), rest)
        mentioned = {n: noun for n, noun in mentioned.items() if n not in roles.counted}
        doer = self._doer(verb, rest, mentioned, roles)
        told = {name: noun for name, noun in mentioned.items() if noun is not doer}
        pieces = list(self._pieces(verb, rest, told, roles, schema))
        tail = " ".join(piece for piece in pieces if piece)
        if verb == "pick" and not tail.startswith("up") and " of " not in tail:
            tail = f"up {tail}"
        if verb == "plug" and tail.startswith("in ") and " into " in tail:
            tail = tail.removeprefix("in ")
        unsure = (
            tail.count("with ") > 1
            or not is_verb(verb)
            or bool(_UNSAID & set(rest) - set(tail.split()))
            or bool(self._lost(rest, tail, nouns))
            or any(self._guessed(verb, tail, n, noun, roles) for n, noun in told.items())
            or _either_way(verb, rest, tail)
            or not self._has_parts(tail)
            or (verb == "let" and not told and bool(_LETTING & set(rest)))
        )
        if doer is None:
            return Spoken(f"{verb} {tail}".strip(), f"{past(verb)} {tail}".strip(), unsure)
        said = f"have {doer.said} {verb} {tail}".strip()
        return Spoken(said, said.replace("have ", "had ", 1), unsure)

    def _lost(self, rest: list[str], tail: str, nouns: Mapping[str, Noun]) -> list[str]:
        """The words of the name that are not said, though nothing else says them."""
        said = {*tail.split()} | PREPOSITIONS | PARTICLES | {"robot"}
        return [word for word in rest if word not in said and not self._names(word, nouns)]

    def _has_parts(self, tail: str) -> bool:
        """Whether what is said to be of a thing is known to be: the lid of {x}, or the page, of
        which the domain says something; not the actor, of dress-actor(x)."""
        return all(
            each.split()[-1] in self._task_words | lexicon.PARTS
            for each in re.findall(r"the ([\w ]+) of (?:the )?{", tail)
        )

    @cached_property
    def _task_words(self) -> frozenset[str]:
        """The words of all predicates."""
        names = self._things.task.predicates
        return frozenset(word for name in names for word in self._things.words(name))

    def _guessed(self, verb: str, tail: str, name: str, noun: Noun, roles: Roles) -> bool:
        """Whether nothing tells that something is done with a thing: seal a bag with a knife."""
        known = noun.parameter == "with" or name in roles.reversed or self._acts(noun)
        return f"with {noun.said}" in tail and not known and self._joint(verb, noun) is None

    def _acts(self, noun: Noun) -> bool:
        return self._things.act(noun.objects) or self._things.hold(noun.objects)

    def _joint(self, verb: str, noun: Noun) -> str | None:
        """What joins a verb to a further thing, as far as verb or thing tells."""
        if (self._things.nouns(noun.objects) | {noun.parameter}) & (lexicon.TOOLS | lexicon.HANDS):
            return "with"
        taken = lexicon.TAKES.get(verb)
        return _JOINS.get(verb, taken if taken not in ("by", "as", "") else None)

    def _without_the_only_one(self, nouns: dict[str, Noun], rest: list[str]) -> dict[str, Noun]:
        """Without the one robot that there is: it goes without saying."""
        left = {
            name: noun
            for name, noun in nouns.items()
            if not (len(noun.objects) == 1 and self._things.act(noun.objects))
            or self._said_in(rest, noun)
        }
        return left or nouns

    def _doer(
        self, verb: str, rest: list[str], nouns: Mapping[str, Noun], roles: Roles
    ) -> Noun | None:
        """Who of several does it, where that is no vehicle, tool or hand."""
        for name, noun in nouns.items():
            people = bool(self._things.nouns(noun.objects) & lexicon.PEOPLE)
            alone = verb in lexicon.INTRANSITIVE and self._things.act(noun.objects)
            alone = alone and verb not in ("move", "sail", "fly", "turn", "drive")
            alone = alone and not self._said_in(rest, noun)  # board-lift
            passive = roles.moved == name and verb not in lexicon.INTRANSITIVE | {"go", "drive"}
            if name not in roles.ends and (alone or (people and not passive)):
                several = len(noun.objects) > 1 or alone
                return noun if several and (len(nouns) > 1 or alone) else None
        return None

    def _pieces(
        self, verb: str, rest: list[str], nouns: dict[str, Noun], roles: Roles, schema: ActionSchema
    ) -> Iterator[str]:
        """What follows the verb."""
        extra = [word for word in rest if not self._names(word, nouns)]
        if len(extra) > 1 and extra[0] in PREPOSITIONS and extra[1] not in PARTICLES:
            trailing, extra = " ".join(extra), []
            trailing = "" if trailing.startswith("to ") else self._with_article(trailing, schema)
        else:
            trailing = ""
        ends = {name: roles.ends[name] for name in nouns if name in roles.ends}
        ends = {n: end for n, end in ends.items() if not self._things.hold(nouns[n].objects)}
        sources = sorted(
            (n for n, e in ends.items() if e.source), key=lambda n: not ends[n].preposition
        )
        ends = {n: end for n, end in ends.items() if n not in sources[1:]}
        dropped = set(sources[1:])
        if verb in _SEEKING:
            ends = {n: end for n, end in ends.items() if end.source}
        if len(ends) == len(nouns) == 1 and verb not in _MOVING:
            ends = {}
        others = [name for name in nouns if name not in ends and name not in dropped]
        tools = [n for n in others if self._things.act(nouns[n].objects) and n != roles.moved]
        patients = [name for name in others if name not in tools]
        if not patients and verb not in _DIRECT | {"go", "walk", "alight", "climb"}:
            patients, tools = tools[:1], tools[1:]
        if roles.reversed and set(roles.reversed) <= set(nouns):
            patients = list(roles.reversed)
            tools, ends = [n for n in tools if n not in patients], {}
        preposition = next((w for w in extra if w in PREPOSITIONS and len(nouns) > 1), None)
        before = pairwise(rest)  # of a thing that the name says: drop-in-tote
        joins = any(w == preposition in _IN and self._names(named, nouns) for w, named in before)
        particles = frozenset() if joins else _particles(verb)
        joined = [word for word in extra if word != preposition or word in particles]
        if preposition in particles:
            preposition = None
        direct = [
            n
            for n, end in ends.items()
            if verb in _DIRECT
            and (end.source == (verb in ("leave", "exit")) and self._things.act(nouns[n].objects))
        ]
        entered = [n for n in nouns if self._said_in(rest, nouns[n])]
        left = verb in ("leave", "exit")
        entered = [n for n in entered if n not in ends or ends[n].source == left]
        if verb in _DIRECT - {"cross"} and entered:  # board-lift
            direct, tools = entered[:1], [n for n in tools if n not in entered]
            patients = [n for n in patients if n not in entered]
        elif verb in _DIRECT and tools and not direct and not patients:
            direct, tools, ends = tools[:1], tools[1:], {}
        first = [nouns[name].said for name in (direct or patients)[:1]]
        yield from self._object(verb, joined, first, nouns, patients, schema)
        for name in patients[1:] if not direct else patients:
            if name in roles.reversed:
                yield f"with {nouns[name].said}"
            else:
                yield self._second(verb, nouns[name], preposition)
        if verb not in _SEEKING:
            yield from self._ways(
                verb, {n: e for n, e in ends.items() if n not in direct}, nouns, preposition
            )
        yield trailing
        for name in tools:
            yield f"with {nouns[name].said}"

    def _with_article(self, words: str, schema: ActionSchema) -> str:
        """A preposition and a thing: through hatch, through the hatch; but on fire, at rest."""
        preposition, _, thing = words.partition(" ")
        if not thing or thing.split()[0] in ("the", "a", "an"):
            return words
        known = thing not in BARE and self._a_thing(thing, schema)
        passing = preposition in _PASSING
        return f"{preposition} the {thing}" if passing or (preposition in _IN and known) else words

    def _a_thing(self, thing: str, schema: ActionSchema) -> bool:
        """Whether the task has such a thing, or the action's effects say how it is: gloves-on."""
        task, last = self._things.task, thing.split()[-1]
        called = (kind for obj in task.objects for kind in self._things.kinds(obj))
        labels = (self._things.label(obj).name for obj in task.objects)
        kinds = (" ".join(self._things.words(kind)) for kind in task.types)
        if any(last == name.split()[-1] for name in (*called, *labels, *kinds)):
            return True
        effects = (self._things.words(each.literal.predicate) for each in schema.effects)
        return any(
            len(words) > 1
            and (words[0] == thing or (words[-1] == thing and words[-2] in PREPOSITIONS))
            for words in effects
        )

    def _names(self, word: str, nouns: Mapping[str, Noun]) -> bool:
        """Whether a word of the name says again what a parameter is: load_truck, move-robot."""
        return word in ("object", "obj") or any(
            word in (noun.parameter, *self._things.nouns(noun.objects)) for noun in nouns.values()
        )

    def _said_in(self, words: list[str], noun: Noun) -> bool:
        """Whether the name says what a parameter is."""
        return any(self._names(word, {noun.parameter: noun}) for word in words)

    def _object(
        self,
        verb: str,
        joined: list[str],
        first: list[str],
        nouns: Mapping[str, Noun],
        patients: list[str],
        schema: ActionSchema,
    ) -> Iterator[str]:
        """The particle and the direct object."""
        particles = [word for word in joined if word in PARTICLES | _WAYS]
        named = [word for word in joined if word not in particles and word not in PREPOSITIONS]
        where = self._stated(named, nouns[patients[0]], schema) if named and patients else ""
        if where.split(" ")[0] in particles[-1:]:
            particles = particles[:-1]  # put-lid-on(x): on the x says it
        yield " ".join(particles)
        if verb == "let" and named and _LETTING.issuperset(named):
            yield from (f"{named[0]} of", *first) if named == ["go"] and first else (*first, *named)
        elif not named or all(
            word in lexicon.ADJECTIVES | {"first", "second", "half"} for word in named
        ):
            yield from first
        elif not first:
            yield f"the {' '.join(named)}"
        elif self._context(patients, nouns, schema):
            yield f"the {' '.join(named)}"
            yield self._phrases.placed(nouns[patients[0]])
        else:
            yield f"the {' '.join(named)} {where or f'of {first[0]}'}"

    def _stated(self, named: list[str], noun: Noun, schema: ActionSchema) -> str:
        """Where effects say that what is named is: scale-beside(x), not windlass-left-at(gate)."""
        for effect in schema.effects:
            words, literal = self._things.words(effect.literal.predicate), effect.literal
            of_it = [each.lstrip("?") for each in literal.arguments] == [noun.parameter]
            if of_it and words[: len(named)] == named and words[-1] in PREPOSITIONS:
                away = f"from {noun.said}"
                return self._phrases.placed(noun, words[-1]) if literal.positive else away
        return ""

    def _context(
        self, patients: list[str], nouns: Mapping[str, Noun], schema: ActionSchema
    ) -> bool:
        """Whether the only thing spoken of is where the robot is, and nothing changes there."""
        changed = {word for e in schema.effects for word in e.literal.arguments}
        return (
            len(patients) == 1
            and patients[0] not in changed
            and self._things.are_places(nouns[patients[0]].objects)
        )

    def _second(self, verb: str, noun: Noun, preposition: str | None) -> str:
        """A further thing that the action is done with or to."""
        if preposition is not None:
            return self._phrases.placed(noun, preposition)
        if noun.parameter in ("with", "by", "on", "in", "at", "into"):
            return f"{noun.parameter} {noun.said}"
        if verb in ("empty", "clear", "free", "rid"):
            return f"of {noun.said}"
        if self._things.are_places(noun.objects) and not self._things.hold(noun.objects):
            return self._phrases.placed(noun)
        return f"{self._joint(verb, noun) or 'with'} {noun.said}"

    def _ways(
        self,
        verb: str,
        ends: Mapping[str, End],
        nouns: Mapping[str, Noun],
        preposition: str | None,
    ) -> Iterator[str]:
        """Where from, and where to."""
        for name in [n for n, e in ends.items() if e.source]:
            left = self._things.nouns(nouns[name].objects) & lexicon.PLACES
            if not (verb in _INTO and left) and verb not in ("board", "enter"):
                yield f"from {nouns[name].said}"
        for name, end in ends.items():
            if end.source:
                continue
            sources = [each for each in ends.values() if each.source]
            both = nouns[name].parameter == "to" and sources
            goes = verb not in _PLACING and any(each.fact == end.fact != () for each in sources)
            if verb in _MOVING or both or goes:
                yield f"to {nouns[name].said}"
                continue
            place = self._phrases.placed(nouns[name], preposition or end.preposition)
            into = verb in _INTO | _TAKING and place.startswith("in ")
            yield f"into {place.removeprefix('in ')}" if into else place


def _verb_first(words: list[str]) -> tuple[str, list[str]]:
    """The verb of an action's name, and what else it says."""
    if words[0] in ("up", "down", "left", "right", "forward", "back", "north", "south", "east"):
        return "go", words
    verb = next((word for word in words if is_verb(word)), words[0])
    return verb, [word for word in words if word != verb]


def _particles(verb: str) -> frozenset[str]:
    """The particles that stay with a verb although they are prepositions, too."""
    if verb in ("put", "place", "stack", "load", "set", "lay", "hang"):
        return PARTICLES - {"on", "in"}
    return PARTICLES


def _either_way(verb: str, rest: list[str], tail: str) -> bool:
    """Whether a name may mean that a thing is put on something, or that something is put on it:
    clip-on-halyard."""
    named = len(rest) > 1 and rest[0] in _particles(verb) and rest[1] not in BARE
    return named and tail.endswith(rest[-1])
