"""What the objects of a task are, how they are called, and where in facts they stand."""

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from tpvqa.drafting.lexicon import (
    ADJECTIVES,
    AGENTS,
    BARE,
    COLOURS,
    GENERIC,
    HANDS,
    INSIDE,
    MASS,
    PARTICLES,
    PERSONS,
    PLACES,
    PLACING,
    PLURAL_EXCEPTIONS,
    SEVERAL,
    SIDES,
    UPON,
)
from tpvqa.drafting.names import as_written, is_number, spelled, words_of
from tpvqa.pddl import Task
from tpvqa.questions.template import indefinite_article


@dataclass(frozen=True, slots=True)
class Label:
    """How an object is called.

    Attributes:
        name: In words.
        article: Whether "the" stands before it: the table, but crate 2.
        plural: Whether it is several things: beans.
    """

    name: str
    article: bool = True
    plural: bool = False


class Things:
    """The objects of one task.

    Args:
        task: The task.
    """

    def __init__(self, task: Task):
        self.task = task
        self._text = f"{task.domain_text}\n{task.problem_text}"

    @cached_property
    def vocabulary(self) -> frozenset[str]:
        """Words that types and unary predicates are made of: what a task calls things."""
        unary = (n for n, k in self.task.predicates.items() if len(k) == 1)
        named = [*self.task.types, *(n for n in unary if n not in self.task.fluents)]
        return frozenset(
            part for name in named for part in re.split(r"[_\-\d]+", name) if len(part) > 2
        )

    def words(self, name: str) -> list[str]:
        """The words of a name of a predicate, an action, a type or a parameter."""
        return words_of(spelled(name, self._text), self.vocabulary - {name})

    @cached_property
    def _said_to_be(self) -> dict[str, list[str]]:
        """The nouns that unary predicates which never change give to objects: (ball b1)."""
        found: dict[str, list[str]] = {}
        static = (a for a in self.task.init if len(a.arguments) == 1)
        for atom in sorted(a for a in static if a.predicate not in self.task.fluents):
            words = self.words(atom.predicate)
            words = words[1:] if words[0] == "is" and len(words) > 1 else words
            if len(words) == 1 and words[0] not in GENERIC:
                found.setdefault(atom.arguments[0], []).append(words[0])
        return found

    def kinds(self, obj: str) -> list[str]:
        """What an object is, the nearest noun first; words without meaning are left out."""
        return self._kinds.get(obj, [])

    @cached_property
    def _kinds(self) -> dict[str, list[str]]:
        found = {}
        for obj, kind in self.task.objects.items():
            nouns: list[str] = []
            above: str | None = kind
            while above is not None:
                words = [word for word in self.words(above) if not is_number(word)]
                if words and words[-1] not in GENERIC:
                    nouns.append(" ".join(words))
                following = self.task.types.get(above)
                above = None if following == above else following
            nouns = nouns or self._said_to_be.get(obj, [])
            head = re.match(r"([a-z]{3,})[_-]?\d", obj)
            found[obj] = nouns or ([head[1]] if head else [])
        return found

    def label(self, obj: str) -> Label:
        """How an object is called."""
        return self._labels[obj]

    @cached_property
    def _labels(self) -> dict[str, Label]:
        plain = {obj: self._label(obj) for obj in self.task.objects}
        return {
            obj: replace(label, name=as_written(label.name, spelled(obj, self._text)))
            for obj, label in plain.items()
        }

    def _label(self, obj: str) -> Label:
        kinds = self.kinds(obj)
        kind = kinds[0] if kinds else ""
        noun = kind.split()[-1] if kind else ""
        raw = spelled(obj, self._text)
        words = words_of(raw)
        spoken = [word for word in words if word.isalpha() and len(word) > 1]
        numbered = re.fullmatch(r"([a-z]{1,2})[_-]?(\d+(?:[_-]\d+)*)", obj)
        if kind and re.fullmatch(r"[a-z]", obj):
            return Label(f"{kind} {obj.upper()}", article=False)
        like = [each for each in kinds if numbered and each.startswith(numbered[1][0])]
        if numbered and like:
            return Label(f"{like[0]} {numbered[2].replace('_', '-')}", article=False)
        if numbered and not kind:
            return Label(f"{numbered[1].upper()}{numbered[2]}", article=False)
        if noun and obj.startswith(noun) and re.fullmatch(r"[_-]?[a-z]", obj[len(noun) :]):
            return Label(f"{kind} {obj[-1].upper()}", article=False)
        if any(any(map(str.isdigit, word)) for word in words) or is_number(words[-1]):
            return Label(_enumerated(words, kind, obj), article=False)
        if noun in PERSONS and _is_own_name(words):
            return Label(" ".join(map(str.capitalize, words)), article=False)
        if noun in COLOURS and all(map(str.isalpha, words)):
            return Label(" ".join(words), article=False)
        if kind and noun not in words and set(words) <= SIDES:
            return Label(f"{' '.join(words)} {kind}")
        others = {*self.task.objects} - {obj}
        if len(words) > 1 and words[0] == noun and "_".join(words[1:]) in others:
            return Label(f"{noun} of the {' '.join(words[1:])}")
        return Label(" ".join(words), plural=plural(spoken[-1] if spoken else "", noun))

    def place_of(self, obj: str) -> str:
        """Whether things are in, on or at an object."""
        return self._preposition(obj) or "at"

    def holds_things(self, obj: str) -> bool:
        """Whether an object is known to have something in or on it."""
        return self._preposition(obj) is not None

    def _preposition(self, obj: str) -> str | None:
        own = [word for word in words_of(spelled(obj, self._text)) if word.isalpha()]
        nouns = [*reversed(own), *(word for kind in self.kinds(obj) for word in kind.split()[::-1])]
        for word in nouns:
            single = word.removesuffix("s") if word not in PLURAL_EXCEPTIONS else word
            if single in UPON:
                return "on"
            if single in INSIDE:
                return "in"
        return None

    # Where they stand in facts

    def standing(self, predicate: str, at: int) -> tuple[str, ...]:
        """The objects that can be an argument of a predicate."""
        return self._standing.get((predicate, at)) or self.of_kind(
            self.task.predicates[predicate][at]
        )

    def of_kind(self, kind: str) -> tuple[str, ...]:
        """The objects of a type; `a|b` for either."""
        return tuple(obj for obj in self.task.objects if self.task.is_a(obj, kind))

    @cached_property
    def _standing(self) -> dict[tuple[str, int], tuple[str, ...]]:
        found: dict[tuple[str, int], dict[str, None]] = {}
        for atom in sorted(self.task.reachable_atoms | self.task.init):
            for at, argument in enumerate(atom.arguments):
                found.setdefault((atom.predicate, at), {})[argument] = None
        return {key: tuple(objects) for key, objects in found.items()}

    def nouns(self, objects: Iterable[str]) -> frozenset[str]:
        """The nouns for some objects, wider ones included."""
        own = {word for obj in objects for kind in self.kinds(obj) for word in kind.split()[-1:]}
        return frozenset(own)

    def act(self, objects: Iterable[str]) -> bool:
        """Whether all of some objects act by themselves: robots, people, vehicles."""
        return self._all(objects, AGENTS)

    def hold(self, objects: Iterable[str]) -> bool:
        """Whether all of some objects are hands or grippers."""
        return self._all(objects, HANDS)

    def are_places(self, objects: Iterable[str]) -> bool:
        """Whether all of some objects are places."""
        return self._all(objects, PLACES | INSIDE | UPON)

    def _all(self, objects: Iterable[str], words: frozenset[str]) -> bool:
        each = [{*self.kinds(obj), *self._own_words(obj)} for obj in objects]
        return bool(each) and all(
            any(part in words for name in nouns for part in name.split()[-1:]) for nouns in each
        )

    def _own_words(self, obj: str) -> list[str]:
        own = [w for w in words_of(spelled(obj, self._text)) if w.isalpha() and not is_number(w)]
        return own[-1:]

    def commonest_place(self) -> str:
        """The preposition that most objects take."""
        counted = Counter(self.place_of(obj) for obj in self.task.objects)
        return counted.most_common(1)[0][0] if counted else "at"


def _is_own_name(words: list[str]) -> bool:
    """Whether words are what somebody is called, not what tells somebody from others: king lear,
    not the old man."""
    telling = AGENTS | PERSONS | SIDES | COLOURS | ADJECTIVES
    return all(map(str.isalpha, words)) and telling.isdisjoint(words)


def _enumerated(words: list[str], kind: str, obj: str) -> str:
    """A name that ends in numbers: crate 2, location 0-1."""
    head = [word for word in words if word.isalpha() and len(word) > 1 and not is_number(word)]
    tail = words[len(head) :] if words[: len(head)] == head else []
    if not head:
        return f"{kind} {obj.replace('_', '-')}" if kind else obj
    head = [kind] if kind and GENERIC.issuperset(head) else head
    if kind and set(head) <= SIDES and kind not in head:
        return " ".join([*head, kind, *tail])
    if not tail:
        return " ".join(words)
    if all(len(word) <= 2 for word in tail):
        said = re.sub(r"(?<=[a-z])-(?=\d)", "", "-".join(tail))
        return f"{' '.join(head)} {said}"
    return " ".join([*head, *tail])


def plural(word: str, kind: str = "") -> bool:
    """Whether a noun is several things: beans.

    Args:
        word: The noun.
        kind: What it is one of: a `beans` that is a type is one thing.
    """
    if word in SEVERAL:
        return True
    if len(word) < 4 or word in PLURAL_EXCEPTIONS or word == kind:
        return False
    return word.endswith("s") and not word.endswith(("ss", "us", "is"))


def some(words: Sequence[str]) -> str:
    """A thing that is named without saying which: a cup, any water, any keys, 2 keys."""
    noun = " ".join(words)
    if is_number(words[0]):
        return noun
    many = words[-1] in MASS or plural(words[-1])
    return f"any {noun}" if many else f"{indefinite_article(noun)} {noun}"


def behind(words: Sequence[str]) -> str:
    """A preposition and what stands behind it: in the lift; but in half, in water."""
    preposition, *named = words
    the = ["the"] if named and preposition in PLACING and _stands_for_one(named) else []
    return " ".join([preposition, *the, *named])


def _stands_for_one(words: list[str]) -> bool:
    """Whether an article goes before words: the stand; not half, water, red, bags or 2."""
    bare = BARE | MASS | ADJECTIVES | PARTICLES | {"a", "an", "the"}
    return bare.isdisjoint((words[0], words[-1])) and not (
        plural(words[-1])
        or is_number(words[0])
        or any(not each.isalpha() or len(each) == 1 for each in words)
    )
