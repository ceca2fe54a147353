"""Groups of which always exactly one atom holds, as what begins ends the others.

The translator lets only what an action needs and deletes balance what it adds. Who collects waste
is soiled afterwards, clean before or not: it need not be clean, and the two are a group all the
same.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from tpvqa.pddl.worker.grounding import AtomKey, key_of
from tpvqa.pddl.worker.inductive import First

WORK = 1_000_000
"""Atoms of groups that are looked at, for all actions together; some tenths of a second. Groups
that are left then are not told."""

Group = frozenset[AtomKey]


@dataclass(frozen=True, slots=True)
class _Step:
    """What a ground action needs, and what it does.

    Attributes:
        needs: Atoms that hold before it.
        adds: Atoms that hold after it.
        ends: Atoms that do not, whether they held or not.
        perhaps: What it adds or deletes only at times.
    """

    needs: Group
    adds: Group
    ends: Group
    perhaps: Group

    @staticmethod
    def of(action: Any) -> "_Step":
        added = [(when, key_of(fact)) for when, fact in action.add_effects]
        gone = [(when, key_of(fact)) for when, fact in action.del_effects]
        adds = frozenset(key for when, key in added if not when)
        return _Step(
            frozenset(key_of(each) for each in action.precondition if not each.negated),
            adds,
            frozenset(key for when, key in gone if not when) - adds,
            frozenset(key for when, key in (*added, *gone) if when),
        )

    def keeps(self, group: Group) -> bool:
        """Whether exactly one of a group holds after it, where exactly one did before."""
        if not group.isdisjoint(self.perhaps):
            return False
        adds, held = group & self.adds, group & self.needs
        if not adds:
            return group.isdisjoint(self.ends) or bool(held and held.isdisjoint(self.ends))
        return len(adds) == 1 and (held or group) - adds <= self.ends


def replacing_groups(
    actions: Iterable[Any], first: First, *, work: int = WORK
) -> Iterator[tuple[Group, bool]]:
    """The groups, each with `True`: exactly one of its atoms always holds.

    Guessed is what an action adds, with what it deletes though it may not hold. Each group is
    proved by itself.

    Args:
        actions: The translator's ground actions.
        first: What may hold initially.
        work: Atoms of groups that are looked at before no further group is told.
    """
    steps = [_Step.of(each) for each in actions]
    touching: dict[AtomKey, list[int]] = {}
    for number, step in enumerate(steps):
        for key in step.adds | step.ends | step.perhaps:
            touching.setdefault(key, []).append(number)
    for group in _guessed(steps):
        if first.weight(group) != (1, 1):
            continue
        proved = True
        for number in sorted({n for key in group for n in touching.get(key, ())}):
            work -= len(group)
            if work < 0:
                return
            if not steps[number].keeps(group):
                proved = False
                break
        if proved:
            yield group, True


def _guessed(steps: Sequence[_Step]) -> list[Group]:
    found = set[Group]()
    for step in steps:
        gone = step.ends - step.needs
        if gone:
            found |= {gone | {key} for key in step.adds}
    return sorted(found, key=lambda group: (len(group), sorted(group)))
