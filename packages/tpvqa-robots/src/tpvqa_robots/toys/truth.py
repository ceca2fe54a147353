"""What is true on the toys' table, from contacts and poses. For judges and noise models alone.

| fact | holds where |
|---|---|
| `in_hand(x)` | parts of both fingers touch it |
| `hand_empty` | no thing is in the hand |
| `on(x, floor)` | not in the hand, and its origin is below `FALLEN` |
| `on(x, container)` | its middle is within the container's walls, at most `RIM` above its rim |
| `on(x, goal_area)` | its origin is at most `RESTING` above the table, its middle in the red; a
scanned toy's origin is its middle, which is at most half its length above the table where it lies |
| `on(x, table)` | on the table and none of these |
| `found(x)` | at least `SHOWN` pixels of the overhead camera show it |
"""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from tpvqa.pddl import Atom, State
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.toys.scans import SCANS, half_length
from tpvqa_robots.toys.scene import GOAL
from tpvqa_robots.toys.things import GOAL_SIZE, HEIGHT, LENGTH, MOVABLE, WALL, WIDTH
from tpvqa_robots.truth import touched_by_both

FALLEN = 0.45
"""Metres above the floor."""
RESTING, LEANING = 0.03, 0.005
RIM = 0.03
SHOWN = 250
KNOWN = ("in_hand", "hand_empty", "found", "on")
"""The predicates of which this world knows when they hold."""
CONTAINERS = tuple(name for name in MOVABLE if name.endswith("container"))


def true_state(model: Any, data: Any, pixels: Mapping[str, int], atoms: Iterable[Atom]) -> State:
    """Those of some atoms that hold.

    Args:
        model: The compiled scene.
        data: Its state.
        pixels: How many pixels of the robot's camera show each thing.
        atoms: Those that are asked about.
    """
    bodies = {model.body(i).name for i in range(model.nbody)}
    there = [name for name in (*MOVABLE, *SCANS) if name in bodies]
    held = {name for name in there if touched_by_both(model, data, name)}
    places = {name: None if name in held else _place(data, name) for name in there}

    def holds(atom: Atom) -> bool:
        match atom.predicate, atom.arguments:
            case "hand_empty", _:
                return not held
            case "in_hand", (name,):
                return name in held
            case "found", (name,):
                return pixels.get(name, 0) >= SHOWN
            case "on", (name, where):
                return places.get(name) == where
        return False

    return frozenset(atom for atom in atoms if holds(atom))


def _place(data: Any, name: str) -> str | None:
    at = data.body(name).xpos
    if at[2] < FALLEN:
        return "floor"
    for container in CONTAINERS:
        if container != name and _within(data.body(container), at):
            return container
    if at[2] - TABLE > (half_length(name) + LEANING if name in SCANS else RESTING):
        return None  # neither here nor there: it leans, or is still falling
    inside = np.abs(at[:2] - np.array(GOAL)) <= np.array(GOAL_SIZE) / 2
    return "goal_area" if inside.all() else "table"


def _within(container: Any, at: Any) -> bool:
    x, y, z = container.xmat.reshape(3, 3).T @ (at - container.xpos)
    return bool(
        abs(x) <= LENGTH / 2 - WALL and abs(y) <= WIDTH / 2 - WALL and 0 <= z <= HEIGHT + RIM
    )
