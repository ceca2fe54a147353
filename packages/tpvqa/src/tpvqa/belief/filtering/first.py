"""What may be the case before anything was done, and how probable that is."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import exp, fsum, log, prod
from random import Random
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.answers.weighed import Instead
from tpvqa.belief.filtering.belief import MOST, SMALLEST
from tpvqa.belief.filtering.priors import Priors
from tpvqa.belief.states.constraints import Constraints, Group
from tpvqa.belief.states.disturbances import disturbances
from tpvqa.belief.states.likeliest import Factor, Found, Likeliest, Variable
from tpvqa.belief.states.mutexes import h2_mutexes
from tpvqa.belief.states.origins import Origins
from tpvqa.belief.states.reached import Reached, reached
from tpvqa.errors import BeliefError, PlannerError
from tpvqa.pddl import Atom, State, Task

LEAST = 1e-6
"""What is left to facts where others of their group were given all."""
TAIL = 1e-3
"""The last state that is kept has at most this share of the first one's probability, or more is to
be found out before the rest may be forgotten."""
TRIES = 2_000
"""Draws of an initial state before one of the most probable ones is taken."""

Floats = NDArray[np.float64]


class Prior:
    """How probable each initial state is: its facts' own probabilities, given all constraints.

    The facts of one mutex group are one choice. A state's probability is the product of those of
    its choices, among the states that are possible: they violate no mutex group, no h² mutex and
    nothing of what `oneof` and `or` say. Answers weigh it as they weigh a belief, but no state is
    looked at before somebody asks for the most probable ones.

    Where nothing is known, those states are possible that can have come about from the problem's
    own initial state: exactly those where they can be listed (see `reached`), else as far as
    `Origins` can tell.

    Args:
        task: The task.
        priors: What is said of its facts besides.
        undo: What disturbances can undo, as a world file says.

    Raises:
        BeliefError: No state is possible.
    """

    def __init__(self, task: Task, priors: Priors | None = None, undo: Sequence[Any] = ()):
        self.task = task
        self._choices, self._search = _space(task, priors or Priors(), tuple(undo))
        self._choice_of = {a: each for each in self._choices for a in each.variable.atoms}
        self._scores = {a: each.score(a) for a, each in self._choice_of.items()}
        self._factors: dict[tuple[Atom, ...], float] = {}
        self._found: Found | None = None
        self._chances: Floats | None = None

    @property
    def atoms(self) -> tuple[Atom, ...]:
        """The facts that may hold or not."""
        return self._search.atoms

    @property
    def combinations(self) -> float:
        """How many states there are, or were if all choices were free."""
        if isinstance(self._search, Reached):
            return len(self._search.truths)
        return prod(len(e.variable.atoms) + (not e.variable.needed) for e in self._choices)

    def see(self, atoms: tuple[Atom, ...], if_true: float, if_false: float) -> float:
        """Weigh by an answer, as `Belief.see` does.

        Returns:
            How probable it was, as far as one choice tells.
        """
        probable = self.probability(atoms[0], atoms[1:])
        ratio = log(max(if_true, 1e-12)) - log(max(if_false, 1e-12))
        known = [atom for atom in atoms if atom in self._scores]
        if len(known) == 1:
            self._scores[known[0]] += ratio
        elif known:
            self._factors[tuple(known)] = self._factors.get(tuple(known), 0.0) + ratio
        self._found = None
        if isinstance(self._search, Reached) and self._chances is not None:
            odds = np.where(self._search.holding(atoms), max(if_true, 1e-12), max(if_false, 1e-12))
            self._chances = _shares(self._chances * odds)
        return probable * if_true + (1 - probable) * if_false

    def open(self, atoms: tuple[Atom, ...], chance: float, instead: Instead | None = None) -> int:
        """All that is possible is taken in already.

        Returns:
            0.
        """
        return 0

    def probability(self, atom: Atom, alike: Iterable[Atom] = ()) -> float:
        """How probable a fact is, or any alike, as far as its own choice tells.

        What follows from other choices is not in it, unless the states are listed.
        """
        if isinstance(self._search, Reached):
            holding = self._search.holding((atom, *alike))
            return min(1.0, float(self._listed(self._search)[holding].sum()))
        none = 1.0
        for each in (atom, *alike):
            if each in self._scores:
                none *= 1 - self._choice_of[each].probability(each, self._scores)
            elif each in self._search.state(0):
                return 1.0
        return 1 - none

    def states(self, most: int = MOST) -> list[tuple[State, float]]:
        """The most probable states and their shares of each other, the most probable first."""
        found = self._best(most).states
        highest = found[0][1]
        weights = [exp(score - highest) for _, score in found]
        total = fsum(weights)
        return [
            (self._search.state(bits), weight / total)
            for (bits, _), weight in zip(found, weights, strict=True)
        ]

    def covered(self, most: int = MOST) -> bool:
        """Whether so many states are all there are, or what comes after them hardly counts."""
        found = self._best(most)
        if found.complete:
            return True
        return len(found.states) >= most and found.states[-1][1] - found.states[0][1] < log(TAIL)

    def spread(self) -> float:
        """So many states would have the same weight each (Simpson's index, inverted)."""
        return 1 / fsum(weight * weight for _, weight in self.states())

    def _listed(self, states: Reached) -> Floats:
        if self._chances is None:
            self._chances = states.chances(self._scores, self._weighed())
        return self._chances

    def _weighed(self) -> list[Factor]:
        return [(self._search.bits(atoms), ratio) for atoms, ratio in self._factors.items()]

    def _best(self, most: int) -> Found:
        if self._found is None or not (self._found.complete or len(self._found.states) >= most):
            self._found = self._search.best(
                self._scores, most, factors=self._weighed(), within=-log(SMALLEST)
            )
            if not self._found.states:  # too many nearly equal ones: none of them was reached
                one = self._search.best({}, 1)
                self._found = Found(one.states, complete=False)
        return Found(self._found.states[:most], self._found.complete)

    def drawn(self, random: Random) -> State:
        """One of the possible states, each as often as it is probable.

        Exact where they are listed, where there are at most `MOST`, or where one of `TRIES` draws
        of all choices is possible; else one of the most probable ones.
        """
        if isinstance(self._search, Reached):
            return self._search.drawn(self._listed(self._search), random)
        if not self._best(MOST).complete:
            for _ in range(TRIES):
                bits = self._search.bits(
                    atom for each in self._choices if (atom := each.drawn(random)) is not None
                )
                if self._search.allows(bits):
                    return self._search.state(bits)
        states = self.states()
        (state,) = random.choices([s for s, _ in states], [weight for _, weight in states])
        return state


def _shares(weights: Floats) -> Floats | None:
    """Weights as shares of their sum; None where it is too small to tell."""
    total = float(weights.sum())
    return weights / total if total > 1e-200 else None


@lru_cache(maxsize=4)
def _space(
    task: Task, priors: Priors, undo: tuple[Any, ...]
) -> "tuple[tuple[_Choice, ...], Likeliest | Reached]":
    """The choices there are and what keeps them together; shared by trials one after the other."""
    if priors.nothing_known and not undo and (listed := reached(task)) is not None:
        return _choices_among(listed, task, priors), listed
    fluents = task.fluents - task.derived
    constraints, further, never = _constraints(task, undo)
    can_hold = {a for a in task.atoms() | task.init if a.predicate in fluents} - never
    stated = priors.stated(can_hold, task)
    if priors.nothing_known:
        opened = frozenset(can_hold)
    else:
        opened = task.left_open & can_hold | stated.keys()
        for group in constraints.exactly_one:
            if group & stated.keys():  # then what the problem says of it is not sure either
                opened |= group & task.init
    named = () if priors.nothing_known else task.oneof
    said = frozenset() if priors.nothing_known else task.init - task.left_open
    certain = task.init - opened
    choices = tuple(
        _Choice.of(variable, stated, said)
        for variable in _variables(opened, named, constraints, certain)
    )
    search = Likeliest(
        [each.variable for each in choices],
        [*constraints.groups, *(Group(tuple(sorted(each)), True) for each in named)],
        () if priors.nothing_known else task.clauses,
        certain=certain,
        keeps=Origins(task, further) if priors.nothing_known else None,
    )
    if not (search.allows(search.bits(task.init)) or search.best({}, 1).states):
        raise BeliefError(
            "no initial state was found that keeps the mutex groups, what the problem leaves open "
            "and what the priors say is certain; make one of them less sure"
        )
    return choices, search


def _choices_among(listed: Reached, task: Task, priors: Priors) -> "tuple[_Choice, ...]":
    constraints = Constraints.of(task, listed.mutexes().pairs)
    stated = priors.stated(listed.atoms, task)
    variables = _variables(listed.atoms, (), constraints, listed.certain)
    return tuple(_Choice.of(variable, stated, frozenset()) for variable in variables)


def _constraints(
    task: Task, undo: Sequence[Any]
) -> tuple[Constraints, Sequence[Any], frozenset[Atom]]:
    """What every possible state keeps, what can happen besides actions, and what never holds."""
    try:
        further = tuple(disturbances(task, undo)) if undo else ()
        found = h2_mutexes(task, further)
        kept = Constraints.of(task, found.pairs, never=found.never, further=further)
        return kept, further, found.never
    except (PlannerError, AttributeError):  # rules of another kind than a world file's
        return Constraints.of(task), (), frozenset()


def _variables(
    opened: Collection[Atom],
    named: Sequence[frozenset[Atom]],
    constraints: Constraints,
    certain: State,
) -> Iterator[Variable]:
    """The facts left open, each in one choice: by what the problem names, then by mutex groups.

    Groups about one thing (where it is) go before groups about one place (what is there).
    """
    left = set(opened)
    ranked = [(0, False, -len(group), tuple(sorted(group))) for group in named]
    for kind, groups in ((1, constraints.exactly_one), (2, constraints.at_most_one)):
        ranked += [
            (kind, not _of_one_thing(group), -len(group), tuple(sorted(group))) for group in groups
        ]
    for kind, _, _, atoms in sorted(ranked):
        free = tuple(atom for atom in atoms if atom in left)
        if len(free) < 2:
            continue
        whole = all(atom in left or atom not in opened for atom in atoms)
        yield Variable(free, kind < 2 and whole and certain.isdisjoint(atoms))
        left.difference_update(free)
    for atom in sorted(left):
        yield Variable((atom,), False)


def _of_one_thing(group: Collection[Atom]) -> bool:
    return len({atom.arguments[:1] for atom in group}) == 1


@dataclass(frozen=True, slots=True)
class _Choice:
    """One choice, with the probabilities of what it can come to.

    Attributes:
        variable: Its facts.
        chances: Their probabilities, and at the end that of none of them.
    """

    variable: Variable
    chances: tuple[float, ...]

    @classmethod
    def of(cls, variable: Variable, stated: Mapping[Atom, float], said: State) -> Self:
        """Of what the priors state; the rest goes to what the problem says, else to each alike."""
        options: list[Atom | None] = [*variable.atoms, *([] if variable.needed else [None])]
        given = {a: min(max(stated[a], LEAST), 1.0) for a in variable.atoms if a in stated}
        rest = [each for each in options if each not in given]
        left = max(1 - sum(given.values()), LEAST)
        sure = [each for each in rest if each is not None and each in said]
        chances: dict[Atom | None, float] = dict(given.items())
        for each in rest:
            if sure:
                chances[each] = left if each in sure else LEAST
            else:
                chances[each] = left / len(rest)
        total = sum(chances.values())
        none = LEAST if variable.needed else chances[None]
        return cls(variable, (*(chances[a] / total for a in variable.atoms), none / total))

    def score(self, atom: Atom) -> float:
        """The logarithm of its probability, relative to that of none."""
        own = log(self.chances[self.variable.atoms.index(atom)])
        return own if self.variable.needed else own - log(self.chances[-1])

    def probability(self, atom: Atom, scores: Mapping[Atom, float]) -> float:
        """How probable a fact is by the scores of this choice alone."""
        weights = {each: scores[each] for each in self.variable.atoms}
        highest = max(*weights.values(), 0.0)
        total = fsum(exp(score - highest) for score in weights.values())
        if not self.variable.needed:
            total += exp(-highest)
        return exp(weights[atom] - highest) / total if total else 0.0

    def drawn(self, random: Random) -> Atom | None:
        """One of its facts, or none."""
        options: list[Atom | None] = [*self.variable.atoms, None]
        chances = [*self.chances[:-1], 0.0 if self.variable.needed else self.chances[-1]]
        return random.choices(options, chances)[0]
