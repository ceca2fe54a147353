"""Which steps of a plan have something to do, from many joint states that differ little.

The rest of a plan is gone through once. From any other joint state only those steps are looked at
that touch a fact in which the two differ: a plan of a hundred steps takes some microseconds.
"""

from collections.abc import Sequence
from itertools import accumulate
from operator import or_
from typing import NamedTuple

from tpvqa.belief.states.compiled import Compiled
from tpvqa.pddl import Atom


class _Gone(NamedTuple):
    """How a plan goes from a step on: what holds before every step and in the end, as bits, and
    which steps change something. What comes before that step is empty."""

    first: int
    holding: list[int]
    changes: list[bool]


class Needed:
    """The steps of one plan, done one after the other, whatever comes of them.

    Args:
        steps: They, as masks.

    Attributes:
        fixed: Facts that no action changes; only where all of them hold do the masks tell all.
    """

    def __init__(self, steps: Sequence[Compiled]):
        self._steps = steps
        self.fixed = frozenset[Atom]().union(*(each.fixed for each in steps))
        self._touched = [each.add | each.delete | each.need | each.bar for each in steps]
        self._later = [*accumulate(reversed(self._touched), or_, initial=0)][::-1]
        self._gone: _Gone | None = None

    def walk(self, first: int, holding: int) -> tuple[list[bool], int]:
        """Which steps change something, from one on, and what holds in the end.

        Args:
            first: That step.
            holding: What holds before it, as bits.
        """
        if self._gone is None or self._gone.first > first:
            self._gone = self._go(first, holding)
        _, known, changed = self._gone
        changes, differs = changed[first:], holding ^ known[first]
        for step in range(first, len(self._steps)):
            if not differs & self._later[step]:
                break
            if differs & self._touched[step]:
                before = known[step] ^ differs
                after = _done(self._steps[step], before)
                changes[step - first] = after != before
                differs = after ^ known[step + 1]
        return changes, known[-1] ^ differs

    def _go(self, first: int, holding: int) -> _Gone:
        known, changes = [0] * first + [holding], [False] * first
        for step in self._steps[first:]:
            after = _done(step, holding)
            changes.append(after != holding)
            known.append(after)
            holding = after
        return _Gone(first, known, changes)


def _done(step: Compiled, holding: int) -> int:
    """What holds after a step, which does nothing where it cannot be done."""
    if step.need & ~holding or step.bar & holding:
        return holding
    return holding & ~step.delete | step.add
