"""What can hold together: groups of facts of which one holds, and pairs that never do."""

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from tpvqa.belief.disturbances import reaching
from tpvqa.belief.incidence import Flags, Incidence, Numbers
from tpvqa.belief.transitions import Transition, of_action
from tpvqa.pddl import Atom, State, Task

Atoms = frozenset[Atom]


@dataclass(frozen=True, slots=True)
class Contradiction:
    """Facts that cannot all be as they are believed to be.

    Attributes:
        atoms: They all hold, or, where `missing`, none of them does.
        missing: Whether one of them must hold and none does.
    """

    atoms: tuple[Atom, ...]
    missing: bool = False

    def __str__(self) -> str:
        *others, last = map(str, self.atoms)
        if self.missing:
            return f"one of {', '.join((*others, last))} must hold, and none does"
        if len(others) == 1:
            return f"{others[0]} and {last} cannot both hold"
        return f"only one of {', '.join(others)} and {last} can hold"


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

    def violated(self, state: State) -> list[Contradiction]:
        """What in a state cannot be so; empty where it is consistent.

        Args:
            state: The facts that are believed to hold; all others are believed not to.
        """
        found = set(self._too_many(state))
        for group in self.exactly_one:
            if group.isdisjoint(state):
                found.add(Contradiction(tuple(sorted(group)), missing=True))
        return sorted(found, key=lambda each: (each.missing, each.atoms))

    def _too_many(self, state: State) -> Iterator[Contradiction]:
        held: dict[Atoms, list[Atom]] = {}
        for atom in state:
            for group in self._groups_of.get(atom, ()):
                held.setdefault(group, []).append(atom)
        for atoms in held.values():
            if len(atoms) > 1:
                yield Contradiction(tuple(sorted(atoms)))

    @cached_property
    def atoms(self) -> tuple[Atom, ...]:
        """Every atom that a constraint speaks of, in a fixed order."""
        return tuple(sorted(self._groups_of, key=lambda atom: (atom.predicate, atom.arguments)))

    @cached_property
    def numbers(self) -> dict[Atom, int]:
        """The place of each atom in `atoms`."""
        return {atom: number for number, atom in enumerate(self.atoms)}

    @cached_property
    def incidence(self) -> Incidence:
        """The constraints over the places of their atoms; those of `exactly_one` come first."""
        needing = set(self.exactly_one)
        groups = needing.union(self.at_most_one, self.pairs)
        # Sorted, as equally good states are told apart by the numbers of groups.
        listed = sorted(
            (group not in needing, sorted(self.numbers[atom] for atom in group)) for group in groups
        )
        return Incidence.of(
            len(self.atoms),
            [members for _, members in listed],
            [not optional for optional, _ in listed],
        )

    @cached_property
    def parts(self) -> tuple[tuple[Numbers, Incidence], ...]:
        """The parts that share no constraint: places of their atoms, and their constraints."""
        return tuple(self.incidence.parts())

    @cached_property
    def part_of(self) -> Numbers:
        """The number of the part in which each atom of `atoms` lies."""
        numbers = np.zeros(len(self.atoms), dtype=np.intp)
        for number, (members, _) in enumerate(self.parts):
            numbers[members] = number
        return numbers

    @cached_property
    def barred(self) -> Flags:
        """Whether each atom of `atoms` is unreachable."""
        return np.array([atom in self.unreachable for atom in self.atoms], dtype=np.bool_)

    @cached_property
    def _groups_of(self) -> dict[Atom, list[Atoms]]:
        index: dict[Atom, list[Atoms]] = {}
        for group in dict.fromkeys((*self.exactly_one, *self.at_most_one, *self.pairs)):
            for atom in group:
                index.setdefault(atom, []).append(group)
        return index


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
