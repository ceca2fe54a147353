"""What a disturbance can undo, and what holds instead."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from tpvqa.pddl import Atom, State, Task
from tpvqa.pddl.pattern import Binding, Pattern
from tpvqa.worlds.numbers import NumberChange


class Undoing(Protocol):
    """What disturbances undo; see `UndoRule`."""

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """What undoing an atom can lead to: how it is said, and the state."""


def bindings(
    patterns: Sequence[Pattern], state: State, binding: Binding, task: Task
) -> Iterator[dict[str, str]]:
    if not patterns:
        yield dict(binding)
        return
    for atom in sorted(state):
        bound = patterns[0].match(atom, binding, task)
        if bound is not None:
            yield from bindings(patterns[1:], state, bound, task)


@dataclass(frozen=True, slots=True)
class Reversal:
    """One way in which a fact is undone."""

    say: str
    last: Pattern | None
    when: tuple[Pattern, ...]
    unless: tuple[Pattern, ...]
    add: tuple[Pattern, ...]
    delete: tuple[Pattern, ...]
    numbers: tuple[NumberChange, ...] = ()

    def apply(
        self, undone: Atom, binding: Binding, state: State, history: Sequence[Atom], task: Task
    ) -> State | None:
        """The state after it; None where it does not apply.

        Args:
            undone: The fact that ends.
            binding: The variables of the rule's fact.
            state: The true state.
            history: All facts that ended so far, the latest last.
            task: Gives the objects' types.
        """
        bound = dict(binding)
        if self.last is not None:
            found = (self.last.match(atom, bound, task) for atom in reversed(history))
            latest = next((match for match in found if match is not None), None)
            if latest is None:
                return None
            bound = latest
        if self.unless and next(bindings(self.unless, state, bound, task), None) is not None:
            return None
        matched = next(bindings(self.when, state, bound, task), None)
        if matched is None:
            return None
        gone = {undone, *(pattern.ground(matched) for pattern in self.delete)}
        after = (state - gone) | {pattern.ground(matched) for pattern in self.add}
        for change in self.numbers:
            after = change.apply(after, matched, task)
        return after


@dataclass(frozen=True, slots=True)
class UndoRule:
    """A form of fact that disturbances undo, with its outcomes."""

    fact: Pattern
    outcomes: tuple[Reversal, ...]

    def results(
        self, atom: Atom, state: State, history: Sequence[Atom], task: Task
    ) -> list[tuple[str, State]]:
        """What undoing an atom can lead to: how it is said, and the state."""
        binding = self.fact.match(atom, {}, task)
        if binding is None:
            return []
        states = [
            (outcome.say, outcome.apply(atom, binding, state, history, task))
            for outcome in self.outcomes
        ]
        return [(say, after) for say, after in states if after is not None]
