"""What is true of the bins, from contacts and poses. For judges and noise models alone.

| fact | holds where |
|---|---|
| `in_hand(x)` | parts of both fingers touch it |
| `hand_empty` | no thing is in the hand |
| `in(x, bin)` | not in the hand, its middle within the bin's walls and below its rim, or nearly |
"""

from collections.abc import Iterable
from typing import Any

from tpvqa.pddl import Atom, State
from tpvqa_robots.bins.scene import AT, HALF, RIM, SOURCE, TARGETS, THINGS
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.truth import touched_by_both

KNOWN = ("in", "in_hand", "hand_empty")
"""The predicates of which this world knows when they hold."""


def middle_of(name: str) -> tuple[float, float]:
    """Where a bin's middle is, metres from the arm's foot when the base has not turned."""
    if name == SOURCE:
        return AT[SOURCE]
    (x, y), (dx, dy) = AT["bins"], TARGETS[name]
    return x + dx, y + dy


def true_state(model: Any, data: Any, atoms: Iterable[Atom]) -> State:
    """Those of some atoms that hold."""
    held = {name for name in THINGS if touched_by_both(model, data, name)}
    places = {name: None if name in held else _place(data, name) for name in THINGS}

    def holds(atom: Atom) -> bool:
        match atom.predicate, atom.arguments:
            case "hand_empty", _:
                return not held
            case "in_hand", (name,):
                return name in held
            case "in", (name, where):
                return places.get(name) == where
        return False

    return frozenset(atom for atom in atoms if holds(atom))


def _place(data: Any, name: str) -> str | None:
    x, y, z = data.body(name).xpos
    if not 0 < z - TABLE < RIM + THINGS[name]:
        return None
    for where in (SOURCE, *TARGETS):
        at = middle_of(where)
        half = HALF if where == SOURCE else (HALF[0] / 2, HALF[1] / 2)
        if abs(x - at[0]) < half[0] and abs(y - at[1]) < half[1]:
            return where
    return None
