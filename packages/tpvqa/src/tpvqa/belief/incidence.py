"""Constraints as arrays of numbers, as the solvers want them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.intp]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Incidence:
    """Which members lie in which groups; at most one member of a group is chosen.

    Attributes:
        size: How many members there are.
        group: The group of each membership, ascending.
        member: The member of each membership.
        exactly: For each group, whether one member must be chosen.
    """

    size: int
    group: Numbers
    member: Numbers
    exactly: Flags

    @staticmethod
    def of(size: int, groups: Sequence[Sequence[int]], exactly: Sequence[bool]) -> "Incidence":
        """From the members of each group."""
        return Incidence(
            size,
            np.repeat(np.arange(len(groups)), [len(members) for members in groups]),
            np.array([member for members in groups for member in members], dtype=np.intp),
            np.array(exactly, dtype=np.bool_),
        )

    def parts(self) -> list[tuple[Numbers, "Incidence"]]:
        """The parts that share no group with any other: their members, ascending, and their groups
        over the places of these. Groups without members are in none."""
        if not self.size:
            return []
        label = connected(self.size, self.group, self.member)
        members = np.argsort(label, kind="stable")
        first = np.flatnonzero(np.diff(label[members], prepend=-1))
        place = np.empty(self.size, dtype=np.intp)
        place[members] = np.arange(self.size) - np.repeat(first, np.diff(first, append=self.size))
        order = np.argsort(label[self.member], kind="stable")
        group, member = self.group[order], self.member[order]
        cuts = np.searchsorted(label[member], label[members[first]])
        ends = np.append(cuts[1:], len(member))
        result = []
        for inside, start, end in zip(np.split(members, first[1:]), cuts, ends, strict=True):
            here = group[start:end]
            number = np.cumsum(np.diff(here, prepend=here[:1]) != 0)
            exactly = self.exactly[here[np.diff(here, prepend=-1) != 0]]
            result.append(
                (inside, Incidence(len(inside), number, place[member[start:end]], exactly))
            )
        return result

    def listed(self) -> list[tuple[list[int], bool]]:
        """The members of each group, and whether one must be chosen."""
        members: list[list[int]] = [[] for _ in self.exactly]
        for group, member in zip(self.group.tolist(), self.member.tolist(), strict=True):
            members[group].append(member)
        return list(zip(members, self.exactly.tolist(), strict=True))

    def over(self, members: Numbers) -> "Incidence":
        """The same groups over the places of some members, ascending; others are left out."""
        place = np.full(self.size, -1, dtype=np.intp)
        place[members] = np.arange(len(members))
        inside = place[self.member] >= 0
        return Incidence(len(members), self.group[inside], place[self.member[inside]], self.exactly)


def connected(size: int, group: Numbers, member: Numbers) -> Numbers:
    """For each member the least one that is connected to it by shared groups.

    Args:
        size: How many members there are.
        group: The group of each membership, ascending.
        member: The member of each membership.
    """
    label = np.arange(size)
    if not len(group):
        return label
    starts = np.flatnonzero(np.diff(group, prepend=-1))
    sizes = np.diff(starts, append=len(group))
    while True:
        least = np.repeat(np.minimum.reduceat(label[member], starts), sizes)
        after = label.copy()
        np.minimum.at(after, label[member], least)
        np.minimum.at(after, member, least)
        after = after[after]
        if np.array_equal(after, label):
            return label
        label = after
