"""What a trial probably begins with."""

from collections.abc import Sequence
from math import fsum

from tpvqa.pddl import Atom, State

PROBABLY = 0.55
"""How likely a fact has to be; of facts that nothing was seen of, half of the states have one."""


def probably(states: Sequence[tuple[State, float]]) -> State:
    """The facts that are rather so than not; together they may be no state.

    What is as likely not to be so may have been, even where the likeliest state has it.

    Args:
        states: The states that there may be, each with its weight.
    """
    shares = dict[Atom, float]()
    for state, weight in states:
        for atom in state:
            shares[atom] = shares.get(atom, 0.0) + weight
    least = PROBABLY * fsum(weight for _, weight in states)
    return frozenset(atom for atom, share in shares.items() if share > least)
