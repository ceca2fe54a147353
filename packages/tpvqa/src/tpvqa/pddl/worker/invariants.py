"""Mutex groups worth telling about, and the proof of which hold exactly one atom."""

from collections.abc import Iterable, Iterator, Sequence, Set
from itertools import product
from typing import Any

from fast_downward.translate import invariant_finder, pddl
from fast_downward.translate.instantiate import get_objects_by_type

from tpvqa.pddl.worker.grounding import AtomKey, Grounding, key_of
from tpvqa.pddl.worker.inductive import First, inductive_groups
from tpvqa.pddl.worker.replacing import replacing_groups

_COUNTED = "?X"  # how the translator writes the argument that a group counts

Group = tuple[frozenset[AtomKey], bool]
"""The atoms, and whether exactly one of them always holds."""


def described_groups(
    task: Any, grounding: Grounding, state: frozenset[AtomKey], first: First
) -> list[tuple[list[AtomKey], bool]]:
    """The groups of a task from an initial state.

    First come the laws of the domain: invariants that no action can break, whatever is reachable.
    They name all atoms of fitting types, also those that only a mishap brings about. Then those
    that induction over conditional effects proves, and over effects that delete what need not
    hold, and groups that hold because of what is reachable from this state. Groups that no action
    adds to are left out (an accident of this initial state), and so are those within another.

    Args:
        task: The translator's normalised task; its initial state is that of the grounding.
        grounding: The grounding from this state.
        state: Its fluent atoms.
        first: What else may hold initially.
    """
    kept = _widest(_laws(task, grounding.atoms), [])
    if _lawless(task, grounding):
        derived = {axiom.name for axiom in task.axioms}  # no action adds what follows from others
        own = {key for key in grounding.atoms if key[0] not in derived}
        kept = _widest(inductive_groups(grounding.actions, own, first), kept)
    if task.durative is None:  # to break off what lasts takes back what it had ended
        kept = _widest(replacing_groups(grounding.actions, first), kept)
    proved = [atoms for atoms, exactly_one in kept if exactly_one]
    others = [group for group in grounding.mutex_groups if not any(group <= p for p in proved)]
    return _listed(_widest(_reached(grounding, others, state), kept))


def _lawless(task: Any, grounding: Grounding) -> bool:
    """Whether there may be groups that the translator's invariants do not find.

    It takes a conditional effect to add and not to delete, and the end of an action that lasts to
    delete only what is needed then, though it was needed at its start.
    """
    effects = (e for each in grounding.actions for e in (*each.add_effects, *each.del_effects))
    return task.durative is not None or any(when for when, _ in effects)


def lawful_groups(task: Any, reachable: Set[AtomKey]) -> list[tuple[list[AtomKey], bool]]:
    """The laws of the domain alone, for the things that the initial state speaks of.

    They hold whatever objects there are, and name those that it does not speak of, too.

    Args:
        task: The translator's normalised task, with all its objects.
        reachable: The atoms that can be reached.
    """
    return _listed(_widest(_laws(task, reachable), []))


def _widest(groups: Iterable[Group], kept: list[Group]) -> list[Group]:
    """Adds to groups that are kept those that lie within none of them."""
    for atoms, exactly_one in sorted(groups, key=_size):
        if not any(atoms <= other and (one or not exactly_one) for other, one in kept):
            kept.append((atoms, exactly_one))
    return kept


def _listed(groups: Iterable[Group]) -> list[tuple[list[AtomKey], bool]]:
    return sorted((sorted(atoms), exactly_one) for atoms, exactly_one in groups)


def _size(group: Group) -> tuple[int, list[AtomKey]]:
    return -len(group[0]), sorted(group[0])


def _laws(task: Any, reachable: Set[AtomKey]) -> Iterator[Group]:
    objects = get_objects_by_type(task.objects, task.types)
    actions = [action for action in task.actions if not action.name.startswith("unsure@")]
    for invariant in invariant_finder.find_invariants(task, None):
        exactly_one = all(balances(action, invariant) for action in actions)
        for parts in invariant_finder.useful_groups([invariant], task.init):
            atoms = frozenset(
                key for part in parts for key in _expanded(part, task, objects, reachable)
            )
            if len(atoms) > 1 and any(_adds(action, parts, objects) for action in actions):
                yield atoms, exactly_one


def _expanded(
    part: Any, task: Any, objects: dict[str, list[str]], reachable: Set[AtomKey]
) -> Iterator[AtomKey]:
    """The atoms of a part of a group, with every object of a fitting type counted.

    The arguments that are not counted come from another predicate of the group, so they need not
    fit this one.
    """
    predicate = next(entry for entry in task.predicates if entry.name == part.predicate)
    choices, fits = [], True
    for argument, parameter in zip(part.args, predicate.arguments, strict=True):
        kinds = parameter.type_name
        kinds = kinds[1:] if isinstance(kinds, list) else [kinds]
        fitting = dict.fromkeys(name for kind in kinds for name in objects.get(kind, ()))
        choices.append(list(fitting) if argument == _COUNTED else [argument])
        fits &= argument == _COUNTED or argument in fitting or "object" in kinds
    for arguments in product(*choices):
        key = (part.predicate, *arguments)
        if fits or key in reachable:
            yield key


def _adds(action: Any, parts: Sequence[Any], objects: dict[str, list[str]]) -> bool:
    """Whether an action can add an atom of a group, as far as types tell."""
    for effect in action.effects:
        literal = effect.literal
        for part in parts:
            if literal.negated or literal.predicate != part.predicate:
                continue
            types = {p.name: p.type_name for p in (*action.parameters, *effect.parameters)}
            if all(
                wanted in (_COUNTED, argument) or wanted in objects.get(types.get(argument, ""), ())
                for wanted, argument in zip(part.args, literal.args, strict=True)
            ):
                return True
    return False


def _conditions(condition: Any) -> set[Any]:
    """The literals of a normalised condition."""
    if isinstance(condition, pddl.Literal):
        return {condition}
    return {literal for part in condition.parts for literal in _conditions(part)}


def balances(action: Any, invariant: Any) -> bool:
    """Whether, wherever an action deletes from a group of an invariant, it adds to it as well."""
    given = _conditions(action.precondition)
    adds = [
        (group_key(effect.literal, invariant), _conditions(effect.condition))
        for effect in action.effects
        if effect.literal.predicate in invariant.predicates
        and not effect.literal.negated
        and not effect.parameters
    ]
    for effect in action.effects:
        literal = effect.literal
        if literal.predicate in invariant.predicates and literal.negated:
            when = given | _conditions(effect.condition)
            own = group_key(literal, invariant)
            if not any(key == own and needed <= when for key, needed in adds):
                return False
    return True


def group_key(literal: Any, invariant: Any) -> tuple[str, ...]:
    """Which group of an invariant a literal belongs to: its arguments but the counted one."""
    values = invariant.get_parameters(literal)
    return tuple(values[number] for number in range(invariant.arity()))


def _reached(
    grounding: Grounding, groups: Sequence[frozenset[AtomKey]], state: frozenset[AtomKey]
) -> Iterator[Group]:
    if not groups:
        return
    added = {key_of(fact) for action in grounding.actions for _, fact in action.add_effects}
    possible = [action for action in grounding.actions if _possible(action, grounding.mutex_groups)]
    for group in groups:
        if group & added:
            exactly_one = len(group & state) == 1
            yield group, exactly_one and all(_keeps(action, group) for action in possible)


def _positive(literals: Iterable[Any]) -> set[AtomKey]:
    return {key_of(literal) for literal in literals if not literal.negated}


def _possible(action: Any, groups: Sequence[frozenset[AtomKey]]) -> bool:
    """Whether its precondition asks for no two atoms that exclude each other."""
    needed = _positive(action.precondition)
    return len(needed) < 2 or all(len(needed & group) <= 1 for group in groups)


def _keeps(action: Any, group: frozenset[AtomKey]) -> bool:
    """Whether an action leaves one atom of the group true where exactly one was true."""
    deletes = [(condition, fact) for condition, fact in action.del_effects if key_of(fact) in group]
    if not deletes:
        return True
    given = set(action.precondition)
    adds = [set(condition) for condition, fact in action.add_effects if key_of(fact) in group]
    for condition, fact in deletes:
        when = given | set(condition)
        if (_positive(when) & group) - {key_of(fact)}:
            continue  # another member is the true one, so nothing is deleted
        if not any(added <= when for added in adds):
            return False
    return True
