"""A plan with what each of its steps needs: where in it a state stands.

As PLANEX did with triangle tables (Fikes, Hart and Nilsson 1972): the plan can be gone on with from
its latest step whose needs hold, however the state came about. Needs are regressed through the
rest of the plan (Fritz and McIlraith 2007).
"""

from bisect import bisect
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import accumulate, islice, pairwise
from operator import xor
from typing import overload

from tpvqa.pddl import Action, Atom, Literal, State, Task, literals

Needs = frozenset[Literal]


class AnnotatedPlan:
    """A plan and, for each of its steps and for the goal, the literals that it needs.

    Args:
        task: The task.
        actions: The actions of the plan.
        needs: One set of literals per step and one for the goal, see
            `planning.regression.regress`.
    """

    def __init__(self, task: Task, actions: Sequence[Action], needs: Sequence[Needs]):
        self.task, self.actions, self.needs = task, tuple(actions), _Needs(needs)
        self._atoms = frozenset(each.atom for need in needs for each in need)

    def wanted(self, bits: Callable[[Iterable[Atom]], int]) -> "Wanted":
        """What every step and the goal need, as bits of facts."""
        return Wanted(self.needs, bits)

    def place(self, state: State) -> int | None:
        """The latest step from which on the plan reaches the goal; its length for the goal.

        None where the plan cannot be gone on with from the state.
        """
        if self.task.goal_holds(state):
            return len(self.actions)
        full = self.task.extend(state)
        for left, need in enumerate(reversed(self.needs)):
            if all((each.atom in full) is each.positive for each in need):
                return len(self.actions) - left
        return None

    def remaining(self, state: State) -> int | None:
        """How many actions are left from a state; None where the plan does not help."""
        place = self.place(state)
        return None if place is None else len(self.actions) - place

    def atoms(self, first: int = 0) -> frozenset[Atom]:
        """The facts that the plan needs from a step on, goal included."""
        if not first:
            return self._atoms
        rest = islice(self.needs, first, None)
        return frozenset(each.atom for need in rest for each in need)

    def needing(self, atom: Atom, first: int = 0) -> int | None:
        """The first step from a given one whose action itself rests on a fact.

        The plan's length stands for the goal; None where the rest of the plan does not need it.
        """
        for index in range(first, len(self.needs)):
            if index == len(self.actions):
                resting: Iterable[Literal] = self.needs[index]
            else:
                resting = literals(self.actions[index].precondition)
            if any(each.atom == atom for each in resting):
                return index
        return None


class _Needs(Sequence[Needs]):
    """What the steps of a plan and the goal need, kept as what changes from each to the next: a
    long plan needs much the same at all its steps, and many plans are kept.

    Args:
        needs: Of every step and the goal.
    """

    def __init__(self, needs: Sequence[Needs]):
        self._first, self._last = needs[0], needs[-1]
        # made of tuples, as the difference of two large sets keeps a large set's room
        self._changes = tuple(Needs(tuple(one ^ other)) for one, other in pairwise(needs))

    def __len__(self) -> int:
        return len(self._changes) + 1

    def __iter__(self) -> Iterator[Needs]:
        return accumulate(self._changes, xor, initial=self._first)

    def __reversed__(self) -> Iterator[Needs]:
        return accumulate(reversed(self._changes), xor, initial=self._last)

    @overload
    def __getitem__(self, index: int) -> Needs: ...

    @overload
    def __getitem__(self, index: slice) -> Sequence[Needs]: ...

    def __getitem__(self, index: int | slice) -> Needs | Sequence[Needs]:
        if isinstance(index, slice):
            return list(self)[index]
        if index == -1:
            return self._last
        place = range(len(self))[index]
        return next(islice(self, place, None))


class Wanted:
    """What the steps of a plan and the goal need, as bits of facts, to find a place in it fast.

    A fact is needed by steps one after the other. Where it is not as it has to be, none of them
    can be gone on with.

    Args:
        needs: Of every step and the goal.
        bits: Facts as bits of a number.
    """

    def __init__(self, needs: Sequence[Needs], bits: Callable[[Iterable[Atom]], int]):
        self._steps: list[tuple[int, int]] = []
        self._needed: dict[int, list[int]] = {}
        self._barred: dict[int, list[int]] = {}
        before, needed, barred = Needs(), 0, 0
        for index, need in enumerate(needs):
            for each in need ^ before:
                bit = bits((each.atom,))
                if each.positive:
                    needed ^= bit
                else:
                    barred ^= bit
                if each in need:
                    since = self._needed if each.positive else self._barred
                    since.setdefault(bit, []).append(index)
            self._steps.append((needed, barred))
            before = need

    def latest(self, holding: int) -> int | None:
        """The latest step whose needs are met where some facts hold; None where none is."""
        lacking, index = ~holding, len(self._steps) - 1
        while index >= 0:
            needed, barred = self._steps[index]
            if missing := needed & lacking:  # the lowest bit is that of what is needed first
                begun = self._needed[missing & -missing]
            elif wrong := barred & holding:
                begun = self._barred[wrong & -wrong]
            else:
                return index
            index = begun[bisect(begun, index) - 1] - 1
        return None


class Standing(dict[int, int | None]):
    """Where in a plan states stand, by the number of their facts; None where it is of no use."""

    def __init__(self, wanted: Wanted):
        super().__init__()
        self.wanted = wanted
