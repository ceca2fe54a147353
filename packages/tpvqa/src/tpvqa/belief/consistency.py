"""The most probable state that contradicts nothing, and how close each of its facts was."""

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field
from math import fsum, inf, isfinite

import numpy as np

from tpvqa.belief.choosing import Choice, Solver, Used, choose
from tpvqa.belief.constraints import Constraints, Contradiction
from tpvqa.belief.incidence import Flags, Incidence
from tpvqa.belief.stripping import Weights
from tpvqa.errors import ContradictionError
from tpvqa.pddl import Atom, State

__all__ = ["Consistent", "Constraints", "Contradiction", "least_margin", "most_probable"]

UNASKED = -4.0
"""Log odds of a fact that nobody was asked about: a probability of 0.018."""

SECONDS = 10.0
"""How long CP-SAT may take for one entangled part."""


@dataclass(frozen=True, slots=True)
class Consistent:
    """The most probable consistent state.

    Attributes:
        state: The facts that hold in it, of those that log odds or constraints speak of.
        score: The sum of their log odds. The state's probability is proportional to its exponent.
        margins: For each fact that was asked for, what of the score would be lost if it were the
            other way, in log odds; infinite where it cannot be.
        solver: The heaviest solver that it took: what is entangled goes to `direct` branch and
            bound where it is small, to a minimum-cost `flow` where it is an assignment, and to
            `cp_sat` otherwise.
        proven: Whether no consistent state is more probable; false only where CP-SAT ran out of
            time with a state in hand.
    """

    state: State
    score: float
    margins: Mapping[Atom, float] = field(default_factory=dict)
    solver: Used = "direct"
    proven: bool = True


def most_probable(
    log_odds: Mapping[Atom, float],
    constraints: Constraints,
    *,
    fixed: Mapping[Atom, bool] | None = None,
    margins: Collection[Atom] = (),
    unasked: float = UNASKED,
    solver: Solver = "auto",
    seconds: float = SECONDS,
) -> Consistent:
    """The state of the greatest probability among those that satisfy all constraints.

    Exact: leaves of the constraints' graph are taken off, what stays entangled is branched over
    where it is small, and given to OR-Tools where it is large (exact to a millionth a fact). The
    same arguments in any order give the same state, also where several are equally probable.

    Args:
        log_odds: Of facts, taken to be independent but for the constraints.
        constraints: What can hold together.
        fixed: Facts that are known to hold, or known not to.
        margins: Facts for which to find the margin. Each costs about as much as finding the state
            of the part of the facts that constraints tie it to.
        unasked: Log odds of a fact that a constraint speaks of and `log_odds` do not, so that a
            thing can be where nobody looked. An unreachable one is then impossible.
        solver: `auto`; or `direct`, without OR-Tools; or `cp_sat`, with it all that a constraint
            speaks of.
        seconds: How long CP-SAT may take for one entangled part.

    Raises:
        ContradictionError: What is fixed cannot hold together.
        BeliefError: No state was found in the time allowed.
        MissingExtraError: It is too large and entangled to be found without OR-Tools.
        ValueError: Log odds are not finite; what is certain belongs in `fixed`.
    """
    search = _Search(log_odds, constraints, fixed or {}, unasked, solver, seconds)
    return search.run(margins)


def least_margin(consistent: Consistent, weight: Mapping[Atom, float]) -> Atom | None:
    """The fact to ask about again first: the least margin for what depends on it.

    Args:
        consistent: A state, with the margins of the facts that can be asked about.
        weight: What depends on each fact, in any unit. One without a weight is not worth asking.

    Returns:
        The fact whose margin divided by its weight is least, the first in order where several are;
        None where there is none to ask about whose answer could change anything.
    """
    ratios = [
        (margin / weight[atom], atom)
        for atom, margin in consistent.margins.items()
        if margin < inf and weight.get(atom, 0.0) > 0
    ]
    return min(ratios)[1] if ratios else None


class _Search:
    """The search for one state and its margins."""

    def __init__(
        self,
        log_odds: Mapping[Atom, float],
        constraints: Constraints,
        fixed: Mapping[Atom, bool],
        unasked: float,
        solver: Solver,
        seconds: float,
    ):
        self.constraints, self.fixed, self.unasked = constraints, fixed, unasked
        self.solver, self.seconds = solver, seconds
        self.log_odds = log_odds
        size = len(constraints.atoms)
        self.worth = np.full(size, unasked)
        self.impossible = constraints.barred.copy()
        self.given = np.zeros(size, dtype=np.bool_)
        places = list(map(constraints.numbers.get, log_odds))
        values = np.fromiter(log_odds.values(), dtype=np.float64, count=len(places))
        if not np.isfinite(values).all():
            wrong = next(atom for atom, value in log_odds.items() if not isfinite(value))
            raise ValueError(
                f"the log odds of {wrong} are {log_odds[wrong]}; put what is certain into 'fixed'"
            )
        bound = np.array([-1 if place is None else place for place in places], dtype=np.intp)
        inside = bound >= 0
        self.worth[bound[inside]] = values[inside]
        self.impossible[bound[inside]] = False
        self.free = (
            {}
            if inside.all()
            else {
                atom: value
                for (atom, value), place in zip(log_odds.items(), places, strict=True)
                if place is None
            }
        )
        for atom, holds in fixed.items():
            place = constraints.numbers.get(atom)
            if place is None:
                self.free[atom] = inf if holds else -inf
            else:
                self.impossible[place] = not holds
                self.given[place] = holds

    def run(self, margins: Iterable[Atom]) -> Consistent:
        choice = self._choose(self.constraints.incidence, self.impossible, self.given, self.worth)
        if choice is None:
            raise ContradictionError(self._why())
        atoms = [self.constraints.atoms[number] for number in choice.chosen.tolist()]
        chosen = np.zeros(len(self.worth), dtype=np.bool_)
        chosen[choice.chosen] = True
        atoms += [atom for atom, value in self.free.items() if value > 0]
        return Consistent(
            frozenset(atoms),
            fsum(self.log_odds.get(atom, self.unasked) for atom in atoms),
            {atom: self._margin(atom, chosen) for atom in sorted(set(margins))},
            choice.used,
            choice.proven,
        )

    def _choose(
        self, incidence: Incidence, impossible: Flags, given: Flags, worth: Weights
    ) -> Choice | None:
        weights = np.where(impossible, -inf, worth)
        return choose(incidence, weights, given, solver=self.solver, seconds=self.seconds)

    def _margin(self, atom: Atom, chosen: Flags) -> float:
        if atom in self.fixed:
            return inf
        place = self.constraints.numbers.get(atom)
        if place is None:
            return abs(self.log_odds.get(atom, self.unasked))
        if self.impossible[place]:
            return inf
        members, incidence = self.constraints.parts[self.constraints.part_of[place]]
        flipped = members == place
        worth = self.worth[members]
        other = self._choose(
            incidence,
            self.impossible[members] | (flipped & chosen[place]),
            self.given[members] | (flipped & ~chosen[place]),
            worth,
        )
        if other is None:
            return inf
        return max(0.0, fsum(worth[chosen[members]]) - fsum(worth[other.chosen]))

    def _why(self) -> str:
        held = frozenset(atom for atom, holds in self.fixed.items() if holds)
        denied = self.fixed.keys() - held
        found = [each for each in self.constraints.violated(held) if not each.missing] or [
            Contradiction(tuple(sorted(group)), missing=True)
            for group in self.constraints.exactly_one
            if group - self.constraints.unreachable <= denied
        ]
        if found:
            return "; ".join(map(str, found))
        known = [str(atom) for atom in sorted(held)] + [f"not {atom}" for atom in sorted(denied)]
        return f"what is taken as given leaves no consistent state: {', '.join(known) or 'nothing'}"
