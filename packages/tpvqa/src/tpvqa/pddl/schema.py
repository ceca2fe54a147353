"""Actions and conditions with variables, as their author wrote them, and how they become ground."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import product

from tpvqa.pddl.arithmetic import Expression, bound, compared, folded, functions_in
from tpvqa.pddl.atoms import Atom, Literal
from tpvqa.pddl.conditions import Condition, Conjunction, Disjunction
from tpvqa.pddl.ground import Action, Change, Effect
from tpvqa.pddl.numeric import Numeric

TRUE, FALSE = Conjunction(), Disjunction()

Objects = Mapping[str, tuple[str, ...]]
"""The objects of each type, those of its subtypes included."""

Binding = Mapping[str, str]
"""What each variable stands for."""


@dataclass(frozen=True, slots=True)
class Parameter:
    """A typed variable; its name starts with a question mark."""

    name: str
    type: str


@dataclass(frozen=True, slots=True)
class LiteralSchema:
    """A literal over variables and constants. The predicate `=` is equality of objects."""

    predicate: str
    arguments: tuple[str, ...]
    positive: bool = True


@dataclass(frozen=True, slots=True)
class ComparisonSchema:
    """A comparison of numbers.

    Attributes:
        comparison: The comparison.
        left: What is compared.
        right: With what.
        numbers: The numbers of the task.
    """

    comparison: str
    left: Expression
    right: Expression
    numbers: Numeric = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class Junction:
    """A conjunction, or a disjunction."""

    conjunctive: bool
    parts: tuple["ConditionSchema", ...] = ()


@dataclass(frozen=True, slots=True)
class Quantified:
    """A condition for all objects, or for at least one."""

    universal: bool
    parameters: tuple[Parameter, ...]
    part: "ConditionSchema"


ConditionSchema = LiteralSchema | ComparisonSchema | Junction | Quantified


@dataclass(frozen=True, slots=True)
class EffectSchema:
    """An effect; with parameters, one for each choice of objects."""

    parameters: tuple[Parameter, ...]
    condition: ConditionSchema
    literal: LiteralSchema


@dataclass(frozen=True, slots=True)
class ChangeSchema:
    """What becomes of a number; see `Change`.

    Attributes:
        parameters: The variables of which each choice is a change of its own.
        condition: Under which it changes.
        kind: How.
        function: The function with its arguments.
        by: By how much, or to what.
        numbers: The numbers of the task.
    """

    parameters: tuple[Parameter, ...]
    condition: ConditionSchema
    kind: str
    function: tuple[str, ...]
    by: Expression
    numbers: Numeric = field(repr=False, compare=False)


@dataclass(frozen=True, slots=True)
class ActionSchema:
    """An action as written.

    Attributes:
        cost: A number, or the function that says it: its name and its arguments.
    """

    name: str
    parameters: tuple[Parameter, ...]
    precondition: ConditionSchema
    effects: tuple[EffectSchema, ...]
    cost: int | tuple[str, ...] = 1
    changes: tuple[ChangeSchema, ...] = ()

    def cost_of(self, arguments: Iterable[str]) -> int | tuple[str, ...]:
        """The cost with objects for the parameters: a number, or a function of objects."""
        if isinstance(self.cost, int):
            return self.cost
        binding = dict(zip((each.name for each in self.parameters), arguments, strict=True))
        return tuple(binding.get(word, word) for word in self.cost)


@dataclass(frozen=True, slots=True)
class AxiomSchema:
    """A derived predicate and one condition under which it holds."""

    predicate: str
    parameters: tuple[Parameter, ...]
    condition: ConditionSchema


def bindings(parameters: tuple[Parameter, ...], objects: Objects) -> Iterator[dict[str, str]]:
    """All ways to give objects of the right types to some variables."""
    names = [parameter.name for parameter in parameters]
    for choice in product(*(objects.get(parameter.type, ()) for parameter in parameters)):
        yield dict(zip(names, choice, strict=True))


def _atom(literal: LiteralSchema, binding: Binding) -> Atom:
    return Atom(
        literal.predicate, tuple(binding.get(argument, argument) for argument in literal.arguments)
    )


def ground_condition(schema: ConditionSchema, binding: Binding, objects: Objects) -> Condition:
    """A condition with objects for its variables.

    Quantifiers are spelled out, equality is decided, and parts that are thereby true or false are
    folded away; all other literals stay, in the order written.
    """
    match schema:
        case LiteralSchema(predicate="="):
            left, right = _atom(schema, binding).arguments
            return TRUE if (left == right) == schema.positive else FALSE
        case LiteralSchema():
            return Literal(_atom(schema, binding), schema.positive)
        case ComparisonSchema():
            return _ground_comparison(schema, binding)
        case Junction(conjunctive, parts):
            return join(
                (ground_condition(part, binding, objects) for part in parts),
                conjunctive=conjunctive,
            )
        case Quantified(universal, parameters, part):
            return join(
                (
                    ground_condition(part, {**binding, **more}, objects)
                    for more in bindings(parameters, objects)
                ),
                conjunctive=universal,
            )


def _ground_comparison(schema: ComparisonSchema, binding: Binding) -> Condition:
    """A comparison with values for the functions that nothing changes; false where one has none."""
    left, right = (
        folded(bound(side, binding), schema.numbers.static) for side in (schema.left, schema.right)
    )
    if _lacks_value(left, schema.numbers) or _lacks_value(right, schema.numbers):
        return FALSE
    found = compared(schema.comparison, left, right)
    if isinstance(found, bool):
        return TRUE if found else FALSE
    return Literal(Atom(*found))


def _ground_changes(schema: ActionSchema, binding: Binding, objects: Objects) -> Iterator[Change]:
    for change in schema.changes:
        for more in bindings(change.parameters, objects):
            full = {**binding, **more}
            condition = ground_condition(change.condition, full, objects)
            if condition != FALSE:
                function = tuple(full.get(word, word) for word in change.function)
                by = folded(bound(change.by, full), change.numbers.static)
                yield Change(condition, change.kind, function, by)


def join(parts: Iterator[Condition], *, conjunctive: bool) -> Condition:
    """The conjunction or disjunction of conditions, flat and without constants."""
    neutral, deciding = (TRUE, FALSE) if conjunctive else (FALSE, TRUE)
    kind = Conjunction if conjunctive else Disjunction
    flat: list[Condition] = []
    for part in parts:
        if part == deciding:
            return deciding
        if isinstance(part, kind):
            flat.extend(part.parts)
        else:
            flat.append(part)
    if not flat:
        return neutral
    return flat[0] if len(flat) == 1 else kind(tuple(flat))


def required(condition: ConditionSchema) -> Iterator[LiteralSchema]:
    """The literals that a condition cannot do without."""
    if isinstance(condition, LiteralSchema):
        yield condition
    elif isinstance(condition, Junction) and condition.conjunctive:
        for part in condition.parts:
            yield from required(part)


def ground_action(
    schema: ActionSchema,
    arguments: tuple[str, ...],
    objects: Objects,
    functions: Mapping[tuple[str, ...], int],
) -> Action:
    """An action with objects for its parameters; `functions` holds what costs refer to."""
    names = [parameter.name for parameter in schema.parameters]
    binding = dict(zip(names, arguments, strict=True))
    effects = []
    for effect in schema.effects:
        for more in bindings(effect.parameters, objects):
            full = {**binding, **more}
            condition = ground_condition(effect.condition, full, objects)
            if condition != FALSE:
                literal = Literal(_atom(effect.literal, full), effect.literal.positive)
                effects.append(Effect(condition, literal))
    cost = schema.cost_of(arguments)
    if not isinstance(cost, int):
        cost = functions[cost]
    precondition = ground_condition(schema.precondition, binding, objects)
    changes = tuple(_ground_changes(schema, binding, objects)) if schema.changes else ()
    numbers = schema.changes[0].numbers if schema.changes else None
    if numbers is not None and any(_lacks_value(change.by, numbers) for change in changes):
        precondition = FALSE
    return Action(
        schema.name, arguments, precondition, tuple(dict.fromkeys(effects)), cost, changes
    )


def _lacks_value(expression: Expression, numbers: Numeric) -> bool:
    """Whether it speaks of a number that the problem does not give and nothing ever does."""
    return any(words[0] not in numbers.changed for words in functions_in(expression))
