"""What a disturbance can undo, and what holds instead."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from tpvqa.pddl import Atom, State, Task

Binding = Mapping[str, str]


@dataclass(frozen=True, slots=True)
class Pattern:
    """An atom with variables; a variable may name the type its object must have."""

    predicate: str
    terms: tuple[str, ...]
    types: tuple[str | None, ...]

    @staticmethod
    def parse(text: str) -> "Pattern":
        """Read `(on ?x ?d - dish)`.

        Raises:
            ValueError: The text is not an atom.
        """
        words = text.strip().lower().replace("(", " ").replace(")", " ").split()
        if not words:
            raise ValueError(f"{text!r} is not an atom; write it as (predicate ?x …)")
        terms: list[str] = []
        types: list[str | None] = []
        rest = iter(words[1:])
        for word in rest:
            if word == "-":
                kind = next(rest, None)
                if kind is None or not terms:
                    raise ValueError(f"{text!r}: a type must follow a variable and a dash")
                types[-1] = kind
            else:
                terms.append(word)
                types.append(None)
        return Pattern(words[0], tuple(terms), tuple(types))

    def match(self, atom: Atom, binding: Binding, task: Task) -> dict[str, str] | None:
        """The binding under which it is this atom; None where there is none."""
        if atom.predicate != self.predicate or len(atom.arguments) != len(self.terms):
            return None
        bound = dict(binding)
        for term, kind, value in zip(self.terms, self.types, atom.arguments, strict=True):
            if kind is not None and value not in task.objects_by_type.get(kind, ()):
                return None
            if not term.startswith("?"):
                if term != value:
                    return None
            elif bound.setdefault(term, value) != value:
                return None
        return bound

    def ground(self, binding: Binding) -> Atom:
        """The atom under a binding of all its variables."""
        return Atom(self.predicate, tuple(binding.get(term, term) for term in self.terms))


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
class Outcome:
    """One way in which a fact is undone."""

    say: str
    last: Pattern | None
    when: tuple[Pattern, ...]
    unless: tuple[Pattern, ...]
    add: tuple[Pattern, ...]
    delete: tuple[Pattern, ...]

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
        return (state - gone) | {pattern.ground(matched) for pattern in self.add}


@dataclass(frozen=True, slots=True)
class UndoRule:
    """A form of fact that disturbances undo, with its outcomes."""

    fact: Pattern
    outcomes: tuple[Outcome, ...]

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
