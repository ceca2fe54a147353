"""The costs of actions: numbers, or functions that the problem gives values."""

from collections.abc import Collection
from typing import Any

from fast_downward.translate import pddl

from tpvqa.errors import shown
from tpvqa.pddl.worker.lisp import line_of
from tpvqa.pddl.worker.reading_error import ReadingError

_HIGHEST_COST = 1_000_000_000
"""Of one action; plans add them up in 32 bits."""


def check_costs(task: Any, functions: Collection[str]) -> None:
    """See that costs can be counted: the translator does not compare how functions are declared and
    used with how they are given values.

    Args:
        task: The translator's task.
        functions: The names of those that the domain declares.

    Raises:
        ReadingError: A cost is too high, or is no number and no function that has a value.
    """
    things = {thing.name for thing in task.objects}
    given = [("domain", action.cost, action.name) for action in task.actions if action.cost]
    given += [("problem", fact, "") for fact in task.init if isinstance(fact, pddl.Assign)]
    for part, said, name in given:
        if getattr(said.expression, "value", 0) > _HIGHEST_COST:
            where = f"the cost of the action {shown(name)}" if name else "a value in (:init …)"
            raise ReadingError(
                f"{where} is {shown(said.expression.value)}; Fast Downward counts to "
                f"{_HIGHEST_COST:,}, so take a larger unit",
                part,
                line_of(name) or line_of(getattr(said.fluent, "symbol", None)),
            )
    valued = {fact.fluent.symbol for fact in task.init if isinstance(fact, pddl.Assign)}
    for action in task.actions:
        called = action.cost.expression if action.cost else None
        if not isinstance(called, pddl.PrimitiveNumericExpression):
            continue
        why = ""
        if called.symbol == "total-cost":
            why = "the total cost itself; expected a number or another function"
        elif called.symbol not in functions:
            why = (
                f"{shown(called.symbol)}, which is no whole number and no function that "
                "(:functions …) declares"
            )
        if why:
            raise ReadingError(
                f"the cost of the action {shown(action.name)} is {why}",
                "domain",
                line_of(called.symbol) or line_of(action.name),
            )
        if called.symbol not in valued:
            raise ReadingError(
                f"the function {shown(called.symbol)} has no value, and is the cost of the action "
                f"{shown(action.name)}; give it one in (:init …), e.g. (= ({called.symbol}) 1)",
                "problem",
                None,
            )
        known = things | {parameter.name for parameter in action.parameters}
        for word in called.args:
            if word not in known:
                raise ReadingError(
                    f"the cost of the action {str(action.name)!r} speaks of {str(word)!r}; "
                    "expected one of its parameters or an object",
                    "domain",
                    line_of(word),
                )
        for fact in task.init:
            if not isinstance(fact, pddl.Assign) or fact.fluent.symbol != called.symbol:
                continue
            if len(fact.fluent.args) != len(called.args):
                raise ReadingError(
                    f"the function {str(called.symbol)!r} has {len(fact.fluent.args)} arguments "
                    f"here, but {len(called.args)} in the cost of the action {str(action.name)!r}",
                    "problem",
                    line_of(fact.fluent.symbol),
                )
