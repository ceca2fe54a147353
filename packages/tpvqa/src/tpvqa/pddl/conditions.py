"""Ground conditions as their author wrote them, quantifiers spelled out over the objects."""

from collections.abc import Iterator
from dataclasses import dataclass

from tpvqa.pddl.atoms import Literal, State


@dataclass(frozen=True, slots=True)
class Conjunction:
    """All parts hold. Empty: true."""

    parts: tuple["Condition", ...] = ()


@dataclass(frozen=True, slots=True)
class Disjunction:
    """At least one part holds. Empty: false."""

    parts: tuple["Condition", ...] = ()


Condition = Literal | Conjunction | Disjunction


def holds(condition: Condition, state: State) -> bool:
    """Whether a condition holds in a state (with its derived atoms, see `Task.extend`)."""
    match condition:
        case Literal():
            return condition.holds(state)
        case Conjunction(parts):
            return all(holds(part, state) for part in parts)
        case Disjunction(parts):
            return any(holds(part, state) for part in parts)


def literals(condition: Condition) -> Iterator[Literal]:
    """All literals of a condition, in the order written."""
    if isinstance(condition, Literal):
        yield condition
    else:
        for part in condition.parts:
            yield from literals(part)


def required_of(condition: Condition) -> Iterator[Literal]:
    """The literals that a condition cannot do without."""
    if isinstance(condition, Literal):
        yield condition
    elif isinstance(condition, Conjunction):
        for part in condition.parts:
            yield from required_of(part)


def said(condition: Condition) -> str:
    """A condition in a line: "a(), b()" for both, "(a(), b()) or c()" for one of them."""
    if isinstance(condition, Literal):
        return str(condition)
    parts = [
        f"({said(part)})" if not isinstance(part, Literal) and len(part.parts) > 1 else said(part)
        for part in condition.parts
    ]
    return (" or " if isinstance(condition, Disjunction) else ", ").join(parts)


def supporting(condition: Condition, state: State) -> Iterator[Literal]:
    """The literals that a condition rests on in a state, in the order written.

    Of a conjunction all; of a disjunction those of the parts that hold in the state, and of all
    parts where none does.
    """
    match condition:
        case Literal():
            yield condition
        case Conjunction(parts):
            for part in parts:
                yield from supporting(part, state)
        case Disjunction(parts):
            held = [part for part in parts if holds(part, state)]
            for part in held or parts:
                yield from supporting(part, state)
