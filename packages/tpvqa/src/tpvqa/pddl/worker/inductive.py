"""Mutex groups of tasks with conditional effects, proved by induction over ground actions.

The translator's invariants take a conditional effect to add and not to delete. Here groups are
guessed (atoms of one predicate that share all arguments but one, and two predicates' together),
and those are kept that hold at first and that no action breaks while all of them hold: the
greatest fixpoint, as in Rintanen, "An Iterative Algorithm for Synthesizing Invariants" (AAAI 2000).
"""

from collections.abc import Iterable, Iterator, Sequence, Set
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from tpvqa.pddl.worker.grounding import AtomKey, key_of

WORK = 1_000_000
"""Facts that are drawn from others before nothing is said; a second or two."""

Fact = tuple[AtomKey, bool]
"""An atom, and whether it holds."""
Known = dict[AtomKey, bool]


@dataclass(frozen=True, slots=True)
class First:
    """What may hold at first.

    Attributes:
        certain: Atoms that hold.
        open: Atoms that may hold or not.
        oneof: Sets of these of which exactly one holds.
    """

    certain: Set[AtomKey]
    open: Set[AtomKey] = frozenset()
    oneof: Sequence[Set[AtomKey]] = ()

    def weight(self, group: Set[AtomKey]) -> tuple[int, int]:
        """How many of a group hold at least, and at most."""
        sure, rest = len(group & self.certain), group & self.open
        if not rest:
            return sure, sure
        within = [each for each in self.oneof if rest <= each]
        least = any(each <= group for each in self.oneof)
        return sure + least, sure + (1 if within else len(rest))


class _TooMuchError(Exception):
    """It would take too long."""


def inductive_groups(
    actions: Iterable[Any], atoms: Iterable[AtomKey], first: First, *, work: int = WORK
) -> list[tuple[frozenset[AtomKey], bool]]:
    """The groups, each with whether exactly one of its atoms always holds.

    Args:
        actions: The translator's ground actions.
        atoms: The fluent atoms that can be reached, none of them derived.
        first: What may hold initially. The groups hold in every state that actions lead to from
            any state that it allows.
        work: Facts drawn from others beyond which none is found.

    """
    actions = list(actions)
    steps = [_Step.of(each) for each in actions]
    added = {key for step in steps for _, key, adds in step.effects if adds}
    kept: dict[frozenset[AtomKey], bool] = {}
    for group in _guessed(set(atoms)):
        least, most = first.weight(group)
        if most <= 1 and group & added:
            kept[group] = least == 1
    try:
        return list(_Induction(steps, kept, work).proved().items())
    except _TooMuchError:
        return []


def _guessed(atoms: Set[AtomKey]) -> Iterator[frozenset[AtomKey]]:
    """Sets of atoms of which at most one may hold."""
    parts: dict[tuple[str, int | None], dict[tuple[str, ...], set[AtomKey]]] = {}
    for key in atoms:
        name, *arguments = key
        for counted in (None, *range(len(arguments))):
            rest = tuple(each for place, each in enumerate(arguments) if place != counted)
            parts.setdefault((name, counted), {}).setdefault(rest, set()).add(key)
    ordered = sorted(parts, key=lambda part: (part[0], -1 if part[1] is None else part[1]))
    found: dict[frozenset[AtomKey], None] = {}
    for part in ordered:
        found.update(dict.fromkeys(map(frozenset, parts[part].values())))
    for one, other in combinations(ordered, 2):
        if one[0] != other[0]:
            for rest in parts[one].keys() & parts[other].keys():
                found[frozenset(parts[one][rest] | parts[other][rest])] = None
    return iter(sorted((group for group in found if len(group) > 1), key=sorted))


@dataclass(frozen=True, slots=True)
class _Step:
    """A ground action.

    Attributes:
        needs: Its precondition.
        effects: When each is had, its atom, and whether it is added.
    """

    needs: tuple[Fact, ...]
    effects: tuple[tuple[tuple[Fact, ...], AtomKey, bool], ...]

    @staticmethod
    def of(action: Any) -> "_Step":
        return _Step(
            _facts(action.precondition),
            tuple(
                (_facts(when), key_of(fact), adds)
                for effects, adds in ((action.add_effects, True), (action.del_effects, False))
                for when, fact in effects
            ),
        )


def _facts(literals: Iterable[Any]) -> tuple[Fact, ...]:
    return tuple((key_of(each), not each.negated) for each in literals)


class _Induction:
    """Drops groups that an action may break, until none is left that any may.

    Args:
        steps: The actions.
        groups: The groups that hold at first, with whether exactly one of them does.
        work: How many facts may be drawn from others.
    """

    def __init__(self, steps: Sequence[_Step], groups: dict[frozenset[AtomKey], bool], work: int):
        self._groups, self._left = dict(groups), work
        self._given: dict[int, Known | None] = {}
        self._groups_of: dict[AtomKey, list[frozenset[AtomKey]]] = {}
        for group in groups:
            for key in group:
                self._groups_of.setdefault(key, []).append(group)
        self._steps_on: dict[frozenset[AtomKey], list[_Step]] = {group: [] for group in groups}
        for step in steps:
            changed = {key for _, key, _ in step.effects}
            for group in {each for key in changed for each in self._groups_of.get(key, ())}:
                self._steps_on[group].append(step)

    def proved(self) -> dict[frozenset[AtomKey], bool]:
        """What is left.

        Raises:
            _TooMuchError: It takes too much work.
        """
        changed = True
        while changed:
            changed = False
            for group, steps in self._steps_on.items():
                if group not in self._groups:
                    continue
                if not all(self._keeps_one(step, group) for step in steps):
                    del self._groups[group]
                elif self._groups[group] and any(self._may_empty(step, group) for step in steps):
                    self._groups[group] = False
                else:
                    continue
                changed = True
                self._given.clear()  # what followed by this group need not follow any more
        return self._groups

    def _keeps_one(self, step: _Step, group: frozenset[AtomKey]) -> bool:
        """Whether at most one of a group holds afterwards."""
        adds = [(when, key) for when, key, added in step.effects if added and key in group]
        if not adds:
            return True
        changed = {key for _, key, _ in step.effects}
        for member, known in self._cases(step, group):
            possible = [
                (when, key, after)
                for when, key in adds
                if (after := self._closed(known, when)) is not None
            ]
            for _, key, after in possible:
                if member is None:
                    if any(after.get(other, True) for other in group if other not in changed):
                        return False
                elif member != key and not _sure(step, member, False, after):
                    return False
            for (_, key, after), (when, other, _) in combinations(possible, 2):
                if key != other and self._closed(after, when) is not None:
                    return False
        return True

    def _may_empty(self, step: _Step, group: frozenset[AtomKey]) -> bool:
        """Whether none of a group may hold afterwards, where exactly one did."""
        for member, known in self._cases(step, group):
            for when, key, added in step.effects:
                if key == member and not added:
                    after = self._closed(known, when)
                    if after is not None and not any(
                        _sure(step, each, True, after) for each in group
                    ):
                        return True
        return False

    def _cases(
        self, step: _Step, group: frozenset[AtomKey]
    ) -> Iterator[tuple[AtomKey | None, Known]]:
        """Each way in which an action can find a group: its member that holds, of those that the
        action changes, and what is known then. That any other holds is one case, as is none."""
        if id(step) not in self._given:
            self._given[id(step)] = self._closed({}, step.needs)
        given = self._given[id(step)]
        if given is None:
            return
        touched = {key for _, key, _ in step.effects if key in group}
        for member in sorted(touched):
            known = self._closed(given, [(key, key == member) for key in group])
            if known is not None:
                yield member, known
        if len(touched) < len(group) or not self._groups[group]:
            known = self._closed(given, [(key, False) for key in touched])
            if known is not None:
                yield None, known

    def _closed(self, known: Known, further: Iterable[Fact]) -> Known | None:
        """What is known with further facts, and what follows by the groups; None where they
        contradict each other."""
        found, fresh = dict(known), list(further)
        while fresh:
            self._left -= 1
            if self._left < 0:
                raise _TooMuchError
            key, holds = fresh.pop()
            if key in found:
                if found[key] != holds:
                    return None
                continue
            found[key] = holds
            for group in self._groups_of.get(key, ()):
                if group not in self._groups:
                    continue
                if holds:
                    fresh += [(other, False) for other in group if other != key]
                elif self._groups[group]:
                    free = [other for other in group if found.get(other, True)]
                    if not free:
                        return None
                    if len(free) == 1:
                        fresh.append((free[0], True))
        return found


def _sure(step: _Step, key: AtomKey | None, adds: bool, known: Known) -> bool:
    """Whether an action is sure to add an atom, or to delete it."""
    return any(
        other == key and added == adds and all(known.get(each) == holds for each, holds in when)
        for when, other, added in step.effects
    )
