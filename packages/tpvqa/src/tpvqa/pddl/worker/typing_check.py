"""Arguments that can never fit: literals whose types exclude those that a predicate declares.

The translator ignores the types of predicates, so that swapped arguments pass in silence and end
as a goal that is out of reach. Published domains are loose with types: an argument may be declared
wider than the predicate wants. So an error is only what no object could ever fit.
"""

from collections.abc import Iterator, Mapping
from typing import Any

from fast_downward.translate import pddl

from tpvqa.errors import shown
from tpvqa.pddl.worker.lisp import line_of

Wrong = tuple[str, str, int | None]
"""What is wrong, whether in the domain or the problem, and the line."""


def ill_typed(task: Any) -> Iterator[Wrong]:
    """The literals of a task with an argument that does not fit, in the order written."""
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
    for fact in task.init:
        if isinstance(fact, pddl.Atom):
            yield from types.literal(fact, things, "in the initial state", "problem", None)
    yield from types.condition(task.goal, things, "in the goal", "problem", None)


class _Types:
    def __init__(self, task: Any):
        self._predicates = {each.name: each.arguments for each in task.predicates}
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
        if literal.predicate == "=":
            return
        declared = self._predicates.get(literal.predicate, ())
        for argument, wanted in zip(literal.args, declared, strict=False):
            kind = known.get(argument, "object")
            if not self._may_be_both(_kinds(kind), _kinds(wanted.type_name)):
                said = f"({' '.join((literal.predicate, *literal.args))})"
                hint = "; are its arguments in the right order?" if len(literal.args) > 1 else ""
                yield (
                    f"{shown(said)} {where}: {argument} is of the type {_either(kind)}, but "
                    f"{wanted.name} of {literal.predicate} is {_either(wanted.type_name)}{hint}",
                    part,
                    line_of(list(literal.args)) or line,
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
