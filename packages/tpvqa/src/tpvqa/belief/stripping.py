"""Choosing by taking leaves off: exact, and all there is to do where the groups form a forest.

A member that lies in one group only is that group's default: what the group is worth where none of
its other members is chosen. Those others then have to be worth more than it, and are worth less by
as much; the default is decided last. A member that is worth nothing and that no group needs is not
chosen. So step by step groups lose members, members lose groups, and what is left is a kernel in
which every member lies in two groups at least.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.incidence import Flags, Incidence, Numbers

Weights = NDArray[np.float64]

ROUNDS = 500
"""A chain of groups loses a link at each end in every round; what is left then is the kernel."""


class Infeasible(Exception):  # noqa: N818
    """No choice satisfies all groups."""


@dataclass(frozen=True, slots=True)
class _Defaults:
    """One round's defaults, with the memberships that decide whether they are chosen."""

    member: Numbers
    group: Numbers
    rival_member: Numbers
    rival_group: Numbers


class Stripped:
    """What is left of a choice once its leaves are off.

    Args:
        incidence: The groups.
        weights: What choosing each member is worth; minus infinity where it cannot be.
        given: Members that are chosen whatever they are worth.

    Attributes:
        kernel: The memberships of members that are not decided yet. Members and groups keep
            their numbers.
        weights: What they are worth beyond the defaults that they displace.

    Raises:
        Infeasible: No choice satisfies all groups.
    """

    def __init__(self, incidence: Incidence, weights: Weights, given: Flags):
        self.weights = weights.copy()
        self._size, self._groups = incidence.size, len(incidence.exactly)
        self._group, self._member = incidence.group, incidence.member
        self._exactly = incidence.exactly.copy()
        self._closed = np.zeros(self._groups, dtype=np.bool_)
        self._open = (weights > -np.inf) & ~given
        self._chosen = np.zeros(self._size, dtype=np.bool_)
        self._defaults: list[_Defaults] = []
        self._take(given)
        for _ in range(ROUNDS):
            self._take_what_is_needed()
            if not self._strip():
                break
        else:
            self._take_what_is_needed()
        self._keep(self._open[self._member])
        self.kernel = Incidence(self._size, self._group, self._member, self._exactly)

    def completed(self, kernel: Numbers) -> Flags:
        """The whole choice, given the members of the kernel that are chosen."""
        chosen = self._chosen.copy()
        chosen[kernel] = True
        for defaults in reversed(self._defaults):
            taken = np.zeros(self._groups, dtype=np.bool_)
            taken[defaults.rival_group[chosen[defaults.rival_member]]] = True
            chosen[defaults.member] = ~taken[defaults.group]
        return chosen

    def _keep(self, which: Flags) -> None:
        self._group, self._member = self._group[which], self._member[which]

    def _count(self, which: Flags | None = None) -> Numbers:
        group = self._group if which is None else self._group[which]
        return np.bincount(group, minlength=self._groups)

    def _take(self, members: Flags) -> None:
        """Choose members, and nothing else in their groups."""
        filled = self._count(members[self._member])
        if np.any(filled > 1) or np.any(filled[self._closed]):
            raise Infeasible
        self._closed |= filled > 0
        self._chosen |= members
        self._open &= ~members
        self._open[self._member[self._closed[self._group]]] = False
        self._keep(self._open[self._member])

    def _take_what_is_needed(self) -> None:
        """Choose the last member of every group that must have one."""
        while True:
            left = self._count()
            needing = self._exactly & ~self._closed
            if np.any(needing & (left == 0)):
                raise Infeasible
            single = needing & (left == 1)
            if not single.any():
                return
            members = np.zeros(self._size, dtype=np.bool_)
            members[self._member[single[self._group]]] = True
            self._take(members)

    def _strip(self) -> bool:
        """One round; whether it changed anything."""
        self._keep((self._count() > 1)[self._group])
        degree = np.bincount(self._member, minlength=self._size)
        loose = self._open & (degree == 0)
        self._chosen |= loose & (self.weights > 0)
        self._open &= ~loose
        leaf = (degree == 1)[self._member]
        if leaf.any():
            self._set_defaults(leaf)
        needed = np.zeros(self._size, dtype=np.bool_)
        needed[self._member[self._exactly[self._group]]] = True
        worthless = self._open & (self.weights <= 0) & ~needed
        self._open &= ~worthless
        self._keep(self._open[self._member])
        return bool(leaf.any() or worthless.any())

    def _set_defaults(self, leaf: Flags) -> None:
        group, member = self._group[leaf], self._member[leaf]
        order = np.lexsort((member, -self.weights[member], group))
        group, member = group[order], member[order]
        best = np.ones(len(group), dtype=np.bool_)
        best[1:] = group[1:] != group[:-1]
        group, member = group[best], member[best]
        worth = self.weights[member]
        wanted = self._exactly[group] | (worth > 0)
        shift = np.zeros(self._groups)
        shift[group[wanted]] = worth[wanted]
        rival_group, rival_member = self._group[~leaf], self._member[~leaf]
        self._defaults.append(_Defaults(member[wanted], group[wanted], rival_member, rival_group))
        self.weights -= np.bincount(rival_member, weights=shift[rival_group], minlength=self._size)
        self._exactly[group] = False
        self._open[self._member[leaf]] = False
        self._group, self._member = rival_group, rival_member
