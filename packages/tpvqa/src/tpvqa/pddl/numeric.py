"""The numbers of a task: its functions, what actions do to them, and what is believed of them."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import chain
from pathlib import Path
from typing import Any, Protocol

from tpvqa.errors import PDDLError, a, suggestion_or_list
from tpvqa.pddl.arithmetic import (
    ARITHMETIC,
    COMPARISONS,
    VALUE,
    Expression,
    Values,
    Words,
    evaluated,
    functions_in,
    grain,
    nearest,
    number,
    of_several,
    sides,
    values_in,
    written,
)
from tpvqa.pddl.atoms import Atom, Literal, State
from tpvqa.pddl.conditions import holds, literals
from tpvqa.pddl.ground import Action

CHANGES = ("increase", "decrease", "assign", "scale-up", "scale-down")
"""How actions change numbers."""
_LOWER, _HIGHER = "<=", ">="


@dataclass(frozen=True)
class Numeric:
    """The numbers of a task.

    Attributes:
        functions: The variables and types of each function's arguments.
        changed: The functions that actions change.
        values: All values at first.
    """

    functions: Mapping[str, tuple[tuple[str, str], ...]]
    changed: frozenset[str]
    values: Values

    @staticmethod
    def of(description: Mapping[str, Any] | None) -> "Numeric | None":
        """What the worker says of them; None for a task without any that change."""
        if description is None:
            return None
        return Numeric(
            {
                name: tuple((variable, kind) for variable, kind in arguments)
                for name, arguments in description["functions"]
            },
            frozenset(description["changed"]),
            {tuple(words): number(value) for words, value in description["values"]},
        )

    @cached_property
    def init(self) -> State:
        """The facts that say the values of functions that change."""
        return frozenset(
            value_of(words, value)
            for words, value in self.values.items()
            if words[0] in self.changed
        )

    @cached_property
    def static(self) -> Values:
        """The values that no action changes."""
        return {w: value for w, value in self.values.items() if w[0] not in self.changed}

    def check(
        self, atom: Atom, objects: Mapping[str, str], is_a: Callable[[str, str], bool]
    ) -> None:
        """See that a value or a comparison speaks of a function and objects of the task.

        Args:
            atom: The value, or the comparison.
            objects: The type of each object.
            is_a: Whether an object is of a type.

        Raises:
            PDDLError: It does not.
        """
        if not atom.arguments or of_several(atom.arguments):
            raise PDDLError(f"{atom.pddl()} is no value of a function; write (= (battery r) 60)")
        name, *arguments = atom.arguments[:-1] or atom.arguments
        if name not in self.functions:
            raise PDDLError(
                f"{atom.pddl()}: there is no function {name!r}"
                + suggestion_or_list(name, self.functions)
            )
        if len(arguments) != len(self.functions[name]):
            raise PDDLError(
                f"{atom.pddl()}: {name} takes {len(self.functions[name])} arguments, got "
                f"{len(arguments)}"
            )
        for argument, (variable, kind) in zip(arguments, self.functions[name], strict=True):
            if argument not in objects:
                raise PDDLError(
                    f"{atom.pddl()}: there is no object {argument!r}"
                    + suggestion_or_list(argument, objects)
                )
            if not is_a(argument, kind):
                raise PDDLError(
                    f"{atom.pddl()}: {argument} is {a(objects[argument])}, but {variable} of "
                    f"{name} must be {' or '.join(map(a, kind.split('|')))}"
                )
        try:
            number(atom.arguments[-1])
        except ValueError as error:
            raise PDDLError(f"{atom.pddl()}: {error}") from None

    def comes_to(self, action: Action, state: State, full: State) -> State | None:
        """A state with the values after an action; None where one cannot be worked out, as 1 / 0.

        Args:
            action: The action.
            state: The state, with the values before it.
            full: What conditions are seen in.
        """
        happening = [each for each in action.changes if holds(each.condition, full)]
        before = values_in(state) if happening else {}
        after: dict[Words, Fraction] = {}
        for change in happening:
            by = evaluated(change.by, before)
            old = after.get(change.function, before.get(change.function))
            new = None if by is None else changed(change.kind, old, by)
            if new is None:
                return None
            after[change.function] = new
        return with_values(state, after)

    def asked_after(self, action: Action, before: State, after: State) -> Iterator[Literal]:
        """Comparisons that tell whether an action has changed the numbers that it should."""
        old, new = values_in(before), values_in(after)
        for words in dict.fromkeys(change.function for change in action.changes):
            value = new.get(words)
            if value is None or old.get(words) == value:
                continue
            raised = words not in old or value > old[words]
            yield Literal(Atom(_HIGHER if raised else _LOWER, (*words, written(value))))

    def believing(self, state: State, literal: Literal, steps: Mapping[str, Fraction]) -> State:
        """A state in which a comparison holds as somebody says, by the nearest value.

        A comparison of several functions leaves open which of them is another; nothing changes.

        Args:
            state: What was believed.
            literal: What is said.
            steps: By how much the values of each function differ at least; see `steps_of`.
        """
        if literal.holds(state):
            return state
        left, right = sides(literal.atom.arguments)
        if isinstance(left, str) or isinstance(right, tuple) or left[0] not in self.changed:
            return state
        comparison = literal.atom.predicate
        step = steps.get(str(left[0]), Fraction(1))
        value = nearest(comparison, number(right), holds=literal.positive, step=step)
        return with_values(state, {tuple(map(str, left)): value})


def value_of(words: Words, value: Fraction) -> Atom:
    """The fact that a function has a value."""
    return Atom(VALUE, (*words, written(value)))


def with_values(state: State, values: Values) -> State:
    """A state with other values of some functions."""
    kept = (a for a in state if a.predicate != VALUE or a.arguments[:-1] not in values)
    return frozenset(kept) | {value_of(words, value) for words, value in values.items()}


def numbers_of(state: State) -> State:
    """The facts of a state that say values."""
    return frozenset(atom for atom in state if atom.predicate == VALUE)


def changed(kind: str, old: Fraction | None, by: Fraction) -> Fraction | None:
    """A value after a change of a kind; None where there is none."""
    if kind == "assign":
        return by
    if old is None:
        return None
    match kind:
        case "increase":
            return old + by
        case "decrease":
            return old - by
        case "scale-up":
            return old * by
    return old / by if by else None


class Grounded(Protocol):
    """A task, as far as it is needed here."""

    @property
    def problem_path(self) -> Path | None:
        """What errors name."""

    def ground_actions(self) -> tuple[Action, ...]:
        """Its actions."""


def check_values(task: Grounded, numbers: Numeric) -> None:
    """See that every number that an action speaks of has a value at first.

    Raises:
        PDDLError: One has none.
    """
    for action in task.ground_actions():
        for words in spoken_of(action):
            if words not in numbers.values:
                said = f"({' '.join(words)})"
                raise PDDLError(
                    f"{said} has no value at first, though {action} speaks of it; add (= {said} …) "
                    "to (:init …)",
                    file=task.problem_path or "(problem)",
                )


def spoken_of(action: Action) -> Iterator[Words]:
    """The functions that an action speaks of."""
    conditions = [effect.condition for effect in action.effects]
    conditions += [change.condition for change in action.changes]
    for condition in (action.precondition, *conditions):
        for literal in literals(condition):
            yield from functions_of(literal)
    for change in action.changes:
        yield change.function
        yield from functions_in(change.by)


def functions_of(literal: Literal) -> Iterable[Words]:
    """The functions that a literal compares; none where it is no comparison."""
    if literal.atom.predicate not in COMPARISONS:
        return ()
    return chain(*map(functions_in, sides(literal.atom.arguments)))


def steps_of(task: Grounded, numbers: Numeric) -> Mapping[str, Fraction]:
    """By how much the values of each function that changes differ at least.

    That is what all numbers are multiples of that it begins with, is compared with, set to or
    changed by.
    """
    said: dict[str, set[Fraction]] = {name: set() for name in numbers.changed}
    for words, value in numbers.values.items():
        said.get(words[0], set()).add(value)
    for action in task.ground_actions():
        for literal in literals(action.precondition):
            for words in functions_of(literal):
                said[words[0]] |= set(_numbers_in(sides(literal.atom.arguments)))
        for change in action.changes:
            said[change.function[0]] |= set(_numbers_in((change.by,)))
    return {name: grain([each for each in found if each]) for name, found in said.items()}


def _numbers_in(expressions: Iterable[Expression]) -> Iterator[Fraction]:
    for each in expressions:
        if isinstance(each, str):
            yield number(each)
        elif each[0] in ARITHMETIC:
            yield from _numbers_in(each[1:])
