"""The best choice under constraints: leaves first, then what is small, then what is large."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from tpvqa.belief.branching import TooManyBranches, best_choice
from tpvqa.belief.cp_sat import cp_sat_choice
from tpvqa.belief.flow import flow_choice, sides
from tpvqa.belief.incidence import Flags, Incidence, Numbers
from tpvqa.belief.stripping import Infeasible, Stripped, Weights
from tpvqa.errors import BeliefError, MissingExtraError

Solver = Literal["auto", "direct", "cp_sat"]
"""How to choose; `auto` takes what suits."""

Used = Literal["direct", "flow", "cp_sat"]
"""What it took, from the lightest to the heaviest."""

SMALL = 40
"""Entangled members that are left to branch and bound."""

FEW = 300
"""Branches before a heavier solver is asked."""

WORK = 4_000_000
"""Branches times members before giving up where there is none; a few seconds."""


@dataclass(frozen=True, slots=True)
class Choice:
    """What was chosen.

    Attributes:
        chosen: The chosen members, ascending.
        used: The heaviest of the solvers that had a part in it.
        proven: Whether no better choice exists.
    """

    chosen: Numbers
    used: Used = "direct"
    proven: bool = True


def choose(
    incidence: Incidence, weights: Weights, given: Flags, *, solver: Solver, seconds: float
) -> Choice | None:
    """The members whose weights have the greatest sum; None where no choice satisfies all groups.

    Args:
        incidence: The groups.
        weights: What choosing each member is worth; minus infinity where it cannot be.
        given: Members that are chosen whatever they are worth.
        solver: `auto`; or `direct`, without OR-Tools; or `cp_sat`, everything with it.
        seconds: How long each call of CP-SAT may take.

    Raises:
        BeliefError: No choice was found in the time allowed, or it is too large for `direct`.
        MissingExtraError: It is too large to be chosen without OR-Tools, and they are missing.
    """
    if solver == "cp_sat":
        return _all_with_cp_sat(incidence, weights, given, seconds)
    try:
        stripped = Stripped(incidence, weights, given)
    except Infeasible:
        return None
    left = np.unique(stripped.kernel.member)
    choices = []
    for members, part in stripped.kernel.over(left).parts():
        worth = stripped.weights[left[members]]
        choice = _entangled(part, worth, seconds) if solver == "auto" else _branched(part, worth)
        if choice is None:
            return None
        choices.append(Choice(left[members[choice.chosen]], choice.used, choice.proven))
    kernel = np.concatenate([np.empty(0, dtype=np.intp), *(choice.chosen for choice in choices)])
    return Choice(
        np.flatnonzero(stripped.completed(kernel)),
        _heaviest([choice.used for choice in choices]),
        all(choice.proven for choice in choices),
    )


def _heaviest(used: list[Used]) -> Used:
    if "cp_sat" in used:
        return "cp_sat"
    return "flow" if "flow" in used else "direct"


def _entangled(incidence: Incidence, weights: Weights, seconds: float) -> Choice | None:
    if incidence.size <= SMALL:
        try:
            return _branched(incidence, weights, FEW)
        except BeliefError:
            pass  # small, but not easy
    try:
        side = sides(incidence)
        if side is None:
            return _with_cp_sat(incidence, weights, seconds)
        chosen = flow_choice(incidence, weights, side)
        return None if chosen is None else Choice(chosen, "flow")
    except MissingExtraError as missing:
        try:
            return _branched(incidence, weights)
        except BeliefError:
            raise missing from None


def _branched(incidence: Incidence, weights: Weights, limit: int | None = None) -> Choice | None:
    limit = WORK // incidence.size if limit is None else limit
    try:
        members = best_choice(weights.tolist(), incidence.listed(), limit=limit)
    except TooManyBranches:
        raise BeliefError(
            f"{len(weights):,} entangled facts need more than {limit:,} branches; "
            "let OR-Tools choose (solver='auto')"
        ) from None
    return None if members is None else Choice(np.array(members, dtype=np.intp))


def _with_cp_sat(incidence: Incidence, weights: Weights, seconds: float) -> Choice | None:
    found = cp_sat_choice(weights.tolist(), incidence.listed(), seconds=seconds)
    return None if found is None else Choice(np.array(found[0], dtype=np.intp), "cp_sat", found[1])


def _all_with_cp_sat(
    incidence: Incidence, weights: Weights, given: Flags, seconds: float
) -> Choice | None:
    possible = np.flatnonzero((weights > -np.inf) | given)
    within = incidence.over(possible)
    sure = np.flatnonzero(given[possible])
    # A group of its own, of which one must be chosen, for each member that is given.
    groups = len(within.exactly)
    whole = Incidence(
        within.size,
        np.concatenate([within.group, groups + np.arange(len(sure))]),
        np.concatenate([within.member, sure]),
        np.concatenate([within.exactly, np.ones(len(sure), dtype=np.bool_)]),
    )
    worth = np.where(np.isfinite(weights), weights, 0.0)[possible]
    choice = _with_cp_sat(whole, worth, seconds)
    return None if choice is None else Choice(possible[choice.chosen], "cp_sat", choice.proven)
