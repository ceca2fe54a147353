"""World files: what a disturbance can undo, and what holds instead."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from tpvqa.errors import WorldError
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


def _bindings(
    patterns: Sequence[Pattern], state: State, binding: Binding, task: Task
) -> Iterator[dict[str, str]]:
    if not patterns:
        yield dict(binding)
        return
    for atom in sorted(state):
        bound = patterns[0].match(atom, binding, task)
        if bound is not None:
            yield from _bindings(patterns[1:], state, bound, task)


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
        if self.unless and next(_bindings(self.unless, state, bound, task), None) is not None:
            return None
        matched = next(_bindings(self.when, state, bound, task), None)
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


def load_undo_rules(path: Path | str | None, task: Task) -> tuple[UndoRule, ...]:
    """Read a world file; without one nothing can be undone.

    Raises:
        WorldError: The file is missing or broken; the message names the place.
    """
    if path is None:
        return ()
    try:
        document = yaml.safe_load(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise WorldError(f"{path}: cannot be read ({error.strerror})") from error
    except yaml.YAMLError as error:
        raise WorldError(f"{path}: not valid YAML: {error}") from error
    if not isinstance(document, dict) or not isinstance(document.get("undo", []), list):
        raise WorldError(f"{path}: expected a list under `undo:`")
    rules = []
    for number, entry in enumerate(document.get("undo", []), 1):
        try:
            rules.append(_rule(entry, task))
        except (ValueError, TypeError, KeyError) as error:
            raise WorldError(f"{path}: rule {number} under `undo`: {error}") from error
    return tuple(rules)


def _rule(entry: Any, task: Task) -> UndoRule:
    if not isinstance(entry, dict) or not isinstance(entry.get("fact"), str):
        raise ValueError("expected `fact: (predicate ?x …)` and a list of `outcomes`")
    outcomes = entry.get("outcomes")
    if not isinstance(outcomes, list) or not outcomes:
        raise ValueError(f"{entry['fact']} has no `outcomes`")
    return UndoRule(
        _pattern(entry["fact"], task), tuple(_outcome(outcome, task) for outcome in outcomes)
    )


def _outcome(entry: Any, task: Task) -> Outcome:
    fields = {"say", "last", "when", "unless", "add", "delete"}
    if not isinstance(entry, dict) or not set(entry) <= fields:
        raise ValueError(f"an outcome has only the fields {', '.join(sorted(fields))}")

    def patterns(name: str) -> tuple[Pattern, ...]:
        return tuple(_pattern(text, task) for text in entry.get(name) or ())

    last = entry.get("last")
    return Outcome(
        say=str(entry.get("say", "it is undone")),
        last=None if last is None else _pattern(last, task),
        when=patterns("when"),
        unless=patterns("unless"),
        add=patterns("add"),
        delete=patterns("delete"),
    )


def _pattern(text: Any, task: Task) -> Pattern:
    if not isinstance(text, str):
        raise TypeError(f"{text!r} is not an atom; write it as (predicate ?x …)")
    pattern = Pattern.parse(text)
    if pattern.predicate not in task.predicates:
        raise ValueError(f"{text}: the domain has no predicate {pattern.predicate!r}")
    arity = len(task.predicates[pattern.predicate])
    if len(pattern.terms) != arity:
        raise ValueError(f"{text}: {pattern.predicate} takes {arity} objects")
    return pattern
