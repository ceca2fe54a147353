"""Fridges whose door swings open on shelves; held out: side by side and rounded old ones.

The main body is the cabinet; the body "door" hangs on a hinge, 0 is shut and positive degrees
are open. Surfaces "shelf0" (lowest) … are inside.
"""

import colorsys
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Mesh, joined
from tpvqa_household.kitchen.assets.model import Joint, Model
from tpvqa_household.kitchen.assets.paint import Colour, one_of
from tpvqa_household.kitchen.assets.shapes import box, tube

COLOURS: tuple[Colour, ...] = (
    (0.74, 0.76, 0.78),
    (0.93, 0.93, 0.92),
    (0.62, 0.1, 0.1),
    (0.62, 0.82, 0.74),
    (0.07, 0.07, 0.08),
    (0.35, 0.42, 0.5),
)
WALL = 0.035
DOOR = 0.055


@dataclass(frozen=True, slots=True)
class Cabinet:
    """Outer sizes, and the part (low to high) that the swinging door closes."""

    x: float
    y: float
    z: float
    low: float
    high: float
    left: float
    right: float


def _shell(build: Builder, c: Cabinet, paint: str, inside: str, shelves: int, bevel: float) -> None:
    """Walls around an open space, white within, with shelves."""
    w, d = c.right - c.left, c.y
    mid = (c.left + c.right) / 2
    span = c.high - c.low
    walls: list[Mesh] = [
        box(WALL, d, c.z, bevel=bevel).moved(x=-c.x / 2 + WALL / 2),
        box(WALL, d, c.z, bevel=bevel).moved(x=c.x / 2 - WALL / 2),
        box(c.x - WALL, WALL, c.z - 0.002).moved(y=d / 2 - WALL / 2),
        box(c.x - 0.002, d, WALL, bevel=bevel).moved(z=c.z - WALL),
        box(c.x - 0.002, d - 0.03, 0.06).moved(y=0.015),
    ]
    if c.low > 0.1:
        walls.append(box(c.x - 2 * WALL, d - 0.01, c.low - 0.06).moved(y=0.005, z=0.06))
    if c.high < c.z - 0.1:
        walls.append(box(c.x - 2 * WALL, d - 0.01, c.z - WALL - c.high).moved(y=0.005, z=c.high))
    for edge, sign in ((c.left, -1), (c.right, 1)):
        gap = sign * (sign * c.x / 2 - edge)
        if gap > WALL + 0.02:
            wide = gap - WALL
            walls.append(
                box(wide, d - 0.01, c.z - 0.1).moved(x=edge + sign * wide / 2, y=0.005, z=0.06)
            )
    build.mesh("cabinet", joined(walls), paint)
    lining = [
        box(0.006, d - 0.02, span).moved(x=c.left + WALL + 0.003, z=c.low),
        box(0.006, d - 0.02, span).moved(x=c.right - WALL - 0.003, z=c.low),
        box(w - 2 * WALL, 0.006, span).moved(x=mid, y=d / 2 - WALL - 0.003, z=c.low),
        box(w - 2 * WALL, d - 0.02, 0.008).moved(x=mid, z=c.low),
        box(w - 2 * WALL, d - 0.02, 0.008).moved(x=mid, z=c.high - WALL * (c.high == c.z) - 0.008),
    ]
    build.mesh("lining", joined(lining), inside)
    glass = build.paint("shelf", (0.8, 0.9, 0.93, 0.5), specular=0.6, shininess=0.7)
    trim = build.paint("edge", (0.9, 0.92, 0.93), emission=0.05)
    lamp = build.paint("lamp", (1, 1, 0.93), emission=0.9)
    usable = span - (WALL if c.high == c.z else 0)
    deep = d - 0.13
    for k in range(shelves):
        z = c.low + 0.012 + usable * k / shelves
        if k:
            build.mesh(
                f"shelf{k}",
                box(w - 2 * WALL - 0.012, deep, 0.008).moved(x=mid, y=0.02, z=z),
                glass,
                role="shelf",
            )
            build.mesh(
                f"edge{k}",
                box(w - 2 * WALL - 0.012, 0.012, 0.014).moved(
                    x=mid, y=0.02 - deep / 2, z=z - 0.003
                ),
                trim,
            )
            build.solid("box", ((w - 2 * WALL) / 2, deep / 2, 0.004), (mid, 0.02, z + 0.004))
            z += 0.008
        build.top(
            f"shelf{k}",
            (mid, 0.02, z),
            ((w - 2 * WALL) / 2 - 0.01, deep / 2 - 0.01),
            usable / shelves - 0.02,
        )
    build.mesh(
        "lamp",
        box(0.1, 0.05, 0.012).moved(x=mid, y=0.05, z=c.high - WALL * (c.high == c.z) - 0.02),
        lamp,
    )
    _solids(build, c)


def _solids(build: Builder, c: Cabinet) -> None:
    h = c.z / 2
    build.solid(
        "box",
        (WALL / 2, c.y / 2, h),
        (c.left + WALL / 2 if c.left > -c.x / 2 else -c.x / 2 + WALL / 2, 0, h),
    )
    build.solid("box", (WALL / 2, c.y / 2, h), (c.x / 2 - WALL / 2, 0, h))
    build.solid("box", (c.x / 2, WALL / 2, h), (0, c.y / 2 - WALL / 2, h))
    build.solid("box", (c.x / 2, c.y / 2, WALL / 2), (0, 0, c.z - WALL / 2))
    build.solid("box", (c.x / 2, c.y / 2, (c.low + 0.008) / 2), (0, 0, (c.low + 0.008) / 2))


def _handle(style: str, z: float, side: float) -> Mesh:
    """A handle on the front of a door of height z, by its free edge at x = side."""
    h = min(0.32, 0.3 * z)
    if style == "bar":
        path = [[0, 0, -h], [0, -0.035, -h], [0, -0.035, h], [0, 0, h]]
        steps = np.concatenate([np.linspace(a, b, 3) for a, b in pairwise(path)])
        return tube(steps, 0.009, steps=8).moved(x=side)
    if style == "bow":
        t = np.linspace(0, np.pi, 12)
        return tube(np.stack([0 * t, -0.045 * np.sin(t), -h * np.cos(t)], 1), 0.011, steps=8).moved(
            x=side
        )
    if style == "block":
        return box(0.03, 0.035, 1.4 * h, bevel=0.008).moved(x=side, y=-0.012, z=-0.7 * h)
    return box(0.012, 0.022, 0.85 * z).moved(x=side * 1.04, y=-0.005, z=-0.425 * z)


def _door(
    build: Builder,
    c: Cabinet,
    paint: str,
    inside: str,
    metal: str,
    *,
    hinge: int,
    style: str,
    bevel: float,
) -> None:
    """The swinging door; `hinge` is 1 where it hangs on the right."""
    w, h = c.right - c.left - 0.004, c.high - c.low - 0.004
    x = -hinge * w / 2
    body = "door"
    front = -DOOR / 2
    build.mesh(
        "door",
        box(w, DOOR, h, bevel=bevel).moved(x=x, y=front, z=-h / 2),
        paint,
        body=body,
        role="door",
    )
    build.mesh(
        "gasket",
        box(w - 0.04, 0.01, h - 0.04).moved(x=x, y=0.004, z=-h / 2 + 0.02),
        inside,
        body=body,
    )
    bins = [
        part
        for z in np.linspace(-0.4, 0.22, max(2, round(h / 0.4))) * h
        for part in (
            box(w - 0.1, 0.08, 0.008).moved(x=x, y=0.05, z=z),
            box(w - 0.1, 0.006, 0.07).moved(x=x, y=0.09, z=z),
        )
    ]
    build.mesh("bins", joined(bins), "shelf", body=body)
    build.mesh(
        "handle",
        _handle(style, h, 0.0).moved(x=-hinge * (w - 0.05), y=-DOOR),
        metal,
        body=body,
        role="handle",
    )
    build.solid("box", (w / 2, DOOR / 2, h / 2), (x, front, 0), body=body)
    build.joints.append(
        Joint(
            body=body,
            kind="hinge",
            pos=(c.right - 0.002 if hinge > 0 else c.left + 0.002, -c.y / 2, (c.low + c.high) / 2),
            axis=(0.0, 0.0, float(hinge)),
            range=(0.0, 130.0),
        )
    )


def _decorated(build: Builder, rng: Generator, c: Cabinet, *, hinge: int) -> None:
    """Notes and magnets on the swinging door, or a dispenser: dark or bright, and no opening."""
    w, h = c.right - c.left, c.high - c.low
    if rng.random() < 0.25:
        dark = build.paint("dispenser", one_of(rng, ((0.06, 0.06, 0.07), (0.3, 0.32, 0.34)), 0.03))
        wide, tall = rng.uniform(0.14, 0.2), rng.uniform(0.2, 0.32)
        niche = box(wide, 0.006, tall, bevel=0.002)
        at = -hinge * w * rng.uniform(0.4, 0.55)
        build.mesh("dispenser", niche.moved(x=at, y=-DOOR - 0.001, z=0.08 * h), dark, body="door")
    for k in range(int(rng.integers(1, 5)) if rng.random() < 0.35 else 0):
        colour = (rng.uniform(0.2, 1), rng.uniform(0.2, 1), rng.uniform(0.2, 1))
        note = build.paint(f"note{k}", colour)
        size = rng.uniform(0.03, 0.2, 2)
        at = -hinge * w * rng.uniform(0.2, 0.75)
        z = h * rng.uniform(-0.3, 0.3)
        build.mesh(
            f"note{k}",
            box(size[0], 0.002, size[1]).moved(x=at, y=-DOOR - 0.001, z=z),
            note,
            body="door",
        )


def _fridge(
    rng: Generator,
    c: Cabinet,
    colour: Colour,
    *,
    hinge: int,
    style: str,
    bevel: float,
    metallic: bool,
    decorated: bool = False,
) -> Model:
    build = Builder()
    paint = build.paint("coat", colour, specular=0.6 if metallic else 0.35, shininess=0.6)
    inside = build.paint("inside", (0.95, 0.96, 0.97), emission=0.15)
    metal = build.paint(
        "metal",
        one_of(rng, ((0.8, 0.8, 0.82), (0.25, 0.25, 0.26)), 0.03),
        specular=0.9,
        shininess=0.8,
    )
    shelves = max(2, round((c.high - c.low) / rng.uniform(0.26, 0.34)))
    _shell(build, c, paint, inside, shelves, min(bevel, 0.012))
    _door(build, c, paint, inside, metal, hinge=hinge, style=style, bevel=bevel)
    others = [
        (0.065, c.low - 0.004, -c.x / 2, c.x / 2),
        (c.high + 0.004, c.z, -c.x / 2, c.x / 2),
        (max(0.065, c.low), c.z, -c.x / 2, c.left - 0.004),
    ]
    for k, (low, high, left, right) in enumerate(others):
        wide, tall = right - left, high - low
        if wide < 0.12 or tall < 0.12:
            continue
        middle = (left + right) / 2
        build.mesh(
            f"panel{k}",
            box(wide - 0.004, DOOR, tall, bevel=bevel).moved(
                x=middle, y=-c.y / 2 - DOOR / 2, z=low
            ),
            paint,
        )
        side = right - 0.05 if wide < c.x - 0.1 else middle - hinge * (wide / 2 - 0.05)
        build.mesh(
            f"pull{k}",
            _handle(style, tall, 0.0).moved(x=side, y=-c.y / 2 - DOOR, z=(low + high) / 2),
            metal,
        )
        build.solid(
            "box", (wide / 2, DOOR / 2, tall / 2), (middle, -c.y / 2 - DOOR / 2, (low + high) / 2)
        )
    if decorated:
        _decorated(build, rng, c, hinge=hinge)
    return build.done("fridge", (c.x, c.y + 2 * DOOR, c.z), 60.0, colour=colour)


def _coat(rng: Generator) -> Colour:
    """A colour that fridges have, or any other."""
    if rng.random() < 0.6:
        return one_of(rng, COLOURS, 0.04)
    hue, saturation, value = rng.random(), rng.uniform(0.1, 0.8), rng.uniform(0.3, 0.95)
    red, green, blue = colorsys.hsv_to_rgb(hue, saturation, value)
    return (red, green, blue)


def fridge(rng: Generator) -> Model:
    """A fridge with one big door; freezer above, below or none; hinge left or right."""
    x, y, z = rng.uniform(0.54, 0.74), rng.uniform(0.5, 0.62), rng.uniform(1.35, 1.95)
    layout = str(rng.choice(["below", "above", "single"], p=[0.45, 0.2, 0.35]))
    low = rng.uniform(0.45, 0.65) if layout == "below" else 0.07
    high = z - rng.uniform(0.35, 0.45) if layout == "above" else z
    colour = _coat(rng)
    return _fridge(
        rng,
        Cabinet(x, y, z, low, high, -x / 2, x / 2),
        colour,
        hinge=int(rng.choice([-1, 1])),
        style=str(rng.choice(["bar", "bow", "block", "strip"])),
        bevel=rng.uniform(0.003, 0.022),
        metallic=colour[1] > 0.6,
        decorated=True,
    )


def french(rng: Generator) -> Model:
    """A wide one with two doors above a drawer; the right one swings."""
    x, y, z = rng.uniform(0.76, 0.92), rng.uniform(0.55, 0.64), rng.uniform(1.6, 1.85)
    colour = _coat(rng)
    return _fridge(
        rng,
        Cabinet(x, y, z, rng.uniform(0.5, 0.7), z, rng.uniform(-0.18, 0.0) * x, x / 2),
        colour,
        hinge=1,
        style=str(rng.choice(["bar", "bow", "block"])),
        bevel=rng.uniform(0.003, 0.02),
        metallic=rng.random() < 0.5,
        decorated=True,
    )


def side_by_side(rng: Generator) -> Model:
    """Held out: a wide one, freezer on the left, fridge on the right."""
    x, y, z = rng.uniform(0.82, 0.95), rng.uniform(0.58, 0.66), rng.uniform(1.7, 1.85)
    split = rng.uniform(-0.12, 0.0) * x
    colour = one_of(rng, ((0.68, 0.7, 0.72), (0.16, 0.17, 0.18), (0.88, 0.87, 0.84)), 0.04)
    return _fridge(
        rng,
        Cabinet(x, y, z, 0.07, z, split, x / 2),
        colour,
        hinge=1,
        style=str(rng.choice(["bar", "strip"])),
        bevel=0.006,
        metallic=True,
    )


def retro(rng: Generator) -> Model:
    """Held out: low, with strongly rounded edges, in pastel colours."""
    x, y, z = rng.uniform(0.56, 0.64), rng.uniform(0.54, 0.6), rng.uniform(1.15, 1.45)
    colour = one_of(
        rng, ((0.95, 0.75, 0.75), (0.55, 0.75, 0.85), (0.95, 0.85, 0.5), (0.85, 0.5, 0.2))
    )
    return _fridge(
        rng,
        Cabinet(x, y, z, 0.07, z, -x / 2, x / 2),
        colour,
        hinge=int(rng.choice([-1, 1])),
        style="bow",
        bevel=0.027,
        metallic=False,
    )
