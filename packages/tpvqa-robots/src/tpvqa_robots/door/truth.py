"""What is true of the door, from contacts and joints. For judges and noise models alone.

| fact | holds where |
|---|---|
| `holding(handle)` | parts of both fingers touch it |
| `hand_empty` | nothing is in the hand |
| `turned(handle)` | the latch's joint is turned by `TURNED` at least, either way |
| `open(door)` | the hinge is turned by `OPEN` at least |
"""

from collections.abc import Iterable
from typing import Any

from tpvqa.pddl import Atom, State
from tpvqa_robots.door.scene import DOOR, HANDLE, HINGE_JOINT, LATCH, LATCH_JOINT
from tpvqa_robots.truth import touched_by_both

TURNED = 1.2
"""Radians: from here on the bolt lets the door go."""
OPEN = 0.3
"""Radians, as robosuite has it; the hinge ends at 0.4."""
KNOWN = ("holding", "hand_empty", "turned", "open")
"""The predicates of which this world knows when they hold."""


def true_state(model: Any, data: Any, atoms: Iterable[Atom]) -> State:
    """Those of some atoms that hold."""
    held = touched_by_both(model, data, LATCH)

    def holds(atom: Atom) -> bool:
        match atom.predicate, atom.arguments:
            case "hand_empty", _:
                return not held
            case "holding", (thing,):
                return held and thing == HANDLE
            case "turned", (thing,):
                return thing == HANDLE and abs(data.joint(LATCH_JOINT).qpos[0]) >= TURNED
            case "open", (thing,):
                return thing == DOOR and bool(data.joint(HINGE_JOINT).qpos[0] >= OPEN)
        return False

    return frozenset(atom for atom in atoms if holds(atom))
