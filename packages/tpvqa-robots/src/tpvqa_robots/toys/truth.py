"""What is true on the toys' table, from contacts and poses. For judges and noise models alone.

| fact | holds where |
|---|---|
| `in_hand(x)` | parts of both fingers touch it |
| `hand_empty` | no thing is in the hand |
| `on(x, floor)` | not in the hand, and its origin is below `FALLEN` |
| `on(x, container)` | its middle is within the container's walls, at most `RIM` above its rim |
| `on(x, goal_area)` | its origin is at most `RESTING` above the table, its middle in the red |
| `on(x, table)` | on the table and none of these |
| `found(x)` | at least `SHOWN` pixels of the overhead camera show it |
"""

from collections.abc import Callable, Collection, Iterable, Mapping
from itertools import product
from typing import Any

import numpy as np

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.worlds.earlier_truth import EarlierTruth
from tpvqa_robots.toys.scene import GOAL, TABLE
from tpvqa_robots.toys.things import GOAL_SIZE, HEIGHT, LENGTH, MOVABLE, WALL, WIDTH

FALLEN = 0.45
"""Metres above the floor."""
RESTING = 0.03
RIM = 0.03
SHOWN = 250
FINGERS = ("left", "right")
KNOWN = ("in_hand", "hand_empty", "found", "on")
"""The predicates of which this world knows when they hold."""
CONTAINERS = tuple(name for name in MOVABLE if name.endswith("container"))


def see_known(
    task: Task,
    known: Collection[str] = KNOWN,
    *,
    world: str = "toys",
    example: str = "collect_toys",
) -> None:
    """See whether a task is about what a world knows.

    Args:
        task: The task.
        known: The predicates of which the world knows when they hold.
        world: The world; named in errors.
        example: A task that it knows.

    Raises:
        WorldError: It has a predicate of which the world cannot tell whether it holds.
    """
    strange = sorted(set(task.predicates) - set(known) - {"="})
    if strange:
        raise WorldError(
            f"The world {world!r} cannot tell when {strange[0]!r} holds; it knows "
            f"{', '.join(known)}. Run {example} in it, or another task with these predicates."
        )


def atoms_of(task: Task, known: Collection[str] = KNOWN) -> frozenset[Atom]:
    """All facts that known predicates and a task's objects make up."""
    return frozenset(
        Atom(predicate, names)
        for predicate, kinds in task.predicates.items()
        if predicate in known
        for names in product(*([n for n in task.objects if task.is_a(n, kind)] for kind in kinds))
    )


def true_state(model: Any, data: Any, pixels: Mapping[str, int], atoms: Iterable[Atom]) -> State:
    """Those of some atoms that hold.

    Args:
        model: The compiled scene.
        data: Its state.
        pixels: How many pixels of the robot's camera show each thing.
        atoms: Those that are asked about.
    """
    held = {name for name in MOVABLE if touched_by_both(model, data, name)}
    places = {name: None if name in held else _place(data, name) for name in MOVABLE}

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


def touched_by_both(model: Any, data: Any, name: str) -> bool:
    """Whether parts of both fingers touch a body."""
    body, touching = model.body(name).id, set()
    for contact in data.contact[: data.ncon]:
        bodies = [int(model.geom_bodyid[geom]) for geom in contact.geom]
        if body in bodies and bodies[0] != bodies[1]:
            other = model.body(bodies[1] if bodies[0] == body else bodies[0]).name
            touching |= {side for side in FINGERS if other.startswith(f"arm_hand_{side}")}
    return len(touching) == len(FINGERS)


def _place(data: Any, name: str) -> str | None:
    at = data.body(name).xpos
    if at[2] < FALLEN:
        return "floor"
    for container in CONTAINERS:
        if container != name and _within(data.body(container), at):
            return container
    if at[2] - TABLE > RESTING:
        return None  # neither here nor there: it leans, or is still falling
    inside = np.abs(at[:2] - np.array(GOAL)) <= np.array(GOAL_SIZE) / 2
    return "goal_area" if inside.all() else "table"


def _within(container: Any, at: Any) -> bool:
    x, y, z = container.xmat.reshape(3, 3).T @ (at - container.xpos)
    return bool(
        abs(x) <= LENGTH / 2 - WALL and abs(y) <= WIDTH / 2 - WALL and 0 <= z <= HEIGHT + RIM
    )


class ToysTruth:
    """What is true now: a live `TruthSource` that also knows what was before the last action.

    Args:
        task: Tells what follows from the state.
        now: Gives the facts that hold now.
        before: Gives those that held before the last action.
    """

    def __init__(self, task: Task, now: Callable[[], State], before: Callable[[], State]):
        self._task, self._now, self._then = task, now, before

    def holds(self, atom: Atom) -> bool:
        """Whether a fact is true now."""
        return self._present.holds(atom)

    def visible(self, atom: Atom) -> bool:
        """Pictures show what they show; nothing is said to be out of sight."""
        return True

    def possible(self, action: Action) -> bool:
        """Whether all preconditions of an action hold now."""
        return self._present.possible(action)

    def successful(self, action: Action) -> bool:
        """Whether all effects of an action hold now."""
        return self._present.successful(action)

    def scene(self) -> str:
        """A fingerprint of the true state."""
        return self._present.scene()

    def earlier(self) -> EarlierTruth:
        """What was true before the last action; at first what is true now."""
        return EarlierTruth(self._task, self._then(), self.visible)

    @property
    def _present(self) -> EarlierTruth:
        return EarlierTruth(self._task, self._now(), self.visible)
