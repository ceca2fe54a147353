"""Arguments that can never fit: their types exclude those that a predicate or function declares.

The translator ignores the types of both, so that swapped arguments pass in silence and end
as a goal that is out of reach. Published domains are loose with types: an argument may be declared
wider than the predicate wants. So an error is only what no object could ever fit.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from fast_downward.translate import pddl

from tpvqa.errors import shown
from tpvqa.pddl.arithmetic import functions_in
from tpvqa.pddl.worker.lisp import line_of

Called = Sequence[str]
"""A predicate or function with its arguments."""
Wrong = tuple[str, str, int | None]
"""What is wrong, whether in the domain or the problem, and the line."""


def ill_typed(task: Any) -> Iterator[Wrong]:
    """The facts and functions of a task with an argument that does not fit, in order."""
    types = _Types(task)
    things = {thing.name: thing.type_name for thing in task.objects}
    for axiom in task.axioms:
        known = things | {each.name: each.type_name for each in axiom.parameters}
        where = f"in the rule for {shown(axiom.name)}"
        yield from types.condition(axiom.condition, known, where, "domain", line_of(axiom.name))
    for action in task.actions:
        known = things | {each.name: each.type_name for each in action.parameters}
        place = ("domain", line_of(action.name))
        where = f"in the precondition of the action {shown(action.name)}"
        yield from types.condition(action.precondition, known, where, *place)
        where = f"in an effect of the action {shown(action.name)}"
        for effect in action.effects:
            inner = known | {each.name: each.type_name for each in effect.parameters}
            yield from types.condition(effect.condition, inner, where, *place)
            yield from types.literal(effect.literal, inner, where, *place)
        where = f"in the cost of the action {shown(action.name)}"
        for called in _cost(action.cost and action.cost.expression):
            yield from types.function(called, known, where, *place)
    yield from _durations(task, types, things)
    for fact in task.init:
        if isinstance(fact, pddl.Atom):
            yield from types.literal(fact, things, "in the initial state", "problem", None)
    for called in _valued(task):
        yield from types.function(called, things, "in the initial state", "problem", None)
    yield from types.condition(task.goal, things, "in the goal", "problem", None)


def _durations(task: Any, types: "_Types", things: dict[str, Any]) -> Iterator[Wrong]:
    """Functions in durations, which stand beside the parts of an action."""
    actions = {action.name: action for action in task.actions}
    for each in () if task.durative is None else task.durative["actions"]:
        action = actions[f"start-{each['name']}"]
        known = things | {part.name: part.type_name for part in action.parameters}
        where = f"in the duration of the action {shown(each['name'])}"
        for called in (words for part in each["duration"] for words in functions_in(part)):
            yield from types.function(called, known, where, "domain", line_of(action.name))


def _cost(expression: Any) -> Iterator[Called]:
    if isinstance(expression, pddl.PrimitiveNumericExpression):
        yield [expression.symbol, *expression.args]


def _valued(task: Any) -> Iterator[Called]:
    """The functions to which the initial state gives values."""
    if task.durative is not None:
        yield from (words for words, _ in task.durative["values"])
    if task.numeric is not None:
        yield from (words for words, _ in task.numeric.values)
    for fact in task.init:
        if isinstance(fact, pddl.Assign):
            yield from _cost(fact.fluent)


class _Types:
    def __init__(self, task: Any):
        self._predicates = {each.name: each.arguments for each in task.predicates}
        self._functions = {each.name: each.arguments for each in task.functions}
        self._numbers = task.numeric
        above: dict[str, set[str]] = {}
        for kind in task.types:
            above.setdefault(kind.name, {kind.name}).update(kind.supertype_names)
        self._below: dict[str, set[str]] = {}
        for name, wider in above.items():
            for each in wider:
                self._below.setdefault(each, set()).add(name)

    def condition(
        self, written: Any, known: Mapping[str, Any], where: str, part: str, line: int | None
    ) -> Iterator[Wrong]:
        if isinstance(written, pddl.Literal):
            yield from self.literal(written, known, where, part, line)
            return
        inner = {**known, **{each.name: each.type_name for each in _parameters(written)}}
        for each in written.parts:
            yield from self.condition(each, inner, where, part, line)

    def literal(
        self, literal: Any, known: Mapping[str, Any], where: str, part: str, line: int | None
    ) -> Iterator[Wrong]:
        name, place = literal.predicate, (known, where, part, line)
        if name == "=":
            return
        for called in () if self._numbers is None else self._numbers.spoken_of(name):
            yield from self.function(called, *place)
        yield from self._fitting([name, *literal.args], self._predicates.get(name, ()), *place)

    def function(
        self, called: Called, known: Mapping[str, Any], where: str, part: str, line: int | None
    ) -> Iterator[Wrong]:
        declared = self._functions.get(called[0], ())
        yield from self._fitting(called, declared, known, where, part, line)

    def _fitting(
        self,
        called: Called,
        declared: Any,
        known: Mapping[str, Any],
        where: str,
        part: str,
        line: int | None,
    ) -> Iterator[Wrong]:
        name, *arguments = called
        for argument, wanted in zip(arguments, declared, strict=False):
            kind = known.get(argument, "object")
            if not self._may_be_both(_kinds(kind), _kinds(wanted.type_name)):
                hint = "; are its arguments in the right order?" if len(arguments) > 1 else ""
                said = f"({' '.join(called)})"
                yield (
                    f"{shown(said)} {where}: {argument} is of the type "
                    f"{_either(kind)}, but {wanted.name} of {name} is "
                    f"{_either(wanted.type_name)}{hint}",
                    part,
                    line_of(arguments) or line,
                )
                return

    def _may_be_both(self, kinds: list[str], others: list[str]) -> bool:
        """Whether some type lies at or below one of the first and one of the others."""
        if "object" in kinds or "object" in others:
            return True
        below = set().union(*(self._below.get(each, {each}) for each in kinds))
        return any(below & self._below.get(each, {each}) for each in others)


def _parameters(condition: Any) -> Any:
    return getattr(condition, "parameters", ())


def _kinds(type_name: Any) -> list[str]:
    return list(type_name[1:]) if isinstance(type_name, list) else [type_name]


def _either(type_name: Any) -> str:
    return " or ".join(_kinds(type_name))
