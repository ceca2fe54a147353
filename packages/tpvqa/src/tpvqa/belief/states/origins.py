"""Whether a state can have come about from where the problem begins."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.states.transitions import Transition, of_action
from tpvqa.pddl import Action, Atom, Condition, Conjunction, Disjunction, State, Task

MOST = 20_000
"""Actions beyond which nothing is looked into: each thousand take tens of microseconds a state."""


class Origins:
    """Tells states that cannot have come about, such as two blocks each on the other.

    What happened last is undone, and what was undone stays, as the delete relaxation does forwards
    (Bonet and Geffner 2001): from what can have been before, the initial state must be reached. A
    state that fails is out of reach. One that passes need not be within it.

    Args:
        task: Gives the initial state and the actions. With more than `MOST` actions every state
            passes.
        further: What can happen besides actions (see `disturbances`).
    """

    def __init__(self, task: Task, further: Iterable[Transition] = ()):
        fluents = task.fluents - task.derived
        atoms = sorted(atom for atom in task.atoms() | task.init if atom.predicate in fluents)
        self._bit = {atom: 1 << place for place, atom in enumerate(atoms)}
        self._goal = self._words(self._bits(task.init - task.left_open))
        actions = task.ground_actions()
        undoing: set[tuple[int, int]] = set()
        if len(actions) <= MOST:
            undoing = {self._undone(action, task) for action in actions}
            undoing |= {
                (self._bits(each.needed - each.deleted | each.added), self._bits(each.deleted))
                for each in further
            }
        useful = sorted(each for each in undoing if each[1] & ~each[0])
        self._needed = np.array([self._words(needed) for needed, _ in useful])
        self._gone = np.array([self._words(gone) for _, gone in useful])

    def _bits(self, atoms: Iterable[Atom]) -> int:
        bits = 0
        for atom in atoms:
            bits |= self._bit.get(atom, 0)
        return bits

    def _undone(self, action: Action, task: Task) -> tuple[int, int]:
        """What holds after an action, whatever was before; and what may have held before."""
        did = of_action(action, task)
        # Not `did.deleted`: it leaves out what is deleted only at times.
        gone = {each.literal.atom for each in action.effects if not each.literal.positive}
        sure = {
            each.literal.atom
            for each in action.effects
            if each.literal.positive and not _conditional(each.condition)
        }
        return self._bits(did.needed - gone | sure), self._bits(gone)

    def __call__(self, state: State) -> bool:
        """Whether a state may have come about."""
        if not len(self._gone):
            return True
        reached, left = self._words(self._bits(state)), np.arange(len(self._gone))
        while (self._goal & ~reached).any():
            done = ~(self._needed[left] & ~reached).any(axis=1)
            reached |= np.bitwise_or.reduce(self._gone[left[done]], axis=0, initial=0)
            left = left[~done]
            if not done.any():
                return False
        return True

    def _words(self, bits: int) -> NDArray[np.uint64]:
        """Bits in whole words."""
        size = 8 * max(1, -(-len(self._bit) // 64))
        return np.frombuffer(bits.to_bytes(size, "little"), dtype="<u8").astype(np.uint64)


def _conditional(condition: Condition) -> bool:
    return condition not in (Conjunction(), Disjunction())
