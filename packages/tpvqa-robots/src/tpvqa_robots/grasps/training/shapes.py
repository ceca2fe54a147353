"""Families of shapes that are made up: each draw is another size."""

from collections.abc import Callable, Mapping

import numpy as np
from numpy.random import Generator

from tpvqa_robots.grasps.training.solids import Solid, Thing, Vec, turn

X, Y = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def _box(x: float, y: float, z: float, at: Vec = (0.0, 0.0, 0.0)) -> Solid:
    return Solid("box", (x / 2, y / 2, z / 2), at)


def _boxes(rng: Generator) -> list[Solid]:
    x, y, z = rng.uniform(0.018, 0.075), rng.uniform(0.02, 0.13), rng.uniform(0.025, 0.11)
    return [_box(x, y, z)]


def _cylinder(rng: Generator) -> list[Solid]:
    return [Solid("cylinder", (rng.uniform(0.011, 0.04), rng.uniform(0.012, 0.06), 0))]


def _capsule(rng: Generator) -> list[Solid]:
    return [Solid("capsule", (rng.uniform(0.012, 0.03), rng.uniform(0.01, 0.05), 0))]


def _egg(rng: Generator) -> list[Solid]:
    a, b, c = (float(v) for v in rng.uniform(0.016, 0.042, 3))
    return [Solid("ellipsoid", (a, b, c))]


def _corner(rng: Generator) -> list[Solid]:
    """An L."""
    t, a, b = rng.uniform(0.018, 0.035), rng.uniform(0.05, 0.11), rng.uniform(0.05, 0.11)
    h = rng.uniform(0.022, 0.06)
    return [_box(a, t, h), _box(t, b, h, ((t - a) / 2, (b - t) / 2, 0))]


def _tee(rng: Generator) -> list[Solid]:
    """A hammer, or a T."""
    t, a, b = rng.uniform(0.016, 0.03), rng.uniform(0.05, 0.1), rng.uniform(0.05, 0.11)
    h = rng.uniform(0.02, 0.04)
    return [_box(a, rng.uniform(0.02, 0.04), h), _box(t, b, t, (0, b / 2, 0))]


def _dumbbell(rng: Generator) -> list[Solid]:
    r, end, long = rng.uniform(0.009, 0.016), rng.uniform(0.018, 0.034), rng.uniform(0.05, 0.1)
    side = turn(X, np.pi / 2)
    return [
        Solid("cylinder", (r, long / 2, 0), turned=side),
        Solid("sphere", (end, 0, 0), (0, long / 2, 0)),
        Solid("sphere", (end, 0, 0), (0, -long / 2, 0)),
    ]


def _around(radius: float, count: int, a: float, h: float, z: float = 0.0) -> list[Solid]:
    """A wall of plates that stand in a circle."""
    found, long = [], 2.1 * radius * np.tan(np.pi / count)
    for angle in np.arange(count) * 2 * np.pi / count:
        at = (float(radius * np.cos(angle)), float(radius * np.sin(angle)), z)
        found.append(Solid("box", (a / 2, long / 2, h / 2), at, turn((0.0, 0.0, 1.0), angle)))
    return found


def _ring(rng: Generator) -> list[Solid]:
    thick = rng.uniform(0.012, 0.026)
    return _around(rng.uniform(0.026, 0.06), 16, thick, rng.uniform(0.02, 0.035))


def _mug(rng: Generator) -> list[Solid]:
    r, h, t = rng.uniform(0.024, 0.04), rng.uniform(0.05, 0.1), rng.uniform(0.004, 0.007)
    out = r + rng.uniform(0.022, 0.034)
    handle = [_box(out - r, 0.01, 0.01, ((r + out) / 2, 0, z * h)) for z in (-0.25, 0.25)] + [
        _box(0.009, 0.01, 0.5 * h + 0.01, (out, 0, 0))
    ]
    base = Solid("cylinder", (r, t / 2, 0), (0, 0, -h / 2 + t / 2))
    return [*_around(r, 16, t, h), base, *handle]


def _tray(rng: Generator) -> list[Solid]:
    """An open box."""
    x, y, h = rng.uniform(0.06, 0.16), rng.uniform(0.07, 0.18), rng.uniform(0.035, 0.08)
    t = rng.uniform(0.005, 0.014)
    return [
        _box(x, y, t, (0, 0, t / 2 - h / 2)),
        _box(x, t, h, (0, (y - t) / 2, 0)),
        _box(x, t, h, (0, (t - y) / 2, 0)),
        _box(t, y, h, ((x - t) / 2, 0, 0)),
        _box(t, y, h, ((t - x) / 2, 0, 0)),
    ]


def _superquadric(rng: Generator) -> list[Solid]:
    """|x/a|^p + |y/b|^p + |z/c|^p = 1, between a ball and a box, or pointed."""
    a, b, c = (float(v) for v in rng.uniform(0.017, 0.045, 3))
    power = float(np.exp(rng.uniform(np.log(1.2), np.log(6))))
    way = rng.normal(size=(160, 3))
    way /= (np.abs(way) ** power).sum(1, keepdims=True) ** (1 / power)
    return [Solid("hull", points=way * np.array([a, b, c]))]


def _hull(rng: Generator) -> list[Solid]:
    """The hull of a few points: a stone."""
    return [Solid("hull", points=rng.uniform(-1, 1, (14, 3)) * rng.uniform(0.02, 0.045, 3))]


def _stack(rng: Generator) -> list[Solid]:
    """A block on a block, as toy houses and trains are."""
    x, y, h = rng.uniform(0.03, 0.07), rng.uniform(0.05, 0.13), rng.uniform(0.02, 0.045)
    u, v, k = x * rng.uniform(0.4, 1), y * rng.uniform(0.2, 0.7), rng.uniform(0.02, 0.05)
    off = float(rng.uniform(-0.5, 0.5) * (y - v))
    return [_box(x, y, h), _box(u, v, k, (0, off, (h + k) / 2))]


def _cross(rng: Generator) -> list[Solid]:
    t, a, b = rng.uniform(0.016, 0.03), rng.uniform(0.06, 0.12), rng.uniform(0.06, 0.12)
    h = rng.uniform(0.022, 0.05)
    return [_box(a, t, h), _box(t, b, h)]


def _prism(rng: Generator) -> list[Solid]:
    """Of three sides."""
    r, h = rng.uniform(0.026, 0.042), rng.uniform(0.025, 0.1)
    angles = np.arange(3) * 2 * np.pi / 3
    flat = np.stack([r * np.cos(angles), r * np.sin(angles)], -1)
    ends = [np.column_stack([flat, np.full(3, z)]) for z in (-h / 2, h / 2)]
    return [Solid("hull", points=np.concatenate(ends))]


def _bowl(rng: Generator) -> list[Solid]:
    """Walls that lean outwards, on a base."""
    r, h, t = rng.uniform(0.03, 0.05), rng.uniform(0.035, 0.06), rng.uniform(0.006, 0.01)
    low = [Solid("cylinder", (r, t / 2, 0), (0, 0, -h / 2))]
    return [*low, *_around(r, 16, t, h / 2, -h / 4), *_around(r + 0.7 * t, 16, t, h / 2, h / 4)]


def _spool(rng: Generator) -> list[Solid]:
    r, end = rng.uniform(0.012, 0.02), rng.uniform(0.026, 0.038)
    h, t = rng.uniform(0.05, 0.09), rng.uniform(0.006, 0.012)
    plates = [Solid("cylinder", (end, t / 2, 0), (0, 0, z)) for z in (-h / 2, h / 2)]
    return [Solid("cylinder", (r, h / 2, 0)), *plates]


def _horseshoe(rng: Generator) -> list[Solid]:
    t, a, b = rng.uniform(0.016, 0.026), rng.uniform(0.07, 0.11), rng.uniform(0.05, 0.1)
    h = rng.uniform(0.022, 0.05)
    arms = [_box(t, b, h, (s * (a - t) / 2, (b - t) / 2, 0)) for s in (-1, 1)]
    return [_box(a, t, h), *arms]


Make = Callable[[Generator], list[Solid]]
TAUGHT: Mapping[str, Make] = {
    "box": _boxes,
    "cylinder": _cylinder,
    "capsule": _capsule,
    "egg": _egg,
    "corner": _corner,
    "tee": _tee,
    "dumbbell": _dumbbell,
    "ring": _ring,
    "mug": _mug,
    "tray": _tray,
    "superquadric": _superquadric,
    "stone": _hull,
    "stack": _stack,
}
"""Those that training draws."""
HELD_OUT: Mapping[str, Make] = {
    "cross": _cross,
    "prism": _prism,
    "bowl": _bowl,
    "spool": _spool,
    "horseshoe": _horseshoe,
}
"""Those that it never saw."""
STANDING = ("mug", "tray", "bowl", "ring")
"""Those that are put down as they stand."""


def shape(name: str, rng: Generator) -> Thing:
    """A thing of a family, its size drawn."""
    make = TAUGHT.get(name) or HELD_OUT[name]
    return Thing(name, tuple(make(rng)), upright=name in STANDING)
