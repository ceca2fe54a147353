"""The most probable consistent states, best first: exact search over groups of facts.

Facts are bits of an integer, so that a partial state is two of them: what holds and what does not.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import count
from math import inf
from typing import NamedTuple

from tpvqa.belief.states.constraints import Group
from tpvqa.pddl import Atom, Literal, State

NODES = 6_000
"""Partial states that are looked into for one list: a few seconds."""

Clause = tuple[Literal, ...]
Factor = tuple[int, float]
"""Some facts, as bits, and what is added where any of them holds."""


class Variable(NamedTuple):
    """Facts of which at most one holds, as one choice.

    Attributes:
        atoms: The facts. Each lies in one variable.
        needed: Whether one of them must hold.
    """

    atoms: tuple[Atom, ...]
    needed: bool


@dataclass(frozen=True, slots=True)
class Found:
    """What a search found.

    Attributes:
        states: The facts that hold, as bits, with the state's score; the highest first.
        complete: Whether there are no further ones, but for those of too low a score.
    """

    states: tuple[tuple[int, float], ...]
    complete: bool


class Likeliest:
    """Finds the states of the highest score that keep all constraints (A*: Hart et al. 1968).

    A state's score is the sum of those of its facts. Of a partial state it is bounded by the best
    fact that is still free of every variable; what constraints make of a choice is worked out at
    once (unit propagation). So states come out in the order of their score, and the first k are
    the k best.

    Args:
        variables: The facts that may hold or not, each in one of them.
        groups: Facts of which at most one holds, or exactly one.
        clauses: Literals of which at least one holds.
        certain: What holds besides.
        keeps: A test for what groups and clauses do not say; it is given whole states.
    """

    def __init__(
        self,
        variables: Sequence[Variable],
        groups: Iterable[Group] = (),
        clauses: Iterable[Clause] = (),
        *,
        certain: State = frozenset(),
        keeps: Callable[[State], bool] | None = None,
    ):
        self.atoms = tuple(atom for variable in variables for atom in variable.atoms)
        self._bit = {atom: 1 << place for place, atom in enumerate(self.atoms)}
        self._certain, self._keeps = certain, keeps
        self._kept: dict[int, bool] = {}
        self._variables = [(variable.needed, self.bits(variable.atoms)) for variable in variables]
        self._never = 0
        self._possible = True
        self._needed: list[int] = []
        self._rivals = dict.fromkeys(self._bit.values(), 0)
        for group in (*groups, *(Group(each.atoms, each.needed) for each in variables)):
            self._take_in(group)
        self._clauses: list[tuple[int, int]] = []
        for clause in clauses:
            self._take_in_clause(clause)

    def _take_in(self, group: Group) -> None:
        bits = self.bits(group.atoms)
        held = len(self._certain.intersection(group.atoms))
        if held > 1:
            self._possible = False
        if held:
            self._never |= bits
        elif group.needed:
            self._needed.append(bits)
        for bit in _each(bits):
            self._rivals[bit] |= bits & ~bit

    def _take_in_clause(self, clause: Clause) -> None:
        positive = negative = 0
        for literal in clause:
            bit = self._bit.get(literal.atom)
            if bit is None:
                if literal.positive == (literal.atom in self._certain):
                    return
            elif literal.positive:
                positive |= bit
            else:
                negative |= bit
        self._clauses.append((positive, negative))

    def bits(self, atoms: Iterable[Atom]) -> int:
        """Some facts as bits; those that are not among the variables' are left out."""
        bits = 0
        for atom in atoms:
            bits |= self._bit.get(atom, 0)
        return bits

    def state(self, bits: int) -> State:
        """The state that bits stand for, with what is certain."""
        return self._certain.union(self.atoms[bit.bit_length() - 1] for bit in _each(bits))

    def best(
        self,
        scores: Mapping[Atom, float],
        most: int,
        *,
        factors: Sequence[Factor] = (),
        within: float = inf,
        nodes: int = NODES,
    ) -> Found:
        """The states of the highest score.

        Args:
            scores: Of each fact, where it holds; 0 where none is given.
            most: How many states.
            factors: Further scores, of several facts at once.
            within: By how much a score may be lower than the highest.
            nodes: Partial states to look into before giving up.
        """
        if not self._possible:
            return Found((), True)
        ranked = [(needed, bits, self._ranked(bits, scores)) for needed, bits in self._variables]
        number = count()
        waiting: list[tuple[float, int, int, int, int]] = []

        def push(depth: int, true: int, false: int, fresh: int = 0) -> None:
            settled = self._settled(true, false, fresh)
            if settled is not None:
                bound = _bound(ranked, factors, *settled)
                # Of equal ones the deepest first: else nothing is found where all is alike.
                heappush(waiting, (-round(bound, 9), -depth, next(number), *settled))

        push(0, 0, self._never)
        found: list[tuple[int, float]] = []
        complete = False
        for _ in range(nodes):
            if not waiting or (found and -waiting[0][0] < found[0][1] - within):
                complete = True
                break
            if len(found) >= most:
                break
            score, depth, _, true, false = heappop(waiting)
            choice = _choice(ranked, true, false)
            if choice is None:
                if self._is_kept(true):
                    found.append((true, -score))
                continue
            needed, options = choice
            others = 0
            for bit in options:
                push(1 - depth, true | bit, false | others, bit)
                others |= bit
            if not needed:
                push(1 - depth, true, false | others)
        return Found(tuple(found), complete or not waiting)

    def allows(self, bits: int) -> bool:
        """Whether a whole state keeps all constraints."""
        rest = (1 << len(self.atoms)) - 1 & ~bits
        if not self._possible or self._settled(bits, rest | self._never, bits) is None:
            return False
        return self._is_kept(bits)

    def _ranked(self, bits: int, scores: Mapping[Atom, float]) -> list[tuple[float, int]]:
        options = [(scores.get(self.atoms[bit.bit_length() - 1], 0.0), bit) for bit in _each(bits)]
        return sorted(options, key=lambda option: (-option[0], option[1]))

    def _is_kept(self, bits: int) -> bool:
        if self._keeps is None:
            return True
        if bits not in self._kept:
            self._kept[bits] = self._keeps(self.state(bits))
        return self._kept[bits]

    def _settled(self, true: int, false: int, fresh: int) -> tuple[int, int] | None:
        """What follows from a partial state and its latest facts; None where none is like it."""
        while True:
            for bit in _each(fresh):
                false |= self._rivals[bit]
            before = true, false
            if true & false:
                return None
            for group in self._needed:
                free = group & ~false
                if not free:
                    return None
                if not free & (free - 1):
                    true |= free
            for positive, negative in self._clauses:
                if positive & true or negative & false:
                    continue
                yes, no = positive & ~false, negative & ~true
                if not yes and not no:
                    return None
                if not no and not yes & (yes - 1):
                    true |= yes
                elif not yes and not no & (no - 1):
                    false |= no
            if (true, false) == before:
                return before
            fresh = true & ~before[0]


def _bound(
    ranked: Sequence[tuple[bool, int, Sequence[tuple[float, int]]]],
    factors: Sequence[Factor],
    true: int,
    false: int,
) -> float:
    """The highest score that a partial state may come to; exact where it is whole."""
    total = 0.0
    for needed, bits, options in ranked:
        held = bits & true
        if held:
            total += next(score for score, bit in options if bit & held)
            continue
        free = next((score for score, bit in options if not bit & false), 0.0)
        total += free if needed else max(free, 0.0)
    for bits, score in factors:
        if bits & true:
            total += score
        elif bits & ~false:
            total += max(score, 0.0)
    return total


def _choice(
    ranked: Sequence[tuple[bool, int, Sequence[tuple[float, int]]]], true: int, false: int
) -> tuple[bool, list[int]] | None:
    """The variable whose best option is furthest ahead: whether it is needed, what is free."""
    widest, chosen = -1.0, None
    for needed, bits, options in ranked:
        if bits & true:
            continue
        free = [option for option in options if not option[1] & false]
        if not free:
            continue
        values = [score for score, _ in free[:2]]
        if not needed:
            values = sorted([*values, 0.0], reverse=True)
        gap = values[0] - values[1] if len(values) > 1 else 0.0
        if gap > widest:
            widest, chosen = gap, (needed, [bit for _, bit in free])
    return chosen


def _each(bits: int) -> Iterator[int]:
    while bits:
        bit = bits & -bits
        yield bit
        bits ^= bit
