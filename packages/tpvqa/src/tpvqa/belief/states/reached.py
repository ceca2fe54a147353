"""Every state that actions lead to, where there are few enough to be listed.

What is listed is exact: also where effects are conditional, of which invariants say little, each
state is one that can come about, and facts that hold together in none of them exclude each other.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import inf
from random import Random

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.states.likeliest import Factor, Found
from tpvqa.belief.states.mutexes import Mutexes
from tpvqa.pddl import Action, Atom, Condition, Conjunction, Literal, State, Task

MOST = 200_000
"""States beyond which they are not listed."""
WORK = 60_000_000
"""States times effects of actions beyond which they are not listed; about a second."""

Truths = NDArray[np.bool_]
"""A row a state, a column a fact."""
Test = Callable[[Truths], Truths]


@dataclass(frozen=True, eq=False)
class Reached:
    """The states that actions lead to from a task's initial state.

    It offers what `Likeliest` does, and exact probabilities.

    Attributes:
        atoms: The facts that hold in some of the states and not in others, in alphabetical order.
        certain: What holds in all of them.
        truths: Which of `atoms` hold, shape (states, atoms).
    """

    atoms: tuple[Atom, ...]
    certain: State
    truths: Truths

    def bits(self, atoms: Iterable[Atom]) -> int:
        """Some facts as bits; those that are not among `atoms` are left out."""
        return sum({1 << self._place[atom] for atom in atoms if atom in self._place})

    def state(self, bits: int) -> State:
        """The state that bits stand for, with what is certain."""
        return self.certain.union(a for place, a in enumerate(self.atoms) if bits >> place & 1)

    def allows(self, bits: int) -> bool:
        """Whether a state is among them."""
        wanted = np.array([bits >> place & 1 for place in range(len(self.atoms))], dtype=np.bool_)
        return bool((self.truths == wanted).all(axis=1).any())

    def best(
        self,
        scores: Mapping[Atom, float],
        most: int,
        *,
        factors: Sequence[Factor] = (),
        within: float = inf,
    ) -> Found:
        """The states of the highest score; arguments as those of `Likeliest.best`."""
        totals = self._totals(scores, factors)
        near = np.flatnonzero(totals >= totals.max() - within)
        chosen = near[np.argsort(-totals[near], kind="stable")[:most]]
        return Found(
            tuple((self._bits_of(row), float(totals[row])) for row in chosen.tolist()),
            len(near) <= most,
        )

    def chances(
        self, scores: Mapping[Atom, float], factors: Sequence[Factor] = ()
    ) -> NDArray[np.float64]:
        """The probability of each state, shape (states,); arguments as those of `best`."""
        totals = self._totals(scores, factors)
        weights = np.exp(totals - totals.max())
        found: NDArray[np.float64] = weights / weights.sum()
        return found

    def drawn(self, chances: NDArray[np.float64], random: Random) -> State:
        """One of the states, each as often as it is probable."""
        (row,) = random.choices(range(len(self.truths)), chances.tolist())
        return self.state(self._bits_of(row))

    def holding(self, atoms: Iterable[Atom]) -> Truths:
        """In which states any of some facts holds, shape (states,)."""
        atoms = set(atoms)
        if atoms & self.certain:
            return np.ones(len(self.truths), dtype=np.bool_)
        columns = [self._place[atom] for atom in atoms if atom in self._place]
        if len(columns) == 1:
            return np.asarray(self.truths[:, columns[0]])
        return np.asarray(self.truths[:, columns].any(axis=1))

    def mutexes(self) -> Mutexes:
        """The pairs of its facts that hold together in no state."""
        held = self.truths.astype(np.float32)
        first, second = np.nonzero(np.triu(held.T @ held == 0, 1))
        return Mutexes(
            frozenset(
                frozenset((self.atoms[one], self.atoms[other]))
                for one, other in zip(first.tolist(), second.tolist(), strict=True)
            )
        )

    def _totals(
        self, scores: Mapping[Atom, float], factors: Sequence[Factor]
    ) -> NDArray[np.float64]:
        totals: NDArray[np.float64] = self.truths @ np.array(
            [scores.get(atom, 0.0) for atom in self.atoms]
        )
        for bits, score in factors:
            columns = [place for place in range(len(self.atoms)) if bits >> place & 1]
            totals += score * self.truths[:, columns].any(axis=1)
        return totals

    def _bits_of(self, row: int) -> int:
        return sum(1 << place for place in np.flatnonzero(self.truths[row]).tolist())

    @property
    def _place(self) -> dict[Atom, int]:
        return _places(self.atoms)


@lru_cache(maxsize=8)
def _places(atoms: tuple[Atom, ...]) -> dict[Atom, int]:
    return {atom: place for place, atom in enumerate(atoms)}


@lru_cache(maxsize=4)
def reached(task: Task, *, most: int = MOST, work: int = WORK) -> Reached | None:
    """The states that a task's actions lead to from its initial one.

    Args:
        task: The task.
        most: How many states there may be.
        work: How many states times effects may be looked at.

    Returns:
        None where there are more, where facts are left open or derived, or where none changes.
    """
    if task.axioms or task.left_open:
        return None
    fluent = {atom for atom in task.atoms() | task.init if atom.predicate in task.fluents}
    atoms = tuple(sorted(fluent))
    if not atoms:
        return None
    place = {atom: number for number, atom in enumerate(atoms)}
    steps = [_Step.of(action, task, place) for action in task.ground_actions()]
    each = sum(1 + len(step.effects) for step in steps)
    front = np.array([[atom in task.init for atom in atoms]], dtype=np.bool_)
    seen = _keys(front)
    while len(front):
        if len(seen) > most or len(seen) * each > work:
            return None
        after = [led for step in steps if len(led := step.leads_to(front))]
        if not after:
            break
        every = np.concatenate(after)
        keys, first = np.unique(_keys(every), return_index=True)
        new = ~np.isin(keys, seen)
        front = every[first[new]]
        seen = np.concatenate([seen, keys[new]])
    words = np.sort(seen).view(np.uint8).reshape(len(seen), -1)
    truths = np.unpackbits(words, axis=1, count=len(atoms)).astype(np.bool_)
    always, never = truths.all(axis=0), ~truths.any(axis=0)
    open_ = np.flatnonzero(~always & ~never).tolist()
    certain = task.static | {atoms[number] for number in np.flatnonzero(always).tolist()}
    return Reached(tuple(atoms[n] for n in open_), certain, np.asfortranarray(truths[:, open_]))


def _keys(states: Truths) -> NDArray[np.void]:
    """Each row as one value that can be sorted and compared."""
    packed = np.ascontiguousarray(np.packbits(states, axis=1))
    return packed.view(np.dtype((np.void, packed.shape[1]))).ravel()


@dataclass(frozen=True, slots=True)
class _Step:
    """An action on many states at once.

    Attributes:
        possible: Where it can be done.
        effects: When each is had, the column it changes, and to what; deletions come first.
    """

    possible: Test
    effects: tuple[tuple[Test, int, bool], ...]

    @staticmethod
    def of(action: Action, task: Task, place: Mapping[Atom, int]) -> "_Step":
        effects = [
            (_test(each.condition, task, place), place[each.literal.atom], each.literal.positive)
            for each in action.effects
            if each.literal.atom in place  # else it never holds
        ]
        return _Step(
            _test(action.precondition, task, place),
            tuple(sorted(effects, key=lambda effect: effect[2])),
        )

    def leads_to(self, states: Truths) -> Truths:
        before = states[self.possible(states)]
        after = before.copy()
        for when, column, value in self.effects:
            after[when(before), column] = value
        return after


def _test(condition: Condition, task: Task, place: Mapping[Atom, int]) -> Test:
    """A condition as a test of many states."""
    if isinstance(condition, Literal):
        column, positive = place.get(condition.atom), condition.positive
        if column is None:
            value = condition.holds(task.static)
            return lambda states: np.full(len(states), value)
        if positive:
            return lambda states: states[:, column]
        return lambda states: ~states[:, column]
    parts = [_test(part, task, place) for part in condition.parts]
    if isinstance(condition, Conjunction):
        return lambda states: _joined(states, parts, True)
    return lambda states: _joined(states, parts, False)


def _joined(states: Truths, parts: Sequence[Test], every: bool) -> Truths:
    found = np.full(len(states), every)
    for part in parts:
        found = found & part(states) if every else found | part(states)
    return found
