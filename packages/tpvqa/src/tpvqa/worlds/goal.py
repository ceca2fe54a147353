"""Judging by the truth, in worlds that know it."""

from tpvqa.pddl import Condition, holds, literals
from tpvqa.worlds.capabilities import truth_of
from tpvqa.worlds.protocol import World


def goal_holds(world: World, goal: Condition) -> bool | None:
    """Whether a goal holds in truth; None in a world that does not know."""
    truth = truth_of(world)
    if truth is None:
        return None
    true = frozenset(lit.atom for lit in literals(goal) if truth.holds(lit.atom))
    return holds(goal, true)
