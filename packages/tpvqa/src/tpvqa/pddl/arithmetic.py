"""Numbers in a state, and what conditions and actions say of them.

A state is a set of facts, and the value of a function is one of them: `(= (battery robot) 60)` is
`Atom("=", ("battery", "robot", "60"))`. A comparison is an atom, too, of which the values tell
whether it holds: `Atom(">=", ("battery", "robot", "20"))`.
"""

import operator
import re
from collections.abc import Callable, Iterator, Mapping
from fractions import Fraction
from functools import lru_cache
from math import gcd, lcm
from typing import Any

VALUE = "="
"""The predicate of values."""

COMPARISONS: Mapping[str, Callable[[Fraction, Fraction], bool]] = {
    ">=": operator.ge,
    "<=": operator.le,
    ">": operator.gt,
    "<": operator.lt,
    VALUE: operator.eq,
}
"""The predicates of comparisons."""
TURNED: Mapping[str, str] = {">=": "<=", "<=": ">=", ">": "<", "<": ">", VALUE: VALUE}
"""The comparison that says the same with its sides exchanged."""
OPPOSITE: Mapping[str, str] = {">=": "<", "<=": ">", ">": "<=", "<": ">="}
"""The comparison that holds where one does not."""

ARITHMETIC: Mapping[str, Callable[[Fraction, Fraction], Fraction]] = {
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": operator.truediv,
}

_NUMBER = re.compile(r"-?([0-9]{1,4000}(\.[0-9]{0,4000}|/[0-9]{1,4000})?|\.[0-9]{1,4000})")
_DEEPEST = 300
"""How deep expressions are nested at most."""

Words = tuple[str, ...]
"""A function and its arguments: `("battery", "robot")`."""
Expression = str | tuple["str | Expression", ...]
"""A number as it is written; `Words`; or an operator with two expressions."""
Values = Mapping[Words, Fraction]


def number(text: str) -> Fraction:
    """Read a number: 12, -2.5, .5 or 1/3; no exponents, of which few letters make endless numbers.

    Raises:
        ValueError: It is none.
    """
    if _NUMBER.fullmatch(text) is None:
        raise ValueError(f"{text[:40]!r} is no number")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{text[:40]!r} is no number") from None


def is_number(text: str) -> bool:
    """Whether a text is a number; see `number`."""
    try:
        number(text)
    except ValueError:
        return False
    return True


def written(value: Fraction) -> str:
    """A number as it is read again: 12, 2.5 or 1/3."""
    if value.denominator == 1:
        return str(value.numerator)
    places = next((n for n in range(1, 10) if 10**n % value.denominator == 0), None)
    if places is None:
        return f"{value.numerator}/{value.denominator}"
    digits = str(abs(int(value * 10**places))).rjust(places + 1, "0")
    return f"{'-' * (value < 0)}{digits[:-places]}.{digits[-places:]}"


def expression(written: Any) -> Expression:
    """An expression as the worker gives it."""
    return tuple(map(expression, written)) if isinstance(written, list) else str(written)


def evaluated(expression: Expression, values: Values) -> Fraction | None:
    """What an expression comes to; None where a function in it has no value."""
    if isinstance(expression, str):
        return number(expression)
    head = expression[0]
    if head not in ARITHMETIC:
        return values.get(expression)  # type: ignore[arg-type]
    left, right = (evaluated(part, values) for part in expression[1:])
    if left is None or right is None or (head == "/" and right == 0):
        return None
    return ARITHMETIC[str(head)](left, right)


def folded(expression: Expression, values: Values) -> Expression:
    """An expression in which functions that have a value here are numbers."""
    if isinstance(expression, str):
        return expression
    if expression[0] in ARITHMETIC:
        expression = (expression[0], *(folded(part, values) for part in expression[1:]))
    known = evaluated(expression, values)
    return expression if known is None else written(known)


def bound(expression: Expression, binding: Mapping[str, str]) -> Expression:
    """An expression with objects for its variables."""
    if isinstance(expression, str):
        return binding.get(expression, expression)
    return tuple(bound(part, binding) for part in expression)


def functions_in(expression: Expression) -> Iterator[Words]:
    """The functions that an expression speaks of."""
    if isinstance(expression, str):
        return
    if expression[0] in ARITHMETIC:
        for part in expression[1:]:
            yield from functions_in(part)
    else:
        yield expression  # type: ignore[misc]


def linear(expression: Expression) -> tuple[dict[Words, Fraction], Fraction] | None:
    """An expression as factors of functions and what is added; None where it is not linear."""
    if isinstance(expression, str):
        return {}, number(expression)
    head = expression[0]
    if head not in ARITHMETIC:
        return {expression: Fraction(1)}, Fraction(0)  # type: ignore[dict-item]
    parts = [linear(part) for part in expression[1:]]
    if parts[0] is None or parts[1] is None:
        return None
    (factors, more), (others, added) = parts[0], parts[1]
    if head in ("+", "-"):
        sign = 1 if head == "+" else -1
        total = dict(factors)
        for words, factor in others.items():
            total[words] = total.get(words, Fraction(0)) + sign * factor
        return {words: each for words, each in total.items() if each}, more + sign * added
    if head == "*" and not factors:
        factors, more, others, added = others, added, factors, more
    if others or (head == "/" and not added):
        return None
    by = added if head == "*" else 1 / added
    return {words: each * by for words, each in factors.items() if each * by}, more * by


def text_of(expression: Expression) -> str:
    """An expression as PDDL writes it."""
    if isinstance(expression, str):
        return expression
    return f"({' '.join(map(text_of, expression))})"


def parsed(text: str) -> Expression:
    """Read what `text_of` gives.

    Raises:
        ValueError: It is no expression.
    """
    words = text.replace("(", " ( ").replace(")", " ) ").split()
    found, rest = _parsed(words, 0)
    if rest != len(words):
        raise ValueError(f"{text!r} is no expression")
    return found


def _parsed(words: list[str], at: int, depth: int = 0) -> tuple[Expression, int]:
    if depth > _DEEPEST:
        raise ValueError(f"an expression is nested more than {_DEEPEST} deep")
    if at >= len(words) or words[at] == ")":
        raise ValueError("an expression is missing")
    if words[at] != "(":
        return words[at], at + 1
    parts: list[Expression] = []
    at += 1
    while at < len(words) and words[at] != ")":
        part, at = _parsed(words, at, depth + 1)
        parts.append(part)
    if at == len(words) or not parts:
        raise ValueError("a parenthesis is not closed")
    return tuple(parts), at + 1


State = frozenset[tuple[str, Words]]


@lru_cache(maxsize=256)
def values_in(state: State) -> Values:
    """The values that a state says."""
    return {words[:-1]: number(words[-1]) for predicate, words in state if predicate == VALUE}


def sides(words: Words) -> tuple[Expression, Expression]:
    """The two sides of a comparison, by the arguments of its atom."""
    if of_several(words):
        return parsed(words[0]), parsed(words[1])
    return words[:-1], words[-1]


def of_several(words: Words) -> bool:
    """Whether a comparison is not of one function with a number, by the arguments of its atom."""
    return any(word.startswith("(") for word in words)


def compares(predicate: str, words: Words, state: State) -> bool:
    """Whether a comparison holds in a state; it does not where a value is missing."""
    left, right = (evaluated(side, values_in(state)) for side in sides(words))
    return left is not None and right is not None and COMPARISONS[predicate](left, right)


def compared(comparison: str, left: Expression, right: Expression) -> bool | tuple[str, Words]:
    """A comparison in its simplest form: whether it always holds, or predicate and arguments.

    What is said of one function alone has it on the left and a number on the right.
    """
    found = linear(("-", left, right))
    if found is None:
        return comparison, (text_of(left), text_of(right))
    factors, added = found
    if not factors:
        return COMPARISONS[comparison](added, Fraction(0))
    if len(factors) > 1:
        return comparison, (text_of(("-", left, right)), "0")
    ((words, factor),) = factors.items()
    return comparison if factor > 0 else TURNED[comparison], (*words, written(-added / factor))


def grain(numbers: list[Fraction]) -> Fraction:
    """The largest number of which all these are multiples; 1 for none."""
    below = lcm(*(each.denominator for each in numbers))
    above = gcd(*(int(each * below) for each in numbers))
    return Fraction(above, below) if above else Fraction(1)


def nearest(comparison: str, bound: Fraction, *, holds: bool, step: Fraction) -> Fraction:
    """The value nearest to a bound for which a comparison with it holds, or does not.

    Args:
        comparison: The comparison.
        bound: What a value is compared with.
        holds: Whether it is to hold.
        step: By how much values differ at least.
    """
    if COMPARISONS[comparison](bound, bound) == holds:
        return bound
    if comparison == VALUE:
        return bound - step
    upwards = comparison.startswith(">") == holds
    return bound + step if upwards else bound - step
