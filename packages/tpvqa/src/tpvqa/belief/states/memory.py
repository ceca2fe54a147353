"""What a joint state remembers of facts that ended: no more than faults can lead back to.

Joint states that differ in nothing else have equal futures, so to forget the rest is exact, and
there are far fewer of them.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, runtime_checkable

from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.pddl import Atom, State, Task

Past = tuple[Any, ...]
"""What is remembered; equal where nothing that can still happen tells it apart."""


class Undoing(Protocol):
    """A form of fact that disturbances undo."""

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """What undoing a true atom can lead to: how it is said, and the state."""


@runtime_checkable
class PatternedUndoing(Undoing, Protocol):
    """One that says by patterns what it can lead back to, as a world file's rules do."""

    @property
    def fact(self) -> Any:
        """The pattern of the fact that ends."""

    @property
    def outcomes(self) -> Sequence[Any]:
        """What holds instead; `last` is the pattern of a fact that held earlier, or None."""


class Memory(Protocol):
    """Keeps what is remembered, and says what faults lead back to."""

    def after(self, past: Past, gone: State, come: State, begun: State) -> Past:
        """What is remembered after a change.

        Args:
            past: What was remembered before.
            gone: The facts that ended.
            come: The facts that began.
            begun: The state in which the trial began, of which nothing can be undone.
        """

    def undone(self, atom: Atom, state: State, past: Past) -> list[tuple[float, State]]:
        """What undoing a true atom can lead to, each with its share."""


def memory_of(task: Task, undo: Sequence[Undoing]) -> Memory:
    """What takes the least to remember.

    Args:
        task: The task.
        undo: The rules of disturbances; empty where nobody knows them.
    """
    return ByRules(task, undo) if undo else ByGroups(BackToBefore(task))


class ByGroups:
    """Remembers the fact that held last in a group, while one holds there that can be undone.

    The past is one fact or None for each group, or empty where there is nothing to remember.
    """

    def __init__(self, back: BackToBefore):
        self._back = back
        self._nothing: tuple[Atom | None, ...] = (None,) * back.groups

    def after(self, past: Past, gone: State, come: State, begun: State) -> Past:
        """What is remembered after a change."""
        latest: list[Atom | None] = list(past or self._nothing)
        homes = self._back.homes
        for atom in sorted(gone) if len(gone) > 1 else gone:
            for group in homes(atom):
                latest[group] = atom
        for atom in come & begun:
            for group in homes(atom):
                latest[group] = None
        return tuple(latest) if any(latest) else ()

    def undone(self, atom: Atom, state: State, past: Past) -> list[tuple[float, State]]:
        """What was before, and seldom that a thing is lost; none where nothing held before."""
        return self._back.with_shares(atom, state, (past or self._nothing).__getitem__)


class ByRules:
    """Remembers the latest facts that fit the patterns of rules; all, where one has no pattern."""

    def __init__(self, task: Task, undo: Sequence[Undoing]):
        self._task, self._undo = task, undo
        self._patterns: list[tuple[Any, frozenset[str]]] | None = []
        for rule in undo:
            if not isinstance(rule, PatternedUndoing):
                self._patterns = None
                break
            self._patterns += [
                (outcome.last, rule.fact.variables)
                for outcome in rule.outcomes
                if outcome.last is not None
            ]
        self._known: dict[Atom, list[Any]] = {}

    def after(self, past: Past, gone: State, come: State, begun: State) -> Past:
        """What is remembered after a change: facts that ended, the latest last."""
        kept: dict[Any, Atom] = {}
        for atom in (*past, *sorted(gone)):
            for key in self._keys(atom):
                kept.pop(key, None)
                kept[key] = atom
        latest: dict[Atom, None] = {}
        for atom in kept.values():
            latest.pop(atom, None)
            latest[atom] = None
        return tuple(latest)

    def undone(self, atom: Atom, state: State, past: Past) -> list[tuple[float, State]]:
        """What undoing a true atom can lead to, all as probable."""
        found = [
            after for rule in self._undo for _, after in rule.results(atom, state, past, self._task)
        ]
        return [(1 / len(found), after) for after in found]

    def _keys(self, atom: Atom) -> list[Any]:
        if self._patterns is None:
            return [atom]
        keys = self._known.get(atom)
        if keys is None:
            keys = self._known[atom] = []
            for place, (pattern, bound) in enumerate(self._patterns):
                match: Mapping[str, str] | None = pattern.match(atom, {}, self._task)
                if match is not None:
                    keys.append((place, *sorted((k, v) for k, v in match.items() if k in bound)))
        return keys
