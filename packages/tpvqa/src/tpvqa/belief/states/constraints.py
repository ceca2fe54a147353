"""What can hold together: groups of facts of which one holds, and pairs that never do."""

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from tpvqa.belief.states.disturbances import reaching
from tpvqa.belief.states.transitions import Transition, of_action
from tpvqa.pddl import Atom, State, Task

Atoms = frozenset[Atom]


class Group(NamedTuple):
    """Facts of which at most one holds.

    Attributes:
        atoms: The facts, in alphabetical order.
        needed: Whether one of them must hold.
    """

    atoms: tuple[Atom, ...]
    needed: bool


@dataclass(frozen=True)
class Constraints:
    """What every state of a task keeps.

    Attributes:
        exactly_one: Groups of atoms of which exactly one holds.
        at_most_one: Groups of atoms of which at most one holds.
        pairs: Pairs of atoms that do not hold together, besides those in one group.
        unreachable: Members of groups that nothing makes true. They keep others from being true
            where they are believed, but nothing is believed to be there for want of a better place.
    """

    exactly_one: tuple[Atoms, ...] = ()
    at_most_one: tuple[Atoms, ...] = ()
    pairs: frozenset[Atoms] = frozenset()
    unreachable: Atoms = frozenset()

    @staticmethod
    def of(
        task: Task,
        pairs: Iterable[Atoms] = (),
        *,
        never: Collection[Atom] = (),
        further: Collection[Transition] = (),
    ) -> "Constraints":
        """The constraints that a task's mutex groups give, and further pairs.

        Args:
            task: The task; its groups hold from its initial state.
            pairs: Pairs that are known never to hold together, e.g. those of `h2_mutexes`. Those
                that a group covers are left out.
            never: Atoms that are known never to hold, e.g. those of `h2_mutexes`.
            further: What can happen besides actions (see `disturbances`). A group that this may
                break is weakened or left out.

        Raises:
            PlannerError: Further transitions open up new actions, and grounding those failed.
        """
        wider = reaching(task, further)
        reachable = wider.atoms() | wider.init
        if wider is not task:
            new = set(wider.reachable_actions) - set(task.reachable_actions)
            actions = (task.action(words[0], words[1:]) for words in sorted(new))
            further = (*further, *(of_action(action, task) for action in actions))
        exactly: list[Atoms] = []
        at_most: list[Atoms] = []
        for group in task.mutex_groups:
            if not all(_keeps_one(transition, group.atoms) for transition in further):
                continue
            emptied = any(_may_empty(transition, group.atoms) for transition in further)
            (exactly if group.exactly_one and not emptied else at_most).append(group.atoms)
        groups_of: dict[Atom, set[int]] = {}
        for number, members in enumerate((*exactly, *at_most)):
            for atom in members:
                groups_of.setdefault(atom, set()).add(number)
        return Constraints(
            tuple(exactly),
            tuple(at_most),
            frozenset(
                pair
                for pair in pairs
                if not set.intersection(*(groups_of.get(atom, set()) for atom in pair))
            ),
            frozenset(groups_of) - (reachable - frozenset(never)),
        )

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Every group and pair once, in an order of its own; those of `exactly_one` come first."""
        needed = set(self.exactly_one)
        groups = needed.union(self.at_most_one, self.pairs)
        listed = sorted((group not in needed, tuple(sorted(group))) for group in groups)
        return tuple(Group(atoms, not optional) for optional, atoms in listed)

    @cached_property
    def groups_of(self) -> Mapping[Atom, Sequence[int]]:
        """The places in `groups` of those in which each atom lies."""
        found: dict[Atom, list[int]] = {}
        for number, group in enumerate(self.groups):
            for atom in group.atoms:
                found.setdefault(atom, []).append(number)
        return found

    def violated(self, state: State) -> list[int]:
        """The places in `groups` of those that a state violates; empty where it is consistent."""
        held = Counter(number for atom in state for number in self.groups_of.get(atom, ()))
        return [
            number
            for number, group in enumerate(self.groups)
            if held[number] > 1 or (group.needed and not held[number])
        ]


def _keeps_one(transition: Transition, group: Atoms) -> bool:
    """Whether at most one of a group holds after a transition, if at most one did before."""
    added = transition.added & group
    if not added or len(transition.needed & group) > 1:
        return True
    held = transition.needed & group or group
    return len(added) == 1 and held <= transition.deleted | added


def _may_empty(transition: Transition, group: Atoms) -> bool:
    """Whether none of a group may hold after a transition, if exactly one did before."""
    held = transition.needed & group or group
    return not transition.added & group and not held.isdisjoint(transition.deleted)
