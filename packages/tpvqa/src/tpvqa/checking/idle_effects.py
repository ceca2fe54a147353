"""Conditional effects that never come about, as what they are conditional on never holds."""

from collections.abc import Iterable, Iterator

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import line_of_action
from tpvqa.pddl import Task
from tpvqa.pddl.schema import ConditionSchema, LiteralSchema, Parameter, required


def of_idle_effects(task: Task, undone: frozenset[str] = frozenset()) -> Iterator[Finding]:
    """Effects whose condition can never hold, of actions that can be done.

    Args:
        task: The task.
        undone: The predicates of facts that may come about otherwise.
    """
    if task.left_out:
        return  # what is left out may bring it about
    reached = {words[0] for words in task.reachable_actions}
    for schema in task.schemas:
        found = (
            unmet(task, effect.condition, (*schema.parameters, *effect.parameters), undone)
            for effect in schema.effects
            if schema.name in reached
        )
        if said := next(filter(None, found), ""):
            yield Finding(
                "effect-never",
                Severity.WARNING,
                f"an effect of {schema.name} never comes about in this problem: {said}",
                "Mend its condition or the initial state; if other problems need it, leave it.",
                named(task.domain_path),
                line_of_action(task, schema.name),
            )


def unmet(
    task: Task,
    condition: ConditionSchema,
    parameters: Iterable[Parameter],
    undone: frozenset[str],
) -> str:
    """What a condition needs that never holds, in words; empty where there is none.

    Args:
        task: The task.
        condition: The condition.
        parameters: What its variables stand for.
        undone: The predicates of facts that may come about otherwise.
    """
    kinds = {each.name: each.type for each in parameters}
    for literal in required(condition):
        if literal.predicate == "=" or not literal.positive or literal.predicate in undone:
            continue
        if not _may_hold(task, literal, kinds):
            said = f"({' '.join((literal.predicate, *literal.arguments))})"
            return f"it needs {said}, which never holds, and nothing brings it about"
    return ""


def _may_hold(task: Task, literal: LiteralSchema, kinds: dict[str, str]) -> bool:
    return any(
        atom.predicate == literal.predicate
        and all(
            argument == word if word not in kinds else task.is_a(argument, kinds[word])
            for word, argument in zip(literal.arguments, atom.arguments, strict=True)
        )
        for atom in task.reachable_atoms | task.init
    )
