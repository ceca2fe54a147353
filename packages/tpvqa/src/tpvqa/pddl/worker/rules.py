"""A normalised task as rules with variables: what adds, deletes or derives which literals."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from math import prod
from typing import Any

from fast_downward.translate import pddl
from fast_downward.translate.instantiate import get_objects_by_type

Words = tuple[str, ...]

_FEW = 4
"""So many objects of a type are few: hands, robots, sinks."""


@dataclass(frozen=True, slots=True)
class Literal:
    """A literal over variables and objects."""

    positive: bool
    predicate: str
    arguments: Words

    def bound(self, binding: Mapping[str, str]) -> "Literal":
        """The literal with objects for those of its variables that have one."""
        arguments = tuple(binding.get(word, word) for word in self.arguments)
        return Literal(self.positive, self.predicate, arguments)

    def negate(self) -> "Literal":
        """The literal that holds where this one does not."""
        return Literal(not self.positive, self.predicate, self.arguments)


@dataclass(frozen=True, slots=True)
class Rule:
    """One effect of an action, or one axiom: its head holds after, or where, its body held.

    Attributes:
        head: What it brings about.
        body: What must hold for it; of an action its precondition and the effect's condition.
        variables: The objects that each variable may stand for, in the order of the task.
        changes: All literals that the action brings about at once; empty for an axiom.
        derives: Whether it is an axiom, which costs no action.
        price: What the action costs where costs count: a number, or the function that says it.
    """

    head: Literal
    body: tuple[Literal, ...]
    variables: Mapping[str, Mapping[str, None]]
    changes: tuple[Literal, ...] = ()
    derives: bool = False
    price: float | Words = 0


@dataclass(frozen=True)
class Rules:
    """All rules of a task.

    Attributes:
        by_head: By whether the head is positive, and its predicate.
        goal: The literals of the goal.
        static: The predicates that nothing changes or derives.
        derived: The predicates that axioms derive.
        prices: The values of the functions that prices refer to.
        named: Objects that actions, axioms and goal name.
        alike: For each object of a type of which there are few, all of that type.
        size: Instances of actions times those of their effects, as far as types and static facts
            tell: how large a grounding may get.
    """

    by_head: Mapping[tuple[bool, str], tuple[Rule, ...]]
    goal: tuple[Literal, ...]
    static: frozenset[str]
    derived: frozenset[str]
    prices: Mapping[Words, float]
    named: frozenset[str]
    alike: Mapping[str, frozenset[str]]
    size: int


def rules_of(task: Any) -> Rules:
    """The rules of a normalised task; sizes are those of its initial state."""
    objects = {
        kind: dict.fromkeys(things)
        for kind, things in get_objects_by_type(task.objects, task.types).items()
    }
    changing = {effect.literal.predicate for action in task.actions for effect in action.effects}
    derived = {axiom.name for axiom in task.axioms}
    facts: dict[str, set[Words]] = {}
    for fact in task.init:
        if isinstance(fact, pddl.Atom):
            facts.setdefault(fact.predicate, set()).add(tuple(fact.args))
    rules: list[Rule] = []
    size = 0
    for action in task.actions:
        given = _literals(action.precondition)
        domains = _domains(action.parameters, objects)
        static = [each for each in given if each.predicate not in changing | derived | {"="}]
        instances = _instances(domains, [each for each in static if each.positive], facts)
        changes = tuple(_literal(e.literal) for e in action.effects if not e.parameters)
        effects = 0
        for effect in action.effects:
            own = _domains(effect.parameters, objects)
            effects += prod(map(len, own.values()))
            body = (*given, *_literals(effect.condition))
            head = _literal(effect.literal)
            price = _price(action) if task.use_min_cost_metric else 0
            rules.append(Rule(head, body, {**domains, **own}, changes, price=price))
        size += instances * max(effects, 1)
    for axiom in task.axioms:
        head = Literal(
            True,
            axiom.name,
            tuple(each.name for each in axiom.parameters[: axiom.num_external_parameters]),
        )
        domains = _domains(axiom.parameters, objects)
        rules.append(Rule(head, _literals(axiom.condition), domains, derives=True))
    goal = _literals(task.goal)
    said = [*goal, *(literal for rule in rules for literal in (rule.head, *rule.body))]
    by_head: dict[tuple[bool, str], list[Rule]] = {}
    for rule in rules:
        by_head.setdefault((rule.head.positive, rule.head.predicate), []).append(rule)
    return Rules(
        by_head={key: tuple(found) for key, found in by_head.items()},
        goal=goal,
        static=frozenset(
            literal.predicate for literal in said if literal.predicate not in changing | derived
        ),
        derived=frozenset(derived),
        prices={
            (fact.fluent.symbol, *fact.fluent.args): fact.expression.value
            for fact in task.init
            if isinstance(fact, pddl.Assign)
        },
        named=frozenset(word for each in said for word in each.arguments if word[0] != "?"),
        alike=_alike(task.objects),
        size=size,
    )


def _alike(objects: Any) -> dict[str, frozenset[str]]:
    by_type: dict[str, set[str]] = {}
    for thing in objects:
        by_type.setdefault(thing.type_name, set()).add(thing.name)
    few = [frozenset(names) for names in by_type.values() if len(names) <= _FEW]
    return {name: names for names in few for name in names}


def _instances(
    domains: dict[str, Mapping[str, None]],
    static: Iterable[Literal],
    facts: Mapping[str, set[Words]],
) -> int:
    """At most so many ways there are to make static literals hold; narrows domains of variables.

    Every variable is counted once, with a literal of few facts that speaks of it, or alone.
    """
    literals = sorted(static, key=lambda each: len(facts.get(each.predicate, ())))
    for literal in literals:
        if len(literal.arguments) == 1 and literal.arguments[0] in domains:
            fitting = facts.get(literal.predicate, set())
            word = literal.arguments[0]
            domains[word] = {name: None for name in domains[word] if (name,) in fitting}
    left = {word: len(things) for word, things in domains.items()}
    count = 1
    for literal in literals:
        words = [word for word in dict.fromkeys(literal.arguments) if word in left]
        number = len(facts.get(literal.predicate, ()))
        if words and number < prod(left[word] for word in words):
            count *= number
            for word in words:
                del left[word]
    return count * prod(left.values())


def _price(action: Any) -> float | Words:
    if action.cost is None:
        return 0
    said = action.cost.expression
    if isinstance(said, pddl.NumericConstant):
        return float(said.value)
    return (said.symbol, *said.args)


def _domains(parameters: Any, objects: Mapping[str, Any]) -> dict[str, Mapping[str, None]]:
    return {each.name: objects.get(each.type_name, {}) for each in parameters}


def _literal(written: Any) -> Literal:
    return Literal(not written.negated, written.predicate, tuple(written.args))


def _literals(condition: Any) -> tuple[Literal, ...]:
    """The literals of a normalised condition, which is a conjunction of them."""
    if isinstance(condition, pddl.Literal):
        return (_literal(condition),)
    return tuple(literal for part in condition.parts for literal in _literals(part))
