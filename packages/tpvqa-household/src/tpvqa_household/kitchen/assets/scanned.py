"""The scanned things as families: each one thing, drawn in slightly different sizes."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets import pack
from tpvqa_household.kitchen.assets.apple import flesh
from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.crockery import GLAZES, rim_grasp
from tpvqa_household.kitchen.assets.family import Family
from tpvqa_household.kitchen.assets.mesh import Mesh, cut, joined
from tpvqa_household.kitchen.assets.model import Grasp, Model, Vec
from tpvqa_household.kitchen.assets.paint import Colour, one_of
from tpvqa_household.kitchen.assets.television import screen

WEIGHTS = {
    "plate": 0.4,
    "apple": 0.4,
    "tv": 0.25,
    "table": 0.2,
    "counter": 0.2,
    "sink": 0.3,
    "tvstand": 0.3,
    "wall_cabinet": 0.4,
}
"""How often a scanned training thing is drawn, against 1 for a procedural family."""
STAND_ON = ("table", "counter", "tvstand")


def _stretch(rng: Generator, kind: str) -> float:
    """Furniture has its size; small things vary."""
    return 1.0 if kind in (*STAND_ON, "sink", "wall_cabinet") else float(rng.uniform(0.92, 1.08))


def scanned(rng: Generator, *, entry: dict[str, Any]) -> Model:
    """A thing of the pack."""
    kind = str(entry["kind"])
    scale = _stretch(rng, kind)
    build = Builder()
    glaze = one_of(rng, GLAZES) if kind == "plate" and rng.random() < 0.6 else None
    for number, part in enumerate(entry["parts"]):
        r, g, b, alpha = part["rgba"]
        plain = glaze is not None and part["texture"] is None and min(r, g, b) > 0.5
        colour = (*glaze, alpha) if plain and glaze else (r, g, b, alpha)
        paint = build.paint(
            f"m{number}",
            colour,
            texture=pack.texture(part["texture"]) if part["texture"] else None,
            specular=part["specular"],
            shininess=part["shininess"],
        )
        build.encoded(f"p{number}", pack.encoded(part["mesh"]), paint, scale=scale)
    x, y, z = (scale * float(value) for value in entry["extent"])
    finish = FINISHES.get(kind, _small)
    return finish(build, rng, entry, scale, (x, y, z))


def _done(
    build: Builder,
    entry: dict[str, Any],
    extent: Vec,
    mass: float,
    *,
    grasps: tuple[Grasp, ...] = (),
    dish: list[tuple[float, float]] | None = None,
    half: Model | None = None,
    colour: Colour | None = None,
) -> Model:
    return build.done(
        str(entry["kind"]),
        extent,
        mass,
        grasps=grasps,
        dish=dish or (),
        half=half,
        colour=colour or build.paints[0].rgba[:3],
        creator=str(entry["creator"]),
        licence=str(entry["licence"]),
        pack=str(entry["pack"]),
    )


def _small(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    x, y, z = extent
    build.standing("box", extent)
    grasps = []
    if y < 0.13:
        grasps.append(Grasp((0, 0, 0.6 * z), (0, 1, 0), (0, 0, -1), width=0.95 * y))
    if x < 0.13:
        grasps.append(Grasp((0, 0, 0.6 * z), (1, 0, 0), (0, 1, 0), width=0.95 * x))
    return _done(build, entry, extent, min(0.1 + 300 * x * y * z, 5.0), grasps=tuple(grasps))


def _plate(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    _, y, z = extent
    dish = [(scale * float(r), scale * float(h)) for r, h in entry["dish"]]
    build.solid("cylinder", (0.4 * y, z / 4), (0, 0, z / 4))
    build.solid("cylinder", (0.5 * y, z / 4), (0, 0, 0.75 * z))
    flat = 0.22 * y
    build.top("middle", (0, 0, dish[0][1]), (flat, flat))
    return _done(build, entry, extent, 0.4, grasps=(rim_grasp(y / 2, z),), dish=dish)


def _bread(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    x, y, z = extent
    build.standing("box", (0.9 * x, 0.9 * y, z))
    grasps = (
        Grasp((0, 0, 0.6 * z), (0, 1, 0), (0, 0, -1), width=0.94 * y),
        Grasp((0, -0.2 * y, 0.5 * z), (0, 0, 1), (0, 1, 0), width=0.92 * z),
    )
    return _done(build, entry, extent, 0.5, grasps=grasps, colour=(0.7, 0.5, 0.3))


def _apple(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    radius = extent[0] / 2
    build.solid("sphere", (0.95 * radius,), (0, 0, 0.95 * radius))
    whole = [pack.mesh(part["mesh"]).scaled(scale) for part in entry["parts"]]
    grasps = (
        Grasp((0, 0, radius), axis=(1, 0, 0), approach=(0, 1, 0), width=1.9 * radius),
        Grasp((0, 0, radius), axis=(0, 1, 0), approach=(0, 0, -1), width=1.9 * radius),
    )
    return _done(
        build,
        entry,
        extent,
        0.16,
        grasps=grasps,
        colour=(0.6, 0.1, 0.1),
        half=_half(build, rng, entry, whole, radius),
    )


def _half(
    build: Builder, rng: Generator, entry: dict[str, Any], whole: list[Mesh], radius: float
) -> Model:
    """The scanned apple cut through its axis, on its back."""
    skin = max(range(len(whole)), key=lambda k: len(whole[k].faces))
    body, rim = cut(whole[skin])
    low, high = rim.min(axis=0), rim.max(axis=0)
    middle = (low + high) / 2
    order = np.argsort(np.arctan2(rim[:, 2] - middle[2], rim[:, 0] - middle[0]))
    loop = rim[order]
    n = len(loop)
    points = np.r_[loop, [middle]]
    uv = (points[:, [0, 2]] - low[[0, 2]]) / (high - low)[[0, 2]]
    face = Mesh.of(points, [[n, (k + 1) % n, k] for k in range(n)], uv)
    sheet = joined([face, face.flipped().moved(y=-0.001)])
    half = Builder()
    height = float(high[2] - low[2])
    paint = build.paints[skin]
    half.paint(
        "skin",
        paint.rgba,
        texture=build.files[paint.texture] if paint.texture else None,
        specular=paint.specular,
    )
    half.paint("flesh", texture=flesh(rng, radius, height), specular=0.15)
    for name, mesh in (("skin", body), ("flesh", sheet)):
        flat = mesh.moved(z=-float(middle[2])).turned(0, 90).moved(z=-float(body.low[1]))
        half.mesh(name, flat, name, role=name, crease=70)
    half.solid("cylinder", (0.85 * radius, 0.46 * radius), (0, 0, 0.5 * radius))
    return half.done(
        "apple_half",
        (2 * radius, height, radius),
        0.08,
        grasps=(Grasp((0, 0, 0.6 * radius), (1, 0, 0), (0, 0, -1), width=1.8 * radius),),
        colour=(0.95, 0.9, 0.7),
        creator=str(entry["creator"]),
        licence=str(entry["licence"]),
        pack=str(entry["pack"]),
    )


def _knife(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    x, y, z = extent
    build.solid("box", (x / 2, max(y / 4, 0.008), z / 2), (0, 0, z / 2))
    hold = (-0.28 * x, 0.0, z / 2)
    grasps = (
        Grasp(hold, (0, 1, 0), (1, 0, 0), width=0.02),
        Grasp(hold, (0, 1, 0), (0, 0, -1), width=0.02),
    )
    return _done(build, entry, extent, 0.12, grasps=grasps)


def _tv(build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec) -> Model:
    low, high = (np.array(corner) * scale for corner in entry["screen"])
    middle = (low + high) / 2
    screen(
        build,
        rng,
        float(high[0] - low[0]),
        float(high[2] - low[2]),
        pos=(float(middle[0]), float(low[1]) - 0.002, float(middle[2])),
        held_out=bool(entry["held_out"]),
    )
    build.standing("box", extent)
    return _done(build, entry, extent, 9.0)


def _top(build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec) -> Model:
    x, y, z = extent
    if entry["kind"] == "table":
        build.solid("box", (x / 2, y / 2, 0.025), (0, 0, z - 0.025))
    else:
        build.standing("box", extent)
    build.top("top", (0, 0, z), (0.48 * x, 0.45 * y))
    return _done(build, entry, extent, 30.0)


def _sink(
    build: Builder, rng: Generator, entry: dict[str, Any], scale: float, extent: Vec
) -> Model:
    x, y, _ = extent
    (cx, cy, floor), (hx, hy) = entry["basin"]["pos"], entry["basin"]["half"]
    top = float(entry["basin"]["top"][0])
    build.solid("box", (x / 2, y / 2, floor / 2), (0, 0, floor / 2))
    half, middle = (top - floor) / 2, (top + floor) / 2
    for sign in (-1, 1):
        wide = x / 2 - sign * cx - hx
        build.solid("box", (wide / 2, y / 2, half), (sign * (x - wide) / 2, 0, middle))
        deep = y / 2 - sign * cy - hy
        build.solid("box", (hx, deep / 2, half), (cx, sign * (y - deep) / 2, middle))
    build.top("basin", (cx, cy, floor), (0.85 * hx, 0.85 * hy), top - floor + 0.3)
    room = max(x / 2 - cx - hx, x / 2 + cx - hx)
    side = 1 if x / 2 - cx - hx >= x / 2 + cx - hx else -1
    build.top("top", (side * (x - room) / 2, 0, top), (room / 2, 0.45 * y))
    return _done(build, entry, extent, 45.0)


Finish = Callable[[Builder, Generator, dict[str, Any], float, Vec], Model]
FINISHES: dict[str, Finish] = {
    "plate": _plate,
    "bread": _bread,
    "apple": _apple,
    "knife": _knife,
    "tv": _tv,
    "sink": _sink,
    **dict.fromkeys(STAND_ON, _top),
}


def _apple_half(rng: Generator, *, entry: dict[str, Any]) -> Model:
    whole = scanned(rng, entry=entry)
    assert whole.half is not None
    return whole.half


def scanned_families() -> tuple[Family, ...]:
    """One family for each thing in the pack."""
    found = []
    for entry in pack.index():
        kind, name, held = str(entry["kind"]), str(entry["name"]), bool(entry["held_out"])
        make = partial(scanned, entry=entry)
        weight = 1.0 if held else WEIGHTS.get(kind, 0.7)
        found.append(Family(kind, name, make, held, weight, fixed=1))
        if kind == "apple":
            halves = partial(_apple_half, entry=entry)
            found.append(Family("apple_half", f"{name}-half", halves, held, weight, fixed=1))
    return tuple(found)
