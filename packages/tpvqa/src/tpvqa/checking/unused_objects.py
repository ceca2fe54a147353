"""Objects of the problem that play no part, whatever happens."""

import re
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.places import line_of_object
from tpvqa.pddl import Task, literals
from tpvqa.pddl.schema import ConditionSchema, Junction, Parameter, Quantified, required
from tpvqa.questions.wordings import Wordings

_LISTED = 8


def of_objects(task: Task, given: Wordings, world_file: Path | None) -> Iterator[Finding]:
    """Objects that no fact names, and that none can come to name.

    That is so where each action, axiom and effect that could take them needs a fact about them
    first, whatever is reached; reachability alone would pass over what disturbances make possible.

    Args:
        task: The task.
        given: The questions file: what it has in doubt may hold of any object.
        world_file: The world file, which may name objects and has been read before.
    """
    spoken = _spoken_of(task, world_file)
    open_kinds = {*_open_kinds(task), *_doubted_kinds(task, given)}
    idle = [
        each
        for each in task.objects
        if each not in spoken and not any(task.is_a(each, kind) for kind in open_kinds)
    ]
    if not idle:
        return
    more = f" and {len(idle) - _LISTED} more" if len(idle) > _LISTED else ""
    yield Finding(
        "object-unused",
        Severity.WARNING,
        f"no fact and no goal of the problem names {', '.join(idle[:_LISTED])}{more}, and no "
        "action can take what no fact names",
        "State what is true of it at first, or leave it out.",
        named(task.problem_path),
        line_of_object(task, idle[0]),
    )


def _spoken_of(task: Task, world_file: Path | None) -> set[str]:
    """The objects that something names: constants of the domain, too."""
    atoms = {*task.init, *task.left_open, *task.besides}
    atoms |= {literal.atom for literal in literals(task.goal)}
    values = () if task.numeric is None else task.numeric.values
    found = {argument for atom in atoms for argument in atom.arguments}
    found.update(chain.from_iterable(words[1:] for words in (*task.functions, *values)))
    text = task.domain_text
    if world_file is not None:
        text += " " + world_file.read_text("utf-8", errors="replace")
    return found | {word.strip("\"',;:[]{}").lower() for word in re.findall(r"[^\s()]+", text)}


def _open_kinds(task: Task) -> Iterator[str]:
    """Types of which an object can play a part although no fact names it."""
    for schema in task.schemas:
        yield from _unbound(schema.parameters, schema.precondition)
        for effect in schema.effects:
            yield from _unbound(effect.parameters, effect.condition)
        for change in schema.changes:
            yield from _unbound(change.parameters, change.condition)
    for axiom in task.axioms:
        yield from _unbound(axiom.parameters, axiom.condition)


def _unbound(parameters: Iterable[Parameter], condition: ConditionSchema) -> Iterator[str]:
    """The types of parameters of which a condition needs no fact, and those quantified over."""
    needed = (each for each in required(condition) if each.positive and each.predicate != "=")
    bound = {argument for each in needed for argument in each.arguments}
    yield from (each.type for each in parameters if each.name not in bound)
    yield from _quantified(condition)


def _quantified(condition: ConditionSchema) -> Iterator[str]:
    if isinstance(condition, Junction):
        for part in condition.parts:
            yield from _quantified(part)
    elif isinstance(condition, Quantified):
        yield from (each.type for each in condition.parameters)
        yield from _quantified(condition.part)


def _doubted_kinds(task: Task, given: Wordings) -> Iterator[str]:
    for each in given.in_doubt:
        yield from task.predicates[each.fact.predicate]
