"""The translator's task as plain lists that fit into JSON; the package builds its `Task` of them.

Atoms are `[predicate, argument, …]`; conditions `["literal", positive, predicate, argument, …]`,
`["and", …]`, `["or", …]`, `["forall" or "exists", [[name, type], …], condition]`.
"""

from typing import Any

from fast_downward.translate import pddl
from fast_downward.translate.instantiate import get_objects_by_type


def atom(fact: Any) -> list[str]:
    """An atom as a list."""
    return [fact.predicate, *fact.args]


def condition(written: Any) -> list[Any]:
    """A condition as nested lists."""
    if isinstance(written, pddl.Literal):
        return ["literal", not written.negated, written.predicate, *written.args]
    if isinstance(written, pddl.Truth):
        return ["and"]
    if isinstance(written, pddl.Falsity):
        return ["or"]
    if isinstance(written, pddl.Conjunction):
        return ["and", *map(condition, written.parts)]
    if isinstance(written, pddl.Disjunction):
        return ["or", *map(condition, written.parts)]
    tag = "forall" if isinstance(written, pddl.UniversalCondition) else "exists"
    return [tag, _parameters(written.parameters), condition(written.parts[0])]


def _parameters(parameters: Any) -> list[list[str]]:
    return [[parameter.name, parameter.type_name] for parameter in parameters]


def _cost(action: Any, *, metric: bool) -> Any:
    """What an action costs: a number, or the function that says it, `[name, argument, …]`."""
    if not metric:
        return 1
    if action.cost is None:
        return 0
    expression = action.cost.expression
    if isinstance(expression, pddl.NumericConstant):
        return expression.value
    return [expression.symbol, *expression.args]


def static_description(task: Any) -> dict[str, Any]:
    """Everything that does not depend on the initial state. The task must not be normalised."""
    changed = {effect.literal.predicate for action in task.actions for effect in action.effects}
    return {
        "name": task.problem_name,
        "domain_name": task.domain_name,
        "objects": [[thing.name, thing.type_name] for thing in task.objects],
        "types": [[kind.name, kind.basetype_name] for kind in task.types],
        "objects_by_type": dict(get_objects_by_type(task.objects, task.types)),
        "predicates": [
            [
                predicate.name,
                [
                    "|".join(part.type_name[1:])
                    if isinstance(part.type_name, list)
                    else part.type_name
                    for part in predicate.arguments
                ],
            ]
            for predicate in task.predicates
            if predicate.name != "="
        ],
        "predicate_variables": {
            predicate.name: [part.name for part in predicate.arguments]
            for predicate in task.predicates
            if predicate.name != "="
        },
        "fluents": sorted(changed),
        "derived": sorted({axiom.name for axiom in task.axioms}),
        "goal": condition(task.goal),
        "init": [atom(fact) for fact in task.init if _stated(fact)],
        "functions": [
            [[fact.fluent.symbol, *fact.fluent.args], fact.expression.value]
            for fact in task.init
            if isinstance(fact, pddl.Assign)
        ],
        "actions": [
            {
                "name": action.name,
                "parameters": _parameters(action.parameters),
                "precondition": condition(action.precondition),
                "effects": [
                    [
                        _parameters(effect.parameters),
                        condition(effect.condition),
                        condition(effect.literal),
                    ]
                    for effect in action.effects
                ],
                "cost": _cost(action, metric=task.use_min_cost_metric),
            }
            for action in task.actions
        ],
        "axioms": [
            {
                "predicate": axiom.name,
                "parameters": _parameters(axiom.parameters),
                "condition": condition(axiom.condition),
            }
            for axiom in task.axioms
        ],
        "durative": task.durative,
        "numeric": None,
        "metric": task.metric,
    }


def _stated(fact: Any) -> bool:
    return isinstance(fact, pddl.Atom) and fact.predicate != "="
