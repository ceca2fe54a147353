"""The nearest consistent state: what a change breaks is repaired by the fewest further changes."""

from collections.abc import Collection, Mapping, Sequence
from heapq import heappop, heappush

from tpvqa.belief.states.constraints import Constraints
from tpvqa.errors import BeliefError, ContradictionError
from tpvqa.pddl import Atom, State

MOST = 20_000
"""Repairs that are looked into for one state: a second or two."""

Facts = Mapping[Atom, bool]
"""Some facts, each to hold or not to."""


class Nearest:
    """Finds the consistent states that differ from a state in the fewest facts.

    A group of which two facts hold, or none although one must, is repaired in every way there is:
    one of those that hold stays, or none does; one of those that do not comes in. What has been
    decided stays so, and the fewest changes are looked into first (Dijkstra 1959), so the first
    state that keeps all constraints is a nearest one: exact, however many facts there are.

    Of equally near states it is always the same one, whatever the order of the arguments: groups
    with the fewest repairs are repaired first, facts in alphabetical order.

    Args:
        constraints: What can hold together.
        state: The state. It need not be consistent itself.
        can_hold: Facts that may come in although `constraints` takes them to be unreachable.
        most: Repairs to look into before giving up.
    """

    def __init__(
        self,
        constraints: Constraints,
        state: State,
        can_hold: Collection[Atom] = (),
        *,
        most: int = MOST,
    ):
        self._constraints, self._state, self._most = constraints, state, most
        self._barred = constraints.unreachable.difference(can_hold)
        self._violated = constraints.violated(state)
        self._held: dict[int, list[Atom]] = {}

    def where(self, wish: Facts) -> State:
        """The nearest consistent state in which some facts are as they are wished to be.

        Raises:
            ContradictionError: There is none.
            BeliefError: None was found among the repairs that were looked into.
        """
        waiting: list[tuple[int, tuple[int, ...], Facts]] = [(0, (), wish)]
        for _ in range(self._most):
            if not waiting:
                raise ContradictionError(f"no consistent state has {_said(wish)}")
            _, path, decided = heappop(waiting)
            repairs = self._repairs(decided)
            if repairs is None:
                return self._state.symmetric_difference(self._changed(decided))
            for number, repair in enumerate(repairs):
                after = {**decided, **repair}
                heappush(waiting, (len(self._changed(after)), (*path, number), after))
        raise BeliefError(f"{self._most:,} repairs do not make {_said(wish)} consistent")

    def _changed(self, decided: Facts) -> list[Atom]:
        return [atom for atom, holds in decided.items() if holds != (atom in self._state)]

    def _repairs(self, decided: Facts) -> Sequence[Facts] | None:
        """All ways to repair a violated group, the one with the fewest; None where none is.

        Args:
            decided: What stays as it is: what was wished for, and the repairs so far.
        """
        groups, added = set(self._violated), dict[int, list[Atom]]()
        for atom in self._changed(decided):
            for number in self._constraints.groups_of.get(atom, ()):
                groups.add(number)
                if decided[atom]:
                    added.setdefault(number, []).append(atom)
        found = (
            self._repairs_of(number, decided, added.get(number, []))
            for number in sorted(groups, reverse=True)
        )
        return min((each for each in found if each is not None), key=len, default=None)

    def _repairs_of(
        self, number: int, decided: Facts, added: Sequence[Atom]
    ) -> Sequence[Facts] | None:
        """All ways to repair a group; None where nothing is wrong with it."""
        group = self._constraints.groups[number]
        held = self._held.get(number)
        if held is None:
            held = self._held[number] = [atom for atom in group.atoms if atom in self._state]
        held = [*(atom for atom in held if decided.get(atom, True)), *added]
        if len(held) > 1:
            sure = [atom for atom in held if decided.get(atom)]
            if len(sure) > 1:
                return []
            staying: list[Atom | None] = [*sure] or [*held, None]
            return [{atom: atom == kept for atom in held} for kept in staying]
        if held or not group.needed:
            return None
        return [
            {atom: True} for atom in group.atoms if atom not in decided and atom not in self._barred
        ]


def _said(wish: Facts) -> str:
    return ", ".join(str(atom) if holds else f"not {atom}" for atom, holds in wish.items())
