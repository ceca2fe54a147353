"""Where the robot stands and looks, so that it sees what the state says and nothing else."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.kitchen.layout import Footprint, Layout, Stand
from tpvqa_household.kitchen.rotation import Array, about_x, about_y, looking

LEAN = 0.1
"""How far the robot's head may be over low furniture, metres; so far from it when bent down."""
BENT = 1.1
"""Below this the head is no higher than the furniture, near enough."""
Ball = tuple[Array, float]
"""Centre and radius of a ball around a thing."""


@dataclass(frozen=True, slots=True)
class Shot:
    """A camera pose.

    Attributes:
        position: In the room.
        axes: Right, up and backward as columns.
        fovy: Vertical field of view, degrees.
    """

    position: Array
    axes: Array
    fovy: float

    def project(self, points: Array) -> tuple[Array, Array]:
        """Picture coordinates of (n, 3) points and their depth. ±1 is the edge of the picture."""
        local = (points - self.position) @ self.axes
        depth = -local[:, 2]
        reach = np.maximum(abs(depth), 1e-6) * math.tan(math.radians(self.fovy) / 2)
        return local[:, :2] / reach[:, None], depth

    def sees(self, centres: Array, radii: Array) -> NDArray[np.bool_]:
        """Whether any bit of each ball may be in the picture (walls and furniture aside)."""
        t = math.tan(math.radians(self.fovy) / 2)
        local = (centres - self.position) @ self.axes
        depth = -local[:, 2]
        reach = depth * t + radii * math.sqrt(1 + t * t)
        inside = (abs(local[:, :2]) < reach[:, None]).all(axis=1)
        return np.asarray((depth > -radii) & inside)


@dataclass(frozen=True, slots=True)
class Approach:
    """From where a thing is looked at.

    Attributes:
        target: The point looked at.
        front: The direction towards the robot, an angle in the floor's plane.
        around: How far the robot's direction may differ from it.
        distance: Range of the distance along the floor.
        height: Range of the camera's height.
        aim: Where in the picture the target is, at most this far from the middle; x, then y
            from and to.
    """

    target: Array
    front: float
    around: float
    distance: tuple[float, float]
    height: tuple[float, float]
    aim: tuple[float, float, float] = (0.2, 0.1, 0.4)


@dataclass(frozen=True, slots=True)
class Wanted:
    """What a picture has to show and what not.

    Attributes:
        inside: Balls that have to be in the picture whole, above the hands.
        outside: Balls of which nothing may be in it.
    """

    inside: tuple[Ball, ...] = ()
    outside: tuple[Ball, ...] = ()


def front_of(stand: Stand) -> float:
    """The direction that furniture faces, as an angle in the floor's plane."""
    return stand.yaw - math.pi / 2


def standing_room(layout: Layout, position: Array) -> bool:
    """Whether the robot can have its head there. It may lean a little over low furniture."""
    x, y = float(position[0]), float(position[1])
    if not (abs(x) < layout.width / 2 - 0.15 and -layout.depth + 0.15 < y < -0.15):
        return False
    here = np.array([[x, y]])
    margin = -LEAN if position[2] > BENT else LEAN
    footprints: Sequence[Footprint] = layout.footprints
    return not any(footprint.blocks(here, margin)[0] for footprint in footprints)


def candidate(approach: Approach, rng: np.random.Generator, side: float, aside: float) -> Shot:
    """A random shot of a thing.

    Args:
        approach: From where.
        rng: Decides.
        side: Lean to one side (-1, 0 or 1): the robot's head moves around the thing.
        aside: Where the target should be, left to right, away from a hand that holds something.
    """
    angle = approach.front + rng.uniform(-1, 1) * approach.around + side * 0.35
    distance = rng.uniform(*approach.distance)
    position = np.array(
        [
            approach.target[0] + distance * math.cos(angle),
            approach.target[1] + distance * math.sin(angle),
            rng.uniform(*approach.height),
        ]
    )
    fovy = float(rng.uniform(52, 60))
    t = math.tan(math.radians(fovy) / 2)
    axes = looking(approach.target - position, float(rng.uniform(-0.05, 0.05)))
    across, low, high = approach.aim
    x = float(np.clip(rng.uniform(-across, across) + aside, -0.45, 0.45))
    y = rng.uniform(low, high)
    axes = axes @ about_y(math.atan(x * t)) @ about_x(-math.atan(y * t))
    return Shot(position, axes, fovy)


def overview(layout: Layout, rng: np.random.Generator) -> Shot:
    """The whole room from one of its front corners, high up."""
    side = -1.0 if rng.random() < 0.5 else 1.0
    position = np.array(
        [side * (layout.width / 2 - 0.3), -layout.depth + 0.3, rng.uniform(2.0, 2.3)]
    )
    middle = np.array([-0.1 * position[0], -layout.depth * 0.3, 0.7])
    return Shot(position, looking(middle - position), float(rng.uniform(66, 74)))


def faults(shot: Shot, wanted: Wanted, layout: Layout) -> float:
    """How much is wrong with a shot; 0 is good."""
    wrong = 0.0
    if not standing_room(layout, shot.position):
        wrong += 100.0
    if wanted.outside:
        centres = np.array([centre for centre, _ in wanted.outside])
        radii = np.array([r for _, r in wanted.outside])
        wrong += 10.0 * float(shot.sees(centres, radii).sum())
    if wanted.inside:
        centres = np.array([centre for centre, _ in wanted.inside])
        radii = np.array([r for _, r in wanted.inside])
        at, depth = shot.project(centres)
        size = radii / (np.maximum(depth, 0.05) * math.tan(math.radians(shot.fovy) / 2))
        over = np.maximum(abs(at) + 0.8 * size[:, None] - 1.0, 0.0).sum(axis=1)
        # The hands are in the lower corners: a thing there would hide behind them.
        low = (at[:, 1] < -0.25) & (abs(at[:, 0]) > 0.3)
        wrong += float((over + (depth < 0.2) * 5 + low * 2).sum())
    return wrong


def choose(
    approach: Approach,
    wanted: Wanted,
    layout: Layout,
    rng: np.random.Generator,
    *,
    side: float = 0.0,
    aside: float = 0.0,
    tries: int = 60,
) -> tuple[Shot, float]:
    """The first good shot among random ones, else the least bad; and how bad it is."""
    best: Shot | None = None
    least = math.inf
    for _ in range(tries):
        shot = candidate(approach, rng, side, aside)
        wrong = faults(shot, wanted, layout)
        if wrong < least:
            best, least = shot, wrong
        if wrong <= 0:
            break
    assert best is not None
    return best, least
