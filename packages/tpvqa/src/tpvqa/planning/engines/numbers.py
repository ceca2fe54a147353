"""The numbers of a numbered task in the words of unified-planning: n0, n1, …"""

import math
from collections.abc import Callable
from fractions import Fraction
from typing import Any

from unified_planning import shortcuts as up

_OPERATORS = {"+": up.Plus, "-": up.Minus, "*": up.Times, "/": up.Div}
_COMPARISONS = {">=": up.GE, "<=": up.LE, ">": up.GT, "<": up.LT, "=": up.Equals}


class Numbers:
    """Fluents for the functions of a task.

    Where all is added and subtracted, values are multiplied so that they are whole: some engines
    know no others.

    Args:
        task: What `Propositional.numbered` gives.
        problem: The problem; is given the fluents and their values.
    """

    def __init__(self, task: dict[str, Any], problem: Any):
        values = list(map(Fraction, task["values"]))
        self._changes = task["changes"]
        plain = not any(_is_multiplied(part) for part in (task["goal"], task["actions"]))
        plain = plain and not any(_is_multiplied(part) for part in self._changes)
        said = [*values, *_constants(task["goal"]), *_constants(task["actions"])]
        said += _constants(self._changes)
        self._scale = math.lcm(*(each.denominator for each in said)) if plain else 1
        whole = all((each * self._scale).denominator == 1 for each in said) and plain
        kind = up.IntType() if whole else up.RealType()
        self._fluents = [up.Fluent(f"n{n}", kind) for n in range(len(values))]
        for fluent, value in zip(self._fluents, values, strict=True):
            problem.add_fluent(fluent)
            problem.set_initial_value(fluent, self._constant(value))

    def compared(self, comparison: list[Any]) -> Any:
        """A comparison, as a condition."""
        _, operator, left, right = comparison
        return _COMPARISONS[operator](self._said(left), self._said(right))

    def change(self, number: int, action: Any, said: Callable[[list[Any]], Any]) -> None:
        """Add what an action does to numbers.

        Args:
            number: The action's number.
            action: The action; changed.
            said: Makes a condition.
        """
        for condition, kind, function, by in self._changes[number]:
            when = said(condition)
            fluent, value = self._fluents[function], self._said(by)
            match kind:
                case "increase":
                    action.add_increase_effect(fluent, value, when)
                case "decrease":
                    action.add_decrease_effect(fluent, value, when)
                case "assign":
                    action.add_effect(fluent, value, when)
                case "scale-up":
                    action.add_effect(fluent, up.Times(fluent, value), when)
                case "scale-down":
                    action.add_effect(fluent, up.Div(fluent, value), when)

    def _constant(self, value: Fraction) -> Any:
        scaled = value * self._scale
        return up.Int(int(scaled)) if scaled.denominator == 1 else up.Real(scaled)

    def _said(self, expression: Any) -> Any:
        if isinstance(expression, str):
            return self._constant(Fraction(expression))
        head, *parts = expression
        if head == "value":
            return up.FluentExp(self._fluents[parts[0]])
        return _OPERATORS[head](*map(self._said, parts))


def _is_multiplied(item: Any) -> bool:
    """Whether something within is a product, a quotient or a change by a factor."""
    if not isinstance(item, list):
        return False
    heads = ("*", "/", "scale-up", "scale-down")
    return any(isinstance(part, str) and part in heads for part in item) or any(
        map(_is_multiplied, item)
    )


def _constants(item: Any) -> list[Fraction]:
    """The numbers that are written within."""
    if isinstance(item, list):
        return [found for part in item for found in _constants(part)]
    if isinstance(item, str) and item.lstrip("-")[:1].isdigit():
        return [Fraction(item)]
    return []
