"""Where the furniture of a random kitchen stands.

The back wall is y = 0 and the room extends towards -y; x runs along the back wall and z points
up. Furniture faces -y before it is turned by its yaw.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.kitchen.rotation import Array, about_z

Split = Literal["train", "held_out"]
GAP = 0.12
"""Free room beside the fridge, where it stands in line with the counter."""
ALONE = (0.8, 1.9)
"""Bare wall beside a fridge that stands alone, metres."""


@dataclass(frozen=True, slots=True)
class Stand:
    """Where a piece of furniture stands: centre of its bottom, and its turn in radians."""

    x: float
    y: float
    yaw: float = 0.0
    z: float = 0.0

    def point(self, x: float, y: float, z: float = 0.0) -> Array:
        """A point of the furniture's own frame, in the room."""
        turned = about_z(self.yaw) @ np.array([x, y, z])
        return np.asarray(turned + np.array([self.x, self.y, self.z]))


@dataclass(frozen=True, slots=True)
class Area:
    """A level rectangle on which items can lie.

    Attributes:
        fixture: The fixture it belongs to.
        stand: Its centre and turn; -y of its own frame is where the robot comes from.
        half: Half sizes along its own x and y.
        around: How far the robot's direction may differ from its front, radians.
    """

    fixture: str
    stand: Stand
    half: tuple[float, float]
    around: float = math.pi


@dataclass(frozen=True, slots=True)
class Footprint:
    """A rectangle on the floor that the robot cannot stand in."""

    stand: Stand
    half: tuple[float, float]

    def blocks(self, points: Array, margin: float) -> NDArray[np.bool_]:
        """Which of (n, 2) points lie in it or nearer than `margin`."""
        local = (points - [self.stand.x, self.stand.y]) @ about_z(self.stand.yaw)[:2, :2]
        return np.asarray((abs(local) < np.array(self.half) + margin).all(axis=1))


@dataclass(frozen=True)
class Layout:
    """A furnished room.

    Attributes:
        width: Along the back wall, metres.
        depth: From the back wall to the front wall.
        cabinets: Modules of the counter.
        wall_cabinets: Cabinets above it.
        footprints: What the robot cannot stand in.
        counter: The stretch of the counter on which items lie.
        floors: Free patches of the floor.
    """

    width: float
    depth: float
    height: float
    cabinets: tuple[Stand, ...]
    wall_cabinets: tuple[Stand, ...]
    sink: Stand
    fridge: Stand
    tv_stand: Stand
    table: Stand
    footprints: tuple[Footprint, ...] = field(repr=False)
    counter: Area
    floors: tuple[Area, ...] = field(repr=False)


Sizes = Mapping[str, tuple[float, float, float]]


def draw_layout(rng: np.random.Generator, split: Split, sizes: Sizes, *, hinge: float) -> Layout:
    """Furnish a random room. Held-out rooms have the sink and the fridge on side walls.

    The open door of the fridge hides what is in it from one side, so that side is the roomy one.

    Args:
        rng: Decides everything.
        split: Which kind of room.
        sizes: Extents of counter, wall_cabinet, sink, fridge, tvstand and table.
        hinge: 1 where the fridge's door hangs on the right, seen from its front; -1 on the left.
    """
    sign = -hinge if split == "train" else hinge
    depth = float(rng.uniform(4.3, 5.3))
    module, deep, top = sizes["counter"]
    modules = round(float(rng.uniform(2.4, 3.0)) / module)
    y = -deep / 2 - 0.005
    fridge_w, fridge_d, _ = sizes["fridge"]
    sink_w = sizes["sink"][0]
    if split == "train":
        # counter, sink, one more cabinet, a gap, fridge
        gap = GAP if rng.random() < 0.5 else float(rng.uniform(*ALONE))
        length = (modules + 1) * module + sink_w + gap + fridge_w
        width = float(length + rng.uniform(0.4, 1.0))
        left = -width / 2 + float(rng.uniform(0.05, 0.3))
        xs = [left + module * (k + 0.5) for k in range(modules)]
        end = left + modules * module
        sink = Stand(sign * (end + sink_w / 2), y)
        cabinets = [Stand(sign * x, y) for x in [*xs, end + sink_w + module / 2]]
        fridge_x = end + sink_w + module + gap + fridge_w / 2
        fridge = Stand(sign * fridge_x, -fridge_d / 2 - 0.03)
        run = (left + 0.15, end - 0.2)
    else:
        # counter along the back wall, sink on one side wall, fridge on the other
        width = float(modules * module + 2 * deep + rng.uniform(0.3, 0.8))
        left = -width / 2 + deep + 0.02
        xs = [left + module * (k + 0.5) for k in range(modules)]
        turn = sign * math.pi / 2
        side = sign * (-width / 2 + deep / 2 + 0.005)
        cabinets = [Stand(sign * x, y) for x in xs]
        corner_y = -deep - module / 2 - 0.02
        sink_y = corner_y - module / 2 - sink_w / 2
        cabinets += [Stand(sign * (-width / 2 + module / 2 + 0.01), y), Stand(side, corner_y, turn)]
        cabinets += [Stand(side, sink_y - sink_w / 2 - module / 2, turn)]
        sink = Stand(side, sink_y, turn)
        fridge_y = -float(rng.uniform(1.3, 1.8))
        fridge = Stand(sign * (width / 2 - fridge_d / 2 - 0.03), fridge_y, -turn)
        run = (left + 0.1, left + modules * module - 0.1)
    middle, half = sign * (run[0] + run[1]) / 2, (run[1] - run[0]) / 2
    counter = Area("counter", Stand(middle, y, 0.0, top), (half, deep / 2 - 0.13), 0.6)
    upper_y = -sizes["wall_cabinet"][1] / 2 - 0.005
    uppers = tuple(
        Stand(stand.x, upper_y, 0.0, 1.45) for stand in cabinets[:modules] if rng.random() < 0.75
    )
    tv = _tv_stand(rng, split, sign, width, depth, sizes["tvstand"])
    table = _table(rng, width, depth, deep, tv, sizes)
    footprints = (
        *(Footprint(stand, (module / 2, deep / 2)) for stand in cabinets),
        Footprint(sink, (sink_w / 2, deep / 2)),
        Footprint(fridge, (fridge_w / 2, fridge_d / 2)),
        Footprint(tv, (sizes["tvstand"][0] / 2, sizes["tvstand"][1] / 2)),
        Footprint(table, (sizes["table"][0] / 2, sizes["table"][1] / 2)),
    )
    return Layout(
        width=width,
        depth=depth,
        height=2.6,
        cabinets=tuple(cabinets),
        wall_cabinets=uppers,
        sink=sink,
        fridge=fridge,
        tv_stand=tv,
        table=table,
        footprints=footprints,
        counter=counter,
        floors=_floors(width, depth, footprints),
    )


def _tv_stand(
    rng: np.random.Generator,
    split: Split,
    sign: float,
    width: float,
    depth: float,
    size: tuple[float, float, float],
) -> Stand:
    if split == "held_out":  # on the front wall
        return Stand(float(rng.uniform(-0.6, 0.6)), -depth + size[1] / 2 + 0.04, math.pi)
    y = float(rng.uniform(-depth + size[0] / 2 + 0.1, -depth + size[0] / 2 + 0.7))
    return Stand(-sign * (width / 2 - size[1] / 2 - 0.04), y, sign * math.pi / 2)


def _table(
    rng: np.random.Generator, width: float, depth: float, deep: float, tv: Stand, sizes: Sizes
) -> Stand:
    """As far from the other furniture as it goes, a little off."""
    half_x, half_y = sizes["table"][0] / 2, sizes["table"][1] / 2
    walls_x = [-width / 2 + 0.5, width / 2 - 0.5]
    walls_y = [-depth + 0.5, -deep - 1.0]
    reach = sizes["tvstand"][1] + 1.3
    if abs(tv.yaw) > 3:
        walls_y[0] = -depth + reach
    elif tv.x < 0:
        walls_x[0] = -width / 2 + reach
    else:
        walls_x[1] = width / 2 - reach

    def between(low: float, high: float, half: float) -> float:
        spare = max(high - low - 2 * half, 0.0)
        return (low + high) / 2 + float(rng.uniform(-0.5, 0.5)) * spare

    x = between(walls_x[0], walls_x[1], half_x)
    y = between(walls_y[0], walls_y[1], half_y)
    return Stand(x, y, float(rng.uniform(-0.12, 0.12)))


def _floors(width: float, depth: float, footprints: Sequence[Footprint]) -> tuple[Area, ...]:
    """Free patches of floor on a grid."""
    xs = np.arange(-width / 2 + 0.4, width / 2 - 0.39, 0.2)
    ys = np.arange(-depth + 0.4, -0.9, 0.2)
    grid = np.array([(x, y) for x in xs for y in ys])
    free = np.ones(len(grid), bool)
    for footprint in footprints:
        free &= ~footprint.blocks(grid, 0.25)
    return tuple(Area("floor", Stand(float(x), float(y)), (0.1, 0.1)) for x, y in grid[free])
