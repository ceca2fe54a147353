"""Which mutex groups hold exactly one atom, proved from the ground actions."""

from collections.abc import Iterable, Sequence
from typing import Any

from tpvqa.pddl.worker.grounding import AtomKey, Grounding, key_of


def described_groups(
    grounding: Grounding, state: frozenset[AtomKey]
) -> list[tuple[list[AtomKey], bool]]:
    """The groups worth knowing, each with whether exactly one of its atoms always holds.

    Left out are groups that no action adds to (an accident of this initial state, not a law of the
    domain) and those that lie within another.

    Args:
        grounding: The grounding whose groups are meant.
        state: The fluent atoms of the initial state.
    """
    added = {key_of(fact) for action in grounding.actions for _, fact in action.add_effects}
    groups = sorted((set(group) for group in grounding.mutex_groups if group & added), key=len)
    kept: list[frozenset[AtomKey]] = []
    for group in reversed(groups):
        if not any(group <= other for other in kept):
            kept.append(frozenset(group))
    possible = [
        action for action in grounding.actions if _possible(action, grounding.mutex_groups)
    ]
    result = [
        (
            sorted(group),
            len(group & state) == 1 and all(_keeps(action, group) for action in possible),
        )
        for group in kept
    ]
    return sorted(result)


def _positive(literals: Iterable[Any]) -> set[AtomKey]:
    return {key_of(literal) for literal in literals if not literal.negated}


def _possible(action: Any, groups: Sequence[frozenset[AtomKey]]) -> bool:
    """Whether its precondition asks for no two atoms that exclude each other."""
    needed = _positive(action.precondition)
    return all(len(needed & group) <= 1 for group in groups)


def _keeps(action: Any, group: frozenset[AtomKey]) -> bool:
    """Whether the action leaves one atom of the group true where exactly one was true."""
    given = set(action.precondition)
    sure_adds = [
        set(condition) for condition, fact in action.add_effects if key_of(fact) in group
    ]
    for condition, fact in action.del_effects:
        if key_of(fact) not in group:
            continue
        when = given | set(condition)
        if (_positive(when) & group) - {key_of(fact)}:
            continue  # another member is the true one, so nothing is deleted
        if not any(added <= when for added in sure_adds):
            return False
    return True
