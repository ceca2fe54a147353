"""Which facts can ever hold in a trial: what actions, mishaps and its start bring about."""

from collections.abc import Iterator
from itertools import islice, product

from tpvqa.belief.filtering.priors import Priors
from tpvqa.pddl import Atom, Task
from tpvqa.pddl.schema import ActionSchema, EffectSchema, LiteralSchema, required
from tpvqa.questions import QuestionBook
from tpvqa.worlds.world_file import WorldRules

_LOOKED_AT = 20_000
"""Ways for an effect to come about that are looked at; where there are more, any fact may hold."""


def asking(book: QuestionBook, task: Task, rules: WorldRules, priors: Priors) -> QuestionBook:
    """A book that asks about nothing that can never hold.

    What actions end and none brings about came from elsewhere, and is asked: locked doors.

    Args:
        book: The book.
        task: The task, in which all that the priors name may hold at first.
        rules: What may happen besides actions.
        priors: What is known at first; where that is nothing, anything may hold. Of a predicate
            that rules or priors name, any fact may.
    """
    if priors.nothing_known or task.lasting is not None or task.left_out:
        return book
    added = {each.predicate for rule in rules.undo for o in rule.outcomes for each in o.add}
    stated = {form.predicate for form, _ in priors.facts}
    ended, unbounded = _only_ended(task)
    can_hold = task.atoms() | task.init | task.besides | task.left_open | ended
    return book.within(can_hold, task.derived | added | stated | unbounded)


def _only_ended(task: Task) -> tuple[frozenset[Atom], frozenset[str]]:
    """The facts that actions end and none brings about, and predicates of too many to list."""
    effects = [(schema, effect) for schema in task.schemas for effect in schema.effects]
    brought = {effect.literal.predicate for _, effect in effects if effect.literal.positive}
    found, unbounded = set[Atom](), set[str]()
    for schema, effect in effects:
        if effect.literal.predicate not in brought:
            ended = list(islice(_ended(task, schema, effect), _LOOKED_AT))
            found.update(ended)
            if len(ended) == _LOOKED_AT:
                unbounded.add(effect.literal.predicate)
    return frozenset(found), frozenset(unbounded)


def _ended(task: Task, schema: ActionSchema, effect: EffectSchema) -> Iterator[Atom]:
    """The facts that an effect ends where what never changes allows its action."""
    kinds = {each.name: each.type for each in (*schema.parameters, *effect.parameters)}
    needed = [*required(schema.precondition), *required(effect.condition)]
    fixed = frozenset(task.predicates) - task.fluents - task.derived
    lasting = [each for each in needed if each.positive and each.predicate in fixed]
    for binding in _met(task, lasting, kinds, {}):
        open_ones = sorted({*effect.literal.arguments} & {*kinds} - {*binding})
        choices = (task.objects_by_type.get(kinds[word], ()) for word in open_ones)
        for choice in product(*choices):
            full = {**binding, **dict(zip(open_ones, choice, strict=True))}
            arguments = tuple(full.get(word, word) for word in effect.literal.arguments)
            yield Atom(effect.literal.predicate, arguments)


def _met(
    task: Task, needed: list[LiteralSchema], kinds: dict[str, str], binding: dict[str, str]
) -> Iterator[dict[str, str]]:
    """The objects for variables with which facts that never change say all that is needed."""
    if not needed:
        yield binding
        return
    for atom in task.static:
        if atom.predicate != needed[0].predicate:
            continue
        more, fits = dict(binding), True
        for word, name in zip(needed[0].arguments, atom.arguments, strict=True):
            fits &= more.setdefault(word, name) == name if word in kinds else word == name
            fits &= word not in kinds or task.is_a(name, kinds[word])
        if fits:
            yield from _met(task, needed[1:], kinds, more)
