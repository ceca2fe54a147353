"""Sinks: a cabinet whose worktop has a basin and a tap.

Surface "basin" is the basin's floor, "top" the larger free side of the worktop, "drainer" the
ribbed side where there is one.
"""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.furniture import DEPTH, HEIGHT, TOP, cabinet, textured
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, joined
from tpvqa_household.kitchen.assets.model import Model
from tpvqa_household.kitchen.assets.paint import Colour, near, one_of
from tpvqa_household.kitchen.assets.shapes import box, lathe, tube

STEEL: Colour = (0.7, 0.72, 0.74)


def _squircle(x: float, y: float, power: float, steps: int) -> Floats:
    angle = np.linspace(0, 2 * np.pi, steps, endpoint=False)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack(
        [np.sign(c) * np.abs(c) ** power * x / 2, np.sign(s) * np.abs(s) ** power * y / 2], 1
    )


def _rings(loops: list[tuple[Floats, float]], *, close: bool) -> Mesh:
    """Loops at heights, joined from each to the next; outside is left of going inwards."""
    n = len(loops[0][0])
    points = np.concatenate([np.c_[xy, np.full(n, z)] for xy, z in loops])
    faces = []
    for k in range(len(loops) - 1):
        for i in range(n):
            a, b = k * n + i, k * n + (i + 1) % n
            faces += [[a, b, b + n], [a, b + n, a + n]]
    if close:
        points = np.r_[points, [[*loops[-1][0].mean(axis=0), loops[-1][1]]]]
        last = (len(loops) - 1) * n
        faces += [[last + i, last + (i + 1) % n, len(points) - 1] for i in range(n)]
    return Mesh.of(points, faces, points[:, :2] * 2)


def _on_rectangle(loop: Floats, x: float, y: float) -> Floats:
    """The points of a loop pushed straight outwards onto a rectangle about the origin."""
    scale = np.minimum(
        x / 2 / np.maximum(np.abs(loop[:, 0]), 1e-9), y / 2 / np.maximum(np.abs(loop[:, 1]), 1e-9)
    )
    pushed = loop * scale[:, None]
    corners = np.array([(a * x / 2, b * y / 2) for a in (-1, 1) for b in (-1, 1)])
    for corner in corners:
        pushed[np.argmin(np.linalg.norm(pushed - corner, axis=1))] = corner
    return np.asarray(pushed)


def _tap(style: str, high: float, reach: float) -> Mesh:
    """A tap that stands on the origin and reaches towards -y."""
    foot = lathe([(0, 0), (0.026, 0), (0.026, 0.008), (0.016, 0.02), (0, 0.02)], steps=14)
    if style == "arch":
        t = np.linspace(0, np.pi, 10)
        arc = np.stack([0 * t, reach / 2 * (np.cos(t) - 1), high + reach / 2 * np.sin(t)], 1)
        path = np.r_[[[0, 0, 0.01]], arc, [[0, -reach, high - 0.06]]]
        lever = tube([[0.015, 0, 0.07], [0.06, -0.01, 0.09]], 0.006, steps=6)
        return joined([foot, tube(path, 0.011, steps=9), lever])
    if style == "straight":
        post = tube([[0, 0, 0], [0, 0, 0.12]], 0.018, steps=10)
        spout = tube(
            [[0, 0, 0.1], [0, -reach / 2, 0.13], [0, -reach, 0.12], [0, -reach, 0.1]],
            0.012,
            steps=9,
        )
        lever = tube([[0, 0, 0.125], [0, -0.05, 0.16]], [0.012, 0.008], steps=8)
        return joined([foot, post, spout, lever])
    # Two taps with a bridge.
    cross = [tube([[s * 0.09, 0, 0], [s * 0.09, 0, 0.07]], 0.012, steps=8) for s in (-1, 1)]
    handles = [
        tube([[s * 0.09 - 0.03, 0, 0.075], [s * 0.09 + 0.03, 0, 0.075]], 0.006, steps=6)
        for s in (-1, 1)
    ]
    bridge = tube([[-0.09, 0, 0.045], [0.09, 0, 0.045]], 0.01, steps=8)
    t = np.linspace(0, np.pi, 9)
    arc = np.stack([0 * t, reach / 2 * (np.cos(t) - 1), 0.16 + reach / 2 * np.sin(t)], 1)
    spout = tube(np.r_[[[0, 0, 0.045]], arc], 0.01, steps=8)
    return joined([*cross, *handles, bridge, spout])


def sink(rng: Generator) -> Model:
    """A steel or ceramic basin, square to round, set into a cabinet's worktop."""
    x = float(rng.choice([0.8, 0.9, 1.0]))
    square = rng.random() < 0.65
    wide = rng.uniform(0.4, 0.5) if square else rng.uniform(0.38, 0.43)
    deep = rng.uniform(0.34, 0.4) if square else wide
    power = rng.uniform(0.2, 0.4) if square else 1.0
    side = float(rng.choice([-1, 0, 1])) if x > 0.85 else 0.0
    return _sink(
        rng,
        x,
        wide,
        deep,
        power,
        at=side * (x - wide) / 2 * 0.55,
        held_out=False,
        steel=rng.random() < 0.65,
        tap=str(rng.choice(["arch", "straight"])),
        drainer=side != 0 and rng.random() < 0.7,
    )


def trough(rng: Generator) -> Model:
    """Held out: a broad white or copper trough with a bridge tap."""
    x = float(rng.choice([0.8, 0.9]))
    return _sink(
        rng,
        x,
        rng.uniform(0.6, 0.68),
        rng.uniform(0.38, 0.42),
        0.12,
        at=0.0,
        held_out=True,
        steel=False,
        tap="bridge",
        drainer=False,
    )


def _sink(
    rng: Generator,
    x: float,
    wide: float,
    deep: float,
    power: float,
    *,
    at: float,
    held_out: bool,
    steel: bool,
    tap: str,
    drainer: bool,
) -> Model:
    build, old = cabinet(rng, held_out=held_out, basin=0.24)
    grown = x / old
    build = _stretched(build, grown)
    scale = textured(build, rng, "worktop", "worktop", held_out=held_out)
    if steel:
        bowl = build.paint("bowl", near(rng, STEEL, 0.04), specular=0.7, shininess=0.6)
    elif held_out:
        colour = one_of(rng, ((0.93, 0.92, 0.9), (0.72, 0.45, 0.3)), 0.03)
        bowl = build.paint("bowl", colour, specular=0.5, shininess=0.6)
    else:
        colour = one_of(rng, ((0.95, 0.95, 0.94), (0.85, 0.82, 0.75), (0.2, 0.2, 0.21)), 0.03)
        bowl = build.paint("bowl", colour, specular=0.5, shininess=0.6)
    chrome = build.paint(
        "chrome",
        one_of(rng, ((0.82, 0.83, 0.85), (0.15, 0.15, 0.16), (0.75, 0.6, 0.32)), 0.03),
        specular=1.0,
        shininess=0.8,
    )
    dark = build.paint("drain", (0.08, 0.08, 0.08))
    y0 = -0.03
    depth = rng.uniform(0.15, 0.2)
    loop = _squircle(wide, deep, power, 36)
    outer = loop + np.array([at, y0 + 0.015])
    edge = _on_rectangle(loop, x, DEPTH + 0.03)
    # The rectangle is centred on the cabinet, the hole is not: keep corners and shift the rest.
    edge = np.clip(
        edge + np.array([at, y0 + 0.015]),
        [-x / 2, -(DEPTH + 0.03) / 2],
        [x / 2, (DEPTH + 0.03) / 2],
    )
    for corner in [(a * x / 2, b * (DEPTH + 0.03) / 2) for a in (-1, 1) for b in (-1, 1)]:
        edge[np.argmin(np.linalg.norm(edge - corner, axis=1))] = corner
    edge = _snapped(edge, x, DEPTH + 0.03)
    slab = _rings(
        [(edge, HEIGHT - TOP), (edge, HEIGHT), (outer, HEIGHT), (outer, HEIGHT - TOP)], close=False
    )
    slab = slab.moved(y=-0.015)
    build.mesh("worktop", slab.mapped(slab.points[:, :2] * scale), "worktop", role="top", crease=30)
    rim = 1.05
    floor = HEIGHT - depth
    bowl_mesh = _rings(
        [
            (loop * rim, HEIGHT),
            (loop * rim, HEIGHT + 0.004),
            (loop * 0.985, HEIGHT + 0.004),
            (loop * 0.97, HEIGHT - 0.008),
            (loop * 0.93, floor + 0.02),
            (loop * 0.86, floor),
            (loop * 0.1, floor - 0.004),
        ],
        close=True,
    ).moved(x=at, y=y0)
    build.mesh("bowl", bowl_mesh, bowl, role="basin", crease=50)
    build.shape("drain", "cylinder", (0.026, 0.003), dark, pos=(at, y0, floor - 0.001))
    build.shape("strainer", "cylinder", (0.036, 0.002), chrome, pos=(at, y0, floor - 0.001))
    reach = 0.5 * deep
    build.mesh(
        "tap",
        _tap(tap, rng.uniform(0.16, 0.28), reach).moved(x=at, y=y0 + deep / 2 + 0.045, z=HEIGHT),
        chrome,
        role="tap",
        crease=60,
    )
    free = -np.sign(at) if at else 1.0
    room = x / 2 + abs(at) - wide / 2
    side = free * (x / 2 - room / 2)
    if drainer:
        ribs = [
            box(0.012, deep * 0.85, 0.005, bevel=0.002).moved(x=side + d, y=y0, z=HEIGHT)
            for d in np.arange(-0.4, 0.41, 0.1) * room
        ]
        build.mesh(
            "drainer",
            joined([box(room * 0.92, deep * 0.98, 0.003).moved(x=side, y=y0, z=HEIGHT), *ribs]),
            bowl,
        )
    if held_out:
        apron = box(wide + 0.05, 0.04, depth + 0.02, bevel=0.012)
        build.mesh("apron", apron.moved(x=at, y=-DEPTH / 2 - 0.04, z=floor - 0.005), bowl)
    _solids(build, x, wide, deep, at, y0, floor)
    build.top("basin", (at, y0, floor), (0.42 * wide, 0.42 * deep), depth + 0.3)
    build.top("top", (float(side), 0, HEIGHT), (room / 2, DEPTH / 2))
    return build.done("sink", (x, DEPTH + 0.06, HEIGHT + 0.3), 45.0)


def _snapped(edge: Floats, x: float, y: float) -> Floats:
    """Every point onto the nearest side of the rectangle."""
    out = edge.copy()
    gaps = np.stack([x / 2 - np.abs(out[:, 0]), y / 2 - np.abs(out[:, 1])], 1)
    for k, gap in enumerate(gaps):
        if gap.min() > 1e-9:
            axis = int(np.argmin(gap))
            out[k, axis] = np.sign(out[k, axis]) * (x if axis == 0 else y) / 2
    return np.asarray(out)


def _solids(
    build: Builder, x: float, wide: float, deep: float, at: float, y0: float, floor: float
) -> None:
    build.solids.clear()
    build.solid("box", (x / 2, DEPTH / 2, (floor - 0.004) / 2), (0, 0, (floor - 0.004) / 2))
    middle, half = (HEIGHT + floor) / 2, (HEIGHT - floor) / 2
    left, right = at - 0.48 * wide + x / 2, x / 2 - at - 0.48 * wide
    build.solid("box", (left / 2, DEPTH / 2, half), (-x / 2 + left / 2, 0, middle))
    build.solid("box", (right / 2, DEPTH / 2, half), (x / 2 - right / 2, 0, middle))
    front, back = y0 - 0.48 * deep + DEPTH / 2, DEPTH / 2 - y0 - 0.48 * deep
    build.solid("box", (0.48 * wide, front / 2, half), (at, -DEPTH / 2 + front / 2, middle))
    build.solid("box", (0.48 * wide, back / 2, half), (at, DEPTH / 2 - back / 2, middle))


def _stretched(build: Builder, factor: float) -> Builder:
    """The cabinet's meshes drawn out along x by MuJoCo's mesh scale."""
    from dataclasses import replace

    build.parts = [
        replace(part, size=(factor, 1.0, 1.0)) if part.mesh else part for part in build.parts
    ]
    return build
