"""Pairs of facts that never hold together, where the planner's invariants do not say so.

Haslum and Geffner, "Admissible Heuristics for Optimal Planning" (AIPS 2000): h² reaches a pair of
atoms when a transition adds one and keeps the other, or adds both. What is never reached is mutex.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.states.disturbances import reaching
from tpvqa.belief.states.transitions import Transition, of_action
from tpvqa.pddl import Atom, Task

LIMIT = 50_000_000
"""Atoms times transitions; 6 MB of bits, some seconds."""

Bits = NDArray[np.uint64]


@dataclass(frozen=True, slots=True)
class Mutexes:
    """What h² proves.

    Attributes:
        pairs: Pairs of atoms that never hold together.
        never: Atoms that never hold although they look reachable where nothing is undone; no pair
            speaks of them.
        gave_up: Why nothing was proved; empty where the search was made.
    """

    pairs: frozenset[frozenset[Atom]] = frozenset()
    never: frozenset[Atom] = frozenset()
    gave_up: str = ""


def h2_mutexes(task: Task, further: Iterable[Transition] = (), *, limit: int = LIMIT) -> Mutexes:
    """The pairs of atoms that no sequence of actions and further transitions makes true together.

    Sound for all PDDL that is read here: negative, disjunctive and derived conditions are taken to
    hold, conditional effects to add and not to delete. Derived atoms are in no pair.

    Args:
        task: Gives the initial state and the actions.
        further: What can happen besides actions (see `disturbances`). The pairs hold under these;
            under anything else that befalls the world they need not.
        limit: Atoms times transitions beyond which it gives up.

    Raises:
        PlannerError: Further transitions open up new actions, and grounding those failed.
    """
    further = tuple(further)
    wider = reaching(task, further)
    found = wider.atoms() | wider.init
    atoms = sorted(a for a in found if a.predicate in task.fluents - task.derived)
    index = {atom: number for number, atom in enumerate(atoms)}
    actions = wider.ground_actions()
    if (size := len(atoms) * (len(actions) + len(further))) > limit:
        return Mutexes(
            gave_up=f"{len(atoms):,} atoms × {len(actions) + len(further):,} transitions are "
            f"{size:,}, more than the limit of {limit:,}"
        )
    transitions = [of_action(action, task) for action in actions]
    able = [t for t in (*transitions, *further) if t.needed | t.earlier <= index.keys()]
    together = _together(able, index, _at_first(task, index))
    possible = together.diagonal()
    first, second = np.nonzero(np.triu(~together & possible & possible[:, None]))
    return Mutexes(
        frozenset(
            frozenset((atoms[one], atoms[other]))
            for one, other in zip(first.tolist(), second.tolist(), strict=True)
        ),
        frozenset(atoms[number] for number in np.flatnonzero(~possible).tolist()),
    )


def _at_first(task: Task, index: Mapping[Atom, int]) -> NDArray[np.bool_]:
    """Whether two atoms may hold together initially, what the problem leaves open counted in."""
    first = task.left_open | task.besides
    holding = [index[atom] for atom in task.init | first if atom in index]
    together = np.zeros((len(index), len(index)), dtype=np.bool_)
    together[np.ix_(holding, holding)] = True
    if first:
        for group in (*task.oneof, *(each.atoms for each in task.mutex_groups)):
            members = [index[atom] for atom in group if atom in index]
            own = together.diagonal()[members].copy()
            together[np.ix_(members, members)] = False
            together[members, members] = own
    return together


def _together(
    transitions: Sequence[Transition], index: Mapping[Atom, int], together: NDArray[np.bool_]
) -> NDArray[np.bool_]:
    """Whether two atoms hold together in some state; on the diagonal, whether one ever holds.

    Args:
        transitions: What can happen.
        index: The number of each atom.
        together: Whether two atoms may hold together initially, shape (atoms, atoms).
    """
    size = len(index)
    added = _numbers((t.added for t in transitions), index)
    adding = _packed(_table(added, size))
    kept = ~_packed(_table(_numbers((t.deleted for t in transitions), index), size))
    needed = _padded(_numbers((t.needed for t in transitions), index), size)
    earlier = _padded(_numbers((t.earlier for t in transitions), index), size)
    which = np.repeat(np.arange(len(added)), [len(numbers) for numbers in added])
    what = np.array([number for numbers in added for number in numbers], dtype=np.intp)
    order = np.argsort(what, kind="stable")
    heads, starts = np.unique(what[order], return_index=True)
    while len(heads):
        # The last row stands for "needs nothing": every atom that ever holds fits it.
        possible = np.append(together.diagonal(), True)
        rows = _packed(np.vstack([together, possible[:size]]))
        fitting = np.bitwise_and.reduce(rows[needed], axis=1)
        able = _all_in(fitting, needed, size) & possible[earlier].all(axis=1)
        after = np.where(able[:, None], fitting & kept | adding, np.uint64(0))
        rows[heads] |= np.bitwise_or.reduceat(after[which[order]], starts, axis=0)
        reached = _unpacked(rows[:size], size)
        reached |= reached.T.copy()
        if np.array_equal(reached, together):
            break
        together = reached
    return together


def _numbers(sets: Iterable[Iterable[Atom]], index: Mapping[Atom, int]) -> list[list[int]]:
    return [[index[atom] for atom in atoms if atom in index] for atoms in sets]


def _padded(members: Sequence[Sequence[int]], size: int) -> NDArray[np.intp]:
    width = max((len(numbers) for numbers in members), default=0)
    padded = np.full((len(members), max(1, width)), size, dtype=np.intp)
    for row, numbers in zip(padded, members, strict=True):
        row[: len(numbers)] = numbers
    return padded


def _all_in(sets: Bits, members: NDArray[np.intp], size: int) -> NDArray[np.bool_]:
    """Whether each set holds all of its row of members; the number past the last always."""
    real = np.minimum(members, size - 1)
    words = np.take_along_axis(sets, real // 64, axis=1)
    inside = (words >> (real % 64).astype(np.uint64)) & np.uint64(1)
    found: NDArray[np.bool_] = np.all((inside == 1) | (members == size), axis=1)
    return found


def _table(members: Sequence[Sequence[int]], size: int) -> NDArray[np.bool_]:
    table = np.zeros((len(members), size), dtype=np.bool_)
    for row, numbers in zip(table, members, strict=True):
        row[list(numbers)] = True
    return table


def _packed(table: NDArray[np.bool_]) -> Bits:
    """Rows as bits, in whole words."""
    octets = np.packbits(table, axis=1, bitorder="little")
    padded = np.zeros((len(table), -(-table.shape[1] // 64) * 8), dtype=np.uint8)
    padded[:, : octets.shape[1]] = octets
    return padded.view("<u8").astype(np.uint64, copy=False)


def _unpacked(rows: Bits, size: int) -> NDArray[np.bool_]:
    octets = rows.astype("<u8", copy=False).view(np.uint8)
    bits = np.unpackbits(octets, axis=1, count=size, bitorder="little")
    table: NDArray[np.bool_] = bits != 0
    return table
