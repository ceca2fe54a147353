"""Whether the world file fits: rules about what never holds, arguments that no skill takes."""

from collections.abc import Iterator
from pathlib import Path

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import line_of_action, line_of_entry
from tpvqa.drafting.doubt import is_done
from tpvqa.drafting.forms import is_ing
from tpvqa.drafting.lexicon import PREPOSITIONS
from tpvqa.drafting.names import words_of
from tpvqa.pddl import Task
from tpvqa.pddl.pattern import Pattern
from tpvqa.pddl.schema import ActionSchema, Junction, LiteralSchema
from tpvqa.worlds.world_file import WorldRules


def of_rules(task: Task, rules: WorldRules, file: Path | None) -> Iterator[Finding]:
    """Rules that speak of nothing that can be true."""
    known = task.reachable_atoms | task.init
    added = {p.predicate for rule in rules.undo for outcome in rule.outcomes for p in outcome.add}
    spoken: list[tuple[str, Pattern]] = [
        *(("undo", rule.fact) for rule in rules.undo),
        *(("rebind", rule.to) for rule in rules.rebind),
        *(("sensed", rule.fact) for rule in rules.sensed),
        *(("shown", rule.fact) for rule in rules.shown),
    ]
    for section, fact in spoken:
        if fact.predicate in added or any(fact.match(a, {}, task) is not None for a in known):
            continue
        yield Finding(
            "rule-in-vain",
            Severity.WARNING,
            f"{fact} under {section} can never be true in this problem, so the rule does nothing",
            "Mend it; if other problems of the domain need it, leave it.",
            named(file),
            line_of_entry(file, section, fact.predicate),
        )


def not_taken(task: Task, rules: WorldRules, into: str) -> Iterator[Finding]:
    """Arguments that are whatever is true, such as where the robot, or a lift, sets out from."""
    known = {(rule.action, rule.argument) for rule in rules.rebind}
    for schema in task.schemas:
        for argument, fact in _where_it_is(task, schema):
            if (schema.name, argument) in known:
                continue
            yield Finding(
                "argument-not-taken",
                Severity.NOTE,
                f"{argument} of {schema.name} is {_whatever(fact)}: a skill hardly takes it",
                "If yours does not, say so; else a simulated world fails an action that was "
                "planned with what no longer holds.",
                named(task.domain_path),
                line_of_action(task, schema.name),
                (
                    "rebind:",
                    f"  - action: {schema.name}",
                    f"    argument: {argument}",
                    f"    to: {fact}",
                ),
                into,
            )


def _whatever(fact: str) -> str:
    """What a fact says of what it is true of: (lift-at ?from), where the lift is."""
    words = words_of(fact.strip("()").split()[0])
    who = [word for word in words if word not in PREPOSITIONS]
    if len(who) == len(words) or (who and (is_ing(who[-1]) or is_done(who[-1]))):
        return f"whatever {fact} is true of"
    return f"where the {' '.join(who) or 'robot'} is"


def _where_it_is(task: Task, schema: ActionSchema) -> Iterator[tuple[str, str]]:
    """Parameters of a fact that exactly one object has, and that the action ends: at(?from).

    What the action changes otherwise, too, is no place: who racks wine empties one vessel.
    """
    precondition = schema.precondition
    parts = precondition.parts if isinstance(precondition, Junction) else (precondition,)
    ended = {e.literal.arguments for e in schema.effects if not e.literal.positive}
    begun = {e.literal.predicate for e in schema.effects if e.literal.positive}
    names = {p.name for p in schema.parameters}
    for part in parts:
        if (
            isinstance(part, LiteralSchema)
            and part.positive
            and len(part.arguments) == 1
            and set(part.arguments) <= names
            and part.arguments in ended
            and part.predicate in begun
            and not _changed_otherwise(schema, part.arguments[0], part.predicate)
            and _exactly_one(task, part.predicate)
        ):
            yield part.arguments[0], f"({part.predicate} {part.arguments[0]})"


def _changed_otherwise(schema: ActionSchema, argument: str, predicate: str) -> bool:
    literals = (each.literal for each in schema.effects)
    return any(argument in e.arguments and e.predicate != predicate for e in literals)


def _exactly_one(task: Task, predicate: str) -> bool:
    return any(
        group.exactly_one and {atom.predicate for atom in group.atoms} == {predicate}
        for group in task.mutex_groups
    )
