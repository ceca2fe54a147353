"""What a trial probably begins with."""

from collections.abc import Sequence
from math import fsum

from tpvqa.pddl import Atom, State

HARDLY = 1e-6
"""What sums of weights may be off by."""


def probably(states: Sequence[tuple[State, float]]) -> State:
    """The facts that are more likely so than not; together they may be no state.

    What is as likely not to be so may have been, even where the likeliest state has it.

    Args:
        states: The states that there may be, each with its weight.
    """
    shares = dict[Atom, float]()
    for state, weight in states:
        for atom in state:
            shares[atom] = shares.get(atom, 0.0) + weight
    half = (0.5 + HARDLY) * fsum(weight for _, weight in states)
    return frozenset(atom for atom, share in shares.items() if share > half)
