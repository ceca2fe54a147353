"""What a problem leaves open of its initial state: `unknown`, `oneof` and `or` within `(:init …)`.

Contingent planning writes it so (Hoffmann and Brafman 2005, Contingent-FF). Fast Downward's
translator reads none of it: it is given plain facts, of which those left open are told apart here.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from fast_downward.translate import invariant_finder, pddl

from tpvqa.pddl.worker.grounding import AtomKey
from tpvqa.pddl.worker.invariants import balances, group_key
from tpvqa.pddl.worker.lisp import Block, line_of

FORMS = {
    "unknown": "(unknown (fact …))",
    "oneof": "(oneof (fact …) (fact …) …)",
    "or": "(or (fact …) (not (fact …)) …)",
}
"""How each is written."""
_MOST = 20_000
"""Choices that are looked into for a consistent initial state."""


class UnsureError(Exception):
    """It cannot be read, or no initial state is as it says."""

    def __init__(self, message: str, line: int | None):
        super().__init__(message)
        self.message, self.line = message, line


@dataclass
class Unsure:
    """What is left open.

    Attributes:
        unknown: Facts that may hold or not.
        oneof: Facts of which exactly one holds.
        clauses: Literals of which at least one holds: whether it is positive, and the fact.
        line: Where the first of it stands.
    """

    unknown: list[AtomKey] = field(default_factory=list)
    oneof: list[list[AtomKey]] = field(default_factory=list)
    clauses: list[list[tuple[bool, AtomKey]]] = field(default_factory=list)
    line: int | None = None

    @property
    def atoms(self) -> frozenset[AtomKey]:
        """All facts that may hold or not."""
        return frozenset(self.unknown).union(
            *self.oneof, (key for clause in self.clauses for _, key in clause)
        )

    def described(self) -> dict[str, Any]:
        """It as plain lists."""
        return {
            "unknown": sorted(self.unknown),
            "oneof": [sorted(group) for group in self.oneof],
            "clauses": self.clauses,
        }


def taken_out(problem: Block) -> Unsure:
    """Take out of a problem's initial state what it leaves open.

    In its place each fact that may hold is stated, so that the translator looks at its predicate
    and its objects.

    Raises:
        UnsureError: It is not written as `FORMS` says, or says of a fact that it is open and that
            it holds.
    """
    found = Unsure()
    inits = [part for part in problem if isinstance(part, Block) and part[:1] == [":init"]]
    if not inits:
        return found
    init = inits[0]
    certain: list[object] = []
    opened: list[Block] = []
    for entry in init[1:]:
        head = entry[0] if isinstance(entry, Block) and entry else None
        if not isinstance(entry, Block) or head not in FORMS:
            certain.append(entry)
            continue
        found.line = found.line or entry.line
        parts = [_literal(part, entry, negative=head == "or") for part in entry[1:]]
        if len(parts) < 2 - (head == "unknown") or (head == "unknown" and len(parts) > 1):
            raise UnsureError(
                f"{_said(entry)} has {len(parts)} facts; expected {FORMS[str(head)]}", entry.line
            )
        keys = [_key(block) for _, block in parts]
        if len(set(keys)) < len(keys):
            raise UnsureError(f"{_said(entry)} names a fact twice; expected each once", entry.line)
        if head == "unknown":
            found.unknown += keys
        elif head == "oneof":
            found.oneof.append(keys)
        else:
            found.clauses.append(
                [(positive, key) for (positive, _), key in zip(parts, keys, strict=True)]
            )
        opened += [block for _, block in parts]
    stated = {_key(entry) for entry in certain if isinstance(entry, Block)}
    added: dict[AtomKey, Block] = {}
    for block in opened:
        if _key(block) in stated:
            raise UnsureError(
                f"{_said(block)} is left open here, and stated as well; remove one of the two",
                block.line,
            )
        added.setdefault(_key(block), block)
    init[1:] = [*certain, *added.values()]
    return found


def _literal(part: object, entry: Block, *, negative: bool) -> tuple[bool, Block]:
    """Whether a part of an entry is positive, and the fact."""
    positive = True
    if negative and isinstance(part, Block) and part[:1] == ["not"] and len(part) == 2:
        positive, part = False, part[1]
    fact = isinstance(part, Block) and part and all(isinstance(word, str) for word in part)
    if not fact or part[0] in (*FORMS, "not", "and", "="):  # type: ignore[index]
        form = FORMS[str(entry[0])]
        raise UnsureError(
            f"{_said(part)} is no fact that {entry[0]!s} can leave open; expected {form}",
            line_of(part) or entry.line,
        )
    assert isinstance(part, Block)
    return positive, part


def _key(block: Block) -> AtomKey:
    return tuple(map(str, block))


def _said(part: object) -> str:
    if isinstance(part, list):
        return f"({' '.join(map(_said, part))})"[:200]
    return str(part)


def give_room(task: Any, unsure: Unsure) -> set[str]:
    """Keep the translator from taking for constant what is left open and no action changes.

    An action that can never be done deletes it.

    Args:
        task: The translator's normalised task; changed.
        unsure: What is left open.

    Returns:
        The predicates that no action of the domain changes.
    """
    changing = {each.literal.predicate for action in task.actions for each in action.effects}
    hidden = {key[0] for key in unsure.atoms} - changing - {axiom.name for axiom in task.axioms}
    for predicate in task.predicates:
        if predicate.name not in hidden:
            continue
        names = [f"?unsure{place}" for place in range(len(predicate.arguments))]
        fact = pddl.Atom(predicate.name, names)
        task.actions.append(
            pddl.Action(
                f"unsure@{predicate.name}",
                [pddl.TypedObject(name, "object") for name in names],
                len(names),
                pddl.Atom("unsure@never", []),
                [pddl.Effect([], pddl.Truth(), fact.negate())],
                None,
            )
        )
    return hidden


class _Count(NamedTuple):
    """Of some facts, how many hold."""

    keys: Sequence[AtomKey]
    least: int
    most: int


def chosen(task: Any, certain: Iterable[AtomKey], unsure: Unsure) -> list[AtomKey]:
    """The facts left open that hold in one possible initial state.

    Where it can be, it is one that keeps the domain's invariants (a thing is in one place), so
    that they are found from it; of several one with few facts, the first named first.

    Args:
        task: The translator's normalised task.
        certain: What is stated.
        unsure: What is left open.

    Raises:
        UnsureError: There is none.
    """
    counts = [_Count(group, 1, 1) for group in unsure.oneof]
    laws = list(_laws(task, frozenset(certain), unsure.atoms))
    fewer = [law._replace(least=0) for law in laws]
    for further in (laws, fewer, []):
        found = _Choice([*counts, *further], unsure.clauses).solved()
        if found is not None:
            return sorted(found)
    raise UnsureError(
        "no initial state is as (oneof …) and (or …) say; leave out what contradicts the rest",
        unsure.line,
    )


def _laws(task: Any, certain: frozenset[AtomKey], atoms: frozenset[AtomKey]) -> Iterator[_Count]:
    if not atoms:
        return
    actions = [action for action in task.actions if not action.name.startswith("unsure@")]
    added = {
        each.literal.predicate
        for action in actions
        for each in action.effects
        if not each.literal.negated
    }
    for invariant in invariant_finder.find_invariants(task, None):
        if not added & set(invariant.predicates):
            continue
        held: dict[tuple[str, ...], int] = {}
        groups: dict[tuple[str, ...], list[AtomKey]] = {}
        for key in sorted(certain | atoms):
            if key[0] in invariant.predicates:
                group = group_key(pddl.Atom(key[0], key[1:]), invariant)
                groups.setdefault(group, [])
                if key in certain:
                    held[group] = held.get(group, 0) + 1
                else:
                    groups[group].append(key)
        whole = all(balances(action, invariant) for action in actions)
        for group, keys in groups.items():
            if keys and held.get(group, 0) <= 1:
                free = 1 - held.get(group, 0)
                yield _Count(keys, free if whole else 0, free)


class _Choice:
    """Seeks facts to hold: those that something asks for, and no others."""

    def __init__(self, counts: Sequence[_Count], clauses: Sequence[Any]):
        self._counts, self._clauses, self._left = counts, clauses, _MOST

    def solved(
        self, true: frozenset[AtomKey] = frozenset(), false: frozenset[AtomKey] = frozenset()
    ) -> frozenset[AtomKey] | None:
        """The facts; None where there are none, or none was found in time."""
        self._left -= 1
        if self._left < 0:
            return None
        wanted: list[AtomKey] | None = None
        for keys, least, most in self._counts:
            holding = len(true.intersection(keys))
            if holding > most:
                return None
            if holding < least and (wanted is None or len(keys) < len(wanted)):
                wanted = [key for key in keys if key not in false and key not in true]
        for clause in self._clauses if wanted is None else ():
            if not any(positive == (key in true) for positive, key in clause):
                wanted = [key for positive, key in clause if positive and key not in false]
                break
        if wanted is None:
            return true
        for place, key in enumerate(wanted):
            found = self.solved(true | {key}, false.union(wanted[:place]))
            if found is not None:
                return found
        return None
