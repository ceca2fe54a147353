"""Between which values numbers can come to lie, where nothing is ever undone.

The interval relaxation of numeric planning (Hoffmann 2003; Scala et al. 2016): whatever an action
can do to a number is added to what the number can be.
"""

import math
from collections.abc import Iterable
from fractions import Fraction

from tpvqa.pddl import Atom
from tpvqa.pddl.arithmetic import ARITHMETIC, Expression, Values, Words, functions_in, sides
from tpvqa.pddl.arithmetic import number as read
from tpvqa.pddl.ground import Change

_End = Fraction | float
"""A number, or an infinity."""
Range = tuple[_End, _End]
ANYTHING: Range = (-math.inf, math.inf)


class Ranges:
    """What the numbers of a task can be.

    Args:
        values: What they are at first.
    """

    def __init__(self, values: Values):
        self._ranges: dict[Words, Range] = {words: (v, v) for words, v in values.items()}

    def allows(self, comparison: Atom) -> bool:
        """Whether a comparison can come to hold."""
        left, right = (self._of(side) for side in sides(comparison.arguments))
        match comparison.predicate:
            case ">=":
                return left[1] >= right[0]
            case ">":
                return left[1] > right[0]
            case "<=":
                return left[0] <= right[1]
            case "<":
                return left[0] < right[1]
        return left[0] <= right[1] and right[0] <= left[1]

    def widen(self, changes: Iterable[Change]) -> bool:
        """Add what some changes can make of the numbers, done any number of times.

        Returns:
            Whether a number can be more than before.
        """
        wider = False
        for change in changes:
            old = self._ranges.get(change.function, ANYTHING)
            new = self._after(change, old)
            new = min(old[0], new[0]), max(old[1], new[1])
            if new != old:
                self._ranges[change.function], wider = new, True
        return wider

    def _after(self, change: Change, old: Range) -> Range:
        by = self._of(change.by)
        if change.kind == "assign":
            settled = not any(True for _ in functions_in(change.by))
            return by if settled or by == old else ANYTHING
        if change.kind in ("increase", "decrease"):
            lower, upper = by if change.kind == "increase" else (-by[1], -by[0])
            return -math.inf if lower < 0 else old[0], math.inf if upper > 0 else old[1]
        return old if by == (1, 1) else ANYTHING

    def _of(self, expression: Expression) -> Range:
        if isinstance(expression, str):
            return read(expression), read(expression)
        if expression[0] not in ARITHMETIC:
            return self._ranges.get(expression, ANYTHING)  # type: ignore[arg-type]
        (a, b), (c, d) = (self._of(part) for part in expression[1:])
        match expression[0]:
            case "+":
                return _sum(a, c), _sum(b, d)
            case "-":
                return _sum(a, -d), _sum(b, -c)
            case "*":
                ends = [_product(x, y) for x in (a, b) for y in (c, d)]
                return min(ends), max(ends)
        if c <= 0 <= d:
            return ANYTHING
        inverse = [Fraction(0) if isinstance(y, float) else 1 / y for y in (c, d)]
        ends = [_product(x, y) for x in (a, b) for y in inverse]
        return min(ends), max(ends)


def _sum(one: _End, other: _End) -> _End:
    """A sum of ends; no fraction becomes a float, for which it may be too great."""
    if isinstance(one, float):
        return one
    return other if isinstance(other, float) else one + other


def _product(one: _End, other: _End) -> _End:
    """A product of ends of ranges; nothing times infinity is nothing here."""
    if not one or not other:
        return Fraction(0)
    if isinstance(one, float) or isinstance(other, float):
        return math.inf if (one > 0) == (other > 0) else -math.inf
    return one * other
