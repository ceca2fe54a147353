"""What shows of an action whose doings nothing shows: what else it does."""

from collections.abc import Iterator

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.sight import Sight
from tpvqa.pddl import Action, Atom

DOUBT = 0.05
"""What is less probable than this, or its contrary, is not asked about by what goes with it."""


class Telltales:
    """Effects that can be seen of the actions that were done, by those that cannot.

    That a parcel is booked no camera shows; that it bears the label that the same action puts on
    it does.

    Args:
        sight: What can be seen.
    """

    def __init__(self, sight: Sight):
        self._sight = sight
        self._shown: dict[Atom, frozenset[Atom]] = {}

    def acted(self, action: Action) -> None:
        """Note that an action is done."""
        changes = {effect.literal.atom for effect in action.effects}
        shown = frozenset(filter(self._sight.sees, changes))
        for hidden in changes - shown if shown else ():
            self._shown[hidden] = self._shown.get(hidden, frozenset()) | shown

    def of(self, belief: Belief, needed: frozenset[Atom]) -> frozenset[Atom]:
        """What can be seen and tells of what is needed and in doubt.

        Args:
            belief: Says what is in doubt.
            needed: The facts that the plans need.
        """
        return frozenset[Atom]().union(*self._telling(belief, needed))

    def _telling(self, belief: Belief, needed: frozenset[Atom]) -> Iterator[frozenset[Atom]]:
        for hidden in needed & self._shown.keys():
            if DOUBT < belief.probability(hidden) < 1 - DOUBT:
                yield self._shown[hidden]
