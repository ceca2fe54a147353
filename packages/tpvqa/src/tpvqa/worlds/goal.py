"""Judging by the truth, in worlds that know it."""

from collections.abc import Iterator

from tpvqa.pddl import Condition, Conjunction, Disjunction, Literal
from tpvqa.vlm.protocol import TruthSource
from tpvqa.worlds.capabilities import truth_of
from tpvqa.worlds.protocol import World


def goal_holds(world: World, goal: Condition) -> bool | None:
    """Whether a goal holds in truth; None in a world that does not know."""
    truth = truth_of(world)
    if truth is None:
        return None
    return _judged(goal, truth)


def unmet(world: World, goal: Condition) -> tuple[Literal, ...]:
    """The literals for want of which a goal does not hold in truth, in the order written.

    Of a disjunction of which nothing holds all. Empty in a world that does not know.
    """
    truth = truth_of(world)
    return () if truth is None else tuple(_missing(goal, truth))


def _missing(condition: Condition, truth: TruthSource) -> Iterator[Literal]:
    if _judged(condition, truth):
        return
    if isinstance(condition, Literal):
        yield condition
    else:
        for part in condition.parts:
            yield from _missing(part, truth)


def _judged(condition: Condition, truth: TruthSource) -> bool:
    match condition:
        case Literal(atom, positive):
            return truth.holds(atom) == positive
        case Conjunction(parts):
            return all(_judged(part, truth) for part in parts)
        case Disjunction(parts):
            return any(_judged(part, truth) for part in parts)
