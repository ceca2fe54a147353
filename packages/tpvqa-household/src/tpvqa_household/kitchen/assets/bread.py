"""Loaves: tin loaf, round loaf, baguette, roll; held out: sliced loaf and plaited loaf."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, joined
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, clouds, mix, near, one_of, png
from tpvqa_household.kitchen.assets.shapes import surface

GOLD: tuple[Colour, ...] = ((0.8, 0.56, 0.28), (0.72, 0.45, 0.2), (0.62, 0.37, 0.17))
DARK: Colour = (0.4, 0.2, 0.08)
CRUMB: Colour = (0.93, 0.84, 0.64)


def _sweep(length: float, ring: Floats, taper: Floats, at: Floats) -> Mesh:
    """A closed (y, z) ring drawn along x; `taper` scales it at each place `at` (0..1)."""
    low = ring[:, 1].min()
    grid = np.empty((len(at), len(ring), 3))
    grid[..., 0] = (at[:, None] - 0.5) * length
    grid[..., 1] = taper[:, :1] * ring[None, :, 0]
    grid[..., 2] = low + taper[:, 1:] * (ring[None, :, 1] - low)
    return surface(grid)


def _round_ends(at: Floats, blunt: float, floor: float = 0.0) -> Floats:
    """Scale factors for width and height that close a body at both ends."""
    end = (1 - np.abs(2 * at - 1) ** blunt) ** (1 / 2.2)
    return np.stack([end, floor + (1 - floor) * end], axis=1)


def _ring(width: float, height: float, *, steps: int, square: float, dome: float) -> Floats:
    """A loaf's cross section, clockwise seen along +x, starting at the bottom middle."""
    angle = -np.pi / 2 - np.linspace(0, 2 * np.pi, steps + 1)
    c, s = np.cos(angle), np.sin(angle)
    y = np.sign(c) * np.abs(c) ** square * width / 2
    z = np.sign(s) * np.abs(s) ** square * height / 2 + height / 2
    y = y * (1 + dome * np.clip((z / height - 0.45) / 0.4, 0, 1) * np.clip(2 - z / height, 0, 1))
    return np.stack([y, z], axis=1)


def crust(rng: Generator, gold: Colour, *, cuts: int, slant: float, flour: float = 0.0) -> bytes:
    """A crust wrapped around a loaf: pale below, dark on top, with cuts showing the crumb."""
    height, width = 128, 192
    around = np.abs(np.linspace(-1, 1, height))[:, None] * np.ones((1, width))
    top = 1 - around  # 1 on top, 0 below
    patches = clouds(rng, height, width, rows=4, columns=6, octaves=4)
    picture = mix(gold, DARK, (top**1.5) * 0.55 + (patches - 0.5) * 0.7)
    picture = mix(picture, near(rng, (0.86, 0.68, 0.42)), np.clip(0.35 - top, 0, 1) * 1.6)
    x = np.linspace(0, 1, width)[None, :]
    v = np.linspace(-1, 1, height)[:, None]
    for k in range(cuts):
        middle = (k + 0.5 + rng.normal(0, 0.06)) / cuts
        off = np.abs(x - middle - slant * v * 0.5)
        reach = np.clip(0.42 - np.abs(v), 0, 1)
        depth = np.clip(1 - off / (0.02 + 0.035 * np.sqrt(reach)), 0, 1) * (reach > 0)
        picture = mix(picture, (0.94, 0.8, 0.55), depth * 1.3)
    if flour:
        speck = clouds(rng, height, width, rows=16, columns=24, octaves=3)
        picture = mix(picture, (0.95, 0.92, 0.86), np.clip(speck - 0.62, 0, 1) * 3 * flour * top)
    return png(picture)


def _grasps(width: float, height: float) -> tuple[Grasp, ...]:
    return (
        Grasp((0, 0, 0.6 * height), axis=(0, 1, 0), approach=(0, 0, -1), width=0.94 * width),
        Grasp((0, -0.2 * width, 0.5 * height), (0, 0, 1), (0, 1, 0), width=0.92 * height),
    )


def _finish(build: Builder, x: float, y: float, z: float, gold: Colour) -> Model:
    build.standing("box", (0.9 * x, 0.85 * y, z))
    return build.done("bread", (x, y, z), 0.3 + x * y * z * 150, grasps=_grasps(y, z), colour=gold)


def tin_loaf(rng: Generator) -> Model:
    """A boxy loaf from a tin, its top domed over the sides."""
    x, y, z = rng.uniform(0.18, 0.27), rng.uniform(0.09, 0.12), rng.uniform(0.085, 0.12)
    gold = one_of(rng, GOLD, 0.09)
    build = Builder()
    skin = build.paint(
        "crust",
        texture=crust(rng, gold, cuts=int(rng.integers(0, 3)), slant=rng.uniform(-0.3, 0.3)),
    )
    at = np.r_[0, 0.012, 0.035, np.linspace(0.08, 0.92, 10), 0.965, 0.988, 1]
    ring = _ring(y * 0.92, z, steps=28, square=0.5, dome=0.05)
    taper = _round_ends(at, 14, 0.35)
    taper[[0, -1]] = [[0, 0.4]] * 2
    build.mesh("loaf", _sweep(x, ring, taper, at), skin, crease=60)
    return _finish(build, x, y, z, gold)


def round_loaf(rng: Generator) -> Model:
    """A round or oval country loaf with a cross or stripes cut into it."""
    x = rng.uniform(0.15, 0.23)
    y, z = x * rng.uniform(0.8, 1.0), x * rng.uniform(0.4, 0.55)
    gold = one_of(rng, GOLD, 0.09)
    build = Builder()
    skin = build.paint("crust", texture=_seen_from_above(rng, gold))
    rows, columns = 14, 30
    v = np.linspace(-np.pi / 2, np.pi / 2, rows)
    u = np.linspace(0, 2 * np.pi, columns + 1)
    wave = 1 + 0.03 * np.sin(3 * u + rng.uniform(0, 6)) + 0.02 * np.sin(5 * u + rng.uniform(0, 6))
    height = np.where(v < 0, 0.35 * np.sin(v), np.sin(v)) * z / 1.35 + z * 0.35 / 1.35
    grid = np.stack(
        [
            np.outer(np.cos(u) * wave, np.cos(v) ** 0.8) * x / 2,
            np.outer(np.sin(u) * wave, np.cos(v) ** 0.8) * y / 2,
            np.outer(np.ones_like(u), height),
        ],
        -1,
    )
    mesh = surface(grid)
    uv = 0.5 + 0.47 * mesh.points[:, :2] / (np.array([x, y]) / 2 * 1.05)
    build.mesh("loaf", mesh.mapped(uv), skin, crease=60)
    return _finish(build, x, y, z, gold)


def _seen_from_above(rng: Generator, gold: Colour) -> bytes:
    size = 160
    y, x = np.mgrid[0:size, 0:size] / size * 2 - 1
    r = np.hypot(x, y)
    patches = clouds(rng, size, size, rows=5, columns=5)
    picture = mix(gold, DARK, 0.35 + (patches - 0.5) * 0.9 - 0.5 * np.clip(r - 0.6, 0, 1))
    flour = clouds(rng, size, size, rows=12, columns=12, octaves=3)
    amount = rng.uniform(0, 1)
    picture = mix(picture, (0.95, 0.92, 0.86), np.clip(flour - 0.5, 0, 1) * 2.4 * amount)
    pattern = str(rng.choice(["cross", "stripes", "square", "leaf"]))
    turn = rng.uniform(0, np.pi)
    a, b = x * np.cos(turn) + y * np.sin(turn), y * np.cos(turn) - x * np.sin(turn)
    lines = {
        "cross": [a, b],
        "stripes": [a - 0.35, a, a + 0.35],
        "square": [a - 0.4, a + 0.4, b - 0.4, b + 0.4],
        "leaf": [b, a * 0.8 + np.abs(b) - 0.35, a * 0.8 + np.abs(b), a * 0.8 + np.abs(b) + 0.35],
    }[pattern]
    for line in lines:
        reach = np.clip(0.8 - r, 0, 1)
        picture = mix(picture, (0.95, 0.83, 0.6), (np.abs(line) < 0.075 * np.sqrt(reach)) * 0.9)
    return png(picture)


def baguette(rng: Generator) -> Model:
    """A long thin loaf with slanting cuts."""
    x, y = rng.uniform(0.3, 0.42), rng.uniform(0.055, 0.08)
    z = y * rng.uniform(0.7, 0.85)
    return _long_loaf(rng, x, y, z, int(rng.integers(3, 6)))


def roll(rng: Generator) -> Model:
    """A short oval roll with one to three cuts."""
    x, y = rng.uniform(0.13, 0.2), rng.uniform(0.075, 0.1)
    return _long_loaf(rng, x, y, y * rng.uniform(0.65, 0.8), int(rng.integers(1, 4)))


def _long_loaf(rng: Generator, x: float, y: float, z: float, cuts: int) -> Model:
    gold = one_of(rng, GOLD, 0.09)
    build = Builder()
    skin = build.paint(
        "crust",
        texture=crust(
            rng,
            gold,
            cuts=cuts,
            slant=rng.choice([-1, 1]) * rng.uniform(0.1, 0.25),
            flour=rng.uniform(0, 1),
        ),
    )
    at = 0.5 - 0.5 * np.cos(np.linspace(0, np.pi, 20))
    swell = 1 + 0.05 * np.sin(at * cuts * 2 * np.pi)[:, None]
    taper = _round_ends(at, rng.uniform(2.2, 3.5), 0.1) * swell
    build.mesh(
        "loaf", _sweep(x, _ring(y, z, steps=20, square=0.8, dome=0.0), taper, at), skin, crease=60
    )
    return _finish(build, x, y, z, gold)


def sliced_loaf(rng: Generator) -> Model:
    """Held out: a loaf cut into slices, some of them fallen over, crumb in view."""
    y, z = rng.uniform(0.09, 0.12), rng.uniform(0.09, 0.12)
    gold = one_of(rng, GOLD, 0.09)
    build = Builder()
    skin = build.paint("crust", near(rng, gold))
    size = 96
    pores = clouds(rng, size, size, rows=12, columns=12, octaves=3)
    crumb = build.paint(
        "crumb",
        texture=png(mix(near(rng, CRUMB, 0.03), (0.8, 0.66, 0.42), np.clip(pores - 0.6, 0, 1) * 2)),
    )
    ring = _ring(y * 0.94, z, steps=24, square=0.45, dome=0.1)
    thick = rng.uniform(0.011, 0.016)
    count = int(rng.integers(4, 8))
    body = rng.uniform(0.05, 0.1)
    crusts, faces = [], []
    place = 0.0
    for k in range(count + 1):
        wide = body if k == 0 else thick
        lean = 0.0 if k == 0 else min(8.0 * k + rng.uniform(-3, 3), 62) * (0.3 if k < 2 else 1)
        rim, sides = _slice(ring, wide, closed=k == 0)
        rise = 0.0
        moved = []
        for mesh in (rim, sides):
            turned = mesh.turned(1, lean)
            moved.append(turned)
        rise = -min(m.low[2] for m in moved)
        crusts.append(moved[0].moved(x=place, z=rise))
        faces.append(moved[1].moved(x=place, z=rise))
        place += wide / 2 + (thick / 2) / max(np.cos(np.radians(lean)), 0.35) + 0.003
    low = min(m.low[0] for m in crusts)
    high = max(m.high[0] for m in crusts)
    shift = -(low + high) / 2
    build.mesh("crust", joined(crusts).moved(x=shift), skin)
    build.mesh("crumb", joined(faces).moved(x=shift), crumb)
    return _finish(build, high - low, y, z, gold)


def _slice(ring: Floats, wide: float, *, closed: bool) -> tuple[Mesh, Mesh]:
    grid = np.empty((2, len(ring), 3))
    grid[..., 1:] = ring
    grid[0, :, 0], grid[1, :, 0] = -wide / 2, wide / 2
    rim = surface(grid)
    n = len(ring)
    middle = ring.mean(axis=0)
    low, span = ring.min(axis=0), np.ptp(ring, axis=0)
    caps = []
    for x, out in ((-wide / 2, -1), (wide / 2, 1)):
        points = np.c_[np.full(n + 1, x), np.r_[ring, [middle]]]
        uv = (np.r_[ring, [middle]] - low) / span
        fan = [[n, k + 1, k] if out > 0 else [n, k, k + 1] for k in range(n - 1)]
        caps.append(Mesh.of(points, fan, uv))
    if closed:  # the uncut end of the loaf has crust
        rim = joined([rim, caps.pop(0)])
    return rim, joined(caps)


def plaited_loaf(rng: Generator) -> Model:
    """Held out: three strands plaited, glossy."""
    x = rng.uniform(0.22, 0.32)
    y, z = x * rng.uniform(0.34, 0.42), rng.uniform(0.055, 0.08)
    gold = one_of(rng, ((0.72, 0.42, 0.15), (0.6, 0.32, 0.12)))
    build = Builder()
    skin = build.paint(
        "crust", texture=crust(rng, gold, cuts=0, slant=0.0), specular=0.45, shininess=0.5
    )
    turns = rng.uniform(2.2, 3.2)
    t = np.linspace(0, 1, 34)
    strands = []
    swell = np.sqrt(np.clip(1 - np.abs(2 * t - 1) ** 2.6, 0, 1))
    for k in range(3):
        phase = 2 * np.pi * (turns * t + k / 3)
        path = np.stack(
            [
                (t - 0.5) * x * 0.96,
                np.sin(phase) * 0.27 * y * swell,
                (0.5 + 0.18 * np.sin(2 * phase)) * z,
            ],
            axis=1,
        )
        radius = np.maximum(0.24 * y * swell, 0.003)
        strands.append(_strand(path, radius))
    mesh = joined(strands)
    mesh = Mesh(mesh.points - [0, 0, mesh.low[2]], mesh.uv, mesh.faces)
    build.mesh("loaf", mesh, skin, crease=70)
    extent = mesh.high - mesh.low
    return _finish(build, float(extent[0]), float(extent[1]), float(extent[2]), gold)


def _strand(path: Floats, radius: Floats) -> Mesh:
    from tpvqa_household.kitchen.assets.shapes import tube

    mesh = tube(path, radius, steps=9, flat=1.0)
    height = (mesh.points[:, 2] - mesh.low[2]) / np.ptp(mesh.points[:, 2])
    length = (mesh.points[:, 0] - mesh.low[0]) / np.ptp(mesh.points[:, 0])
    return mesh.mapped(np.stack([length, 0.5 * height], axis=1))
