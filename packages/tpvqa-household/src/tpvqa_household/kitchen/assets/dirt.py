"""Leftovers on a plate, in styles; some styles are held out.

`soiled` adds them to any plate as parts with the role "dirt"; a scene shows or hides these.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, joined
from tpvqa_household.kitchen.assets.model import Model
from tpvqa_household.kitchen.assets.paint import Colour, near
from tpvqa_household.kitchen.assets.shapes import blob, surface, tube

COLOURS: tuple[Colour, ...] = (
    (0.36, 0.2, 0.09),
    (0.55, 0.33, 0.13),
    (0.68, 0.14, 0.06),
    (0.3, 0.42, 0.1),
    (0.85, 0.62, 0.12),
    (0.2, 0.1, 0.06),
)
LEAST = 0.14
"""Share of the plate that is covered at least, seen from above."""

Style = Callable[[Generator, float], Mesh]
"""Draws flat dirt within a radius; z is its thickness."""


def _patch(rng: Generator, x: float, y: float, radius: float, thick: float) -> Mesh:
    """A round-edged puddle with lobes."""
    angle = np.linspace(0, 2 * np.pi, 33)
    edge = np.ones(33)
    for k in (2, 3, 5, 7):
        edge += rng.uniform(0, 0.55 / k) * np.sin(k * angle + rng.uniform(0, 6.3))
    share = np.array([1.0, 0.9, 0.6, 0.02])
    lift = thick * np.array([0.0, 0.7, 1.0, 1.0])
    reach = radius * np.outer(share, edge)
    grid = np.stack(
        [x + reach * np.cos(angle), y + reach * np.sin(angle), lift[:, None] + 0 * reach], -1
    )
    return surface(grid.transpose(1, 0, 2))


def _within(rng: Generator, radius: float) -> tuple[float, float]:
    r, a = radius * np.sqrt(rng.random()), rng.uniform(0, 2 * np.pi)
    return float(r * np.cos(a)), float(r * np.sin(a))


def sauce(rng: Generator, radius: float) -> Mesh:
    """One large puddle and a few drops."""
    x, y = _within(rng, 0.25 * radius)
    parts = [_patch(rng, x, y, radius * rng.uniform(0.45, 0.65), 0.0022)]
    parts += [
        _patch(rng, *_within(rng, 0.85 * radius), radius * rng.uniform(0.04, 0.1), 0.002)
        for _ in range(int(rng.integers(2, 7)))
    ]
    return joined(parts)


def blotches(rng: Generator, radius: float) -> Mesh:
    """Several middle-sized spots."""
    return joined(
        _patch(rng, *_within(rng, 0.7 * radius), radius * rng.uniform(0.12, 0.28), 0.002)
        for _ in range(int(rng.integers(4, 9)))
    )


def splatter(rng: Generator, radius: float) -> Mesh:
    """Many drops."""
    return joined(
        _patch(rng, *_within(rng, 0.88 * radius), radius * rng.uniform(0.04, 0.14), 0.0018)
        for _ in range(int(rng.integers(14, 24)))
    )


def _stroke(path: Floats, width: Floats, thick: float) -> Mesh:
    along = np.gradient(path, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    side = np.stack([-along[:, 1], along[:, 0]], 1)
    across = np.array([-1.0, -0.7, 0.0, 0.7, 1.0])
    lift = thick * np.array([0.0, 0.8, 1.0, 0.8, 0.0])
    flat = path[:, None] + side[:, None] * (width[:, None] * across)[..., None]
    height = np.broadcast_to(lift, flat.shape[:2])
    return surface(np.concatenate([flat, height[..., None]], -1))


def smears(rng: Generator, radius: float) -> Mesh:
    """Sauce wiped across the plate in arcs."""
    strokes = []
    for _ in range(int(rng.integers(3, 6))):
        t = np.linspace(0, 1, 14)
        start, turn = rng.uniform(0, 6.3), rng.choice([-1, 1]) * rng.uniform(0.8, 2.4)
        r = radius * (rng.uniform(0.15, 0.75) + rng.uniform(-0.1, 0.1) * t)
        angle = start + turn * t
        path = np.stack([r * np.cos(angle), r * np.sin(angle)], 1)
        width = radius * rng.uniform(0.07, 0.15) * np.sqrt(np.sin(np.pi * (0.06 + 0.9 * t)))
        strokes.append(_stroke(path, width * (1 + 0.25 * np.sin(17 * t)), 0.0018))
    return joined(strokes)


def crumbs(rng: Generator, radius: float) -> Mesh:
    """Crumbs and bits, and a thin film below the most of them."""
    x, y = _within(rng, 0.3 * radius)
    parts = [_patch(rng, x, y, 0.42 * radius, 0.0008)]
    grain = blob(1, 1, 1, rows=4, columns=5)
    for _ in range(45):
        size = radius * rng.uniform(0.025, 0.075)
        bit = grain.scaled(size, size * rng.uniform(0.5, 1), size * 0.6)
        px, py = _within(rng, 0.8 * radius)
        parts.append(bit.turned(2, float(rng.uniform(0, 360))).moved(px, py))
    return joined(parts)


def noodles(rng: Generator, radius: float) -> Mesh:
    """Held out: loops of spaghetti in a little sauce."""
    parts = [_patch(rng, 0, 0, 0.4 * radius, 0.001)]
    for _ in range(7):
        t = np.linspace(0, 1, 22)
        x, y = _within(rng, 0.35 * radius)
        a, b = rng.uniform(2, 6, 2)
        size = radius * rng.uniform(0.25, 0.5)
        path = np.stack(
            [
                x + size * np.cos(a * t + rng.uniform(0, 6)),
                y + size * np.sin(b * t + rng.uniform(0, 6)),
                0.003 + rng.uniform(0, 0.004) + 0.001 * np.sin(9 * t),
            ],
            1,
        )
        parts.append(tube(path, 0.0024, steps=5))
    return joined(parts)


def peas(rng: Generator, radius: float) -> Mesh:
    """Held out: peas or beans on mash."""
    x, y = _within(rng, 0.3 * radius)
    parts = [_patch(rng, x, y, 0.45 * radius, 0.004)]
    ball = blob(1, 1, 1, rows=6, columns=8)
    for _ in range(26):
        size = rng.uniform(0.007, 0.011)
        parts.append(
            ball.scaled(size, size * rng.uniform(0.8, 1.4), size * 0.85).moved(
                *_within(rng, 0.7 * radius)
            )
        )
    return joined(parts)


def swirl(rng: Generator, radius: float) -> Mesh:
    """Held out: a line of sauce in a spiral or zigzag."""
    t = np.linspace(0, 1, 60)
    if rng.random() < 0.5:
        angle, r = 2 * np.pi * rng.uniform(2.2, 3.2) * t, radius * (0.1 + 0.65 * t)
        path = np.stack([r * np.cos(angle), r * np.sin(angle)], 1)
    else:
        path = np.stack(
            [radius * 0.6 * np.sin(2 * np.pi * rng.uniform(3, 4.5) * t), radius * 1.3 * (t - 0.5)],
            1,
        )
    wide = radius * rng.uniform(0.045, 0.07)
    return _stroke(path, wide * (1 + 0.2 * np.sin(31 * t)), 0.003)


def flakes(rng: Generator, radius: float) -> Mesh:
    """Held out: angular burnt flakes and a dried ring."""
    t = np.linspace(0, 2 * np.pi, 40)
    ring = np.stack([0.55 * radius * np.cos(t), 0.5 * radius * np.sin(t)], 1)
    parts = [_stroke(ring, radius * (0.05 + 0.03 * np.sin(3 * t + 1)), 0.0012)]
    for _ in range(16):
        x, y = _within(rng, 0.8 * radius)
        n = int(rng.integers(3, 6))
        angle = np.sort(rng.uniform(0, 2 * np.pi, n))
        size = radius * rng.uniform(0.06, 0.15)
        points = np.c_[x + size * np.cos(angle), y + size * np.sin(angle), np.full(n, 0.0018)]
        fan = [[0, k, k + 1] for k in range(1, n - 1)]
        parts.append(Mesh.of(points, fan))
    return joined(parts)


TRAIN: tuple[Style, ...] = (sauce, blotches, splatter, smears, crumbs)
HELD_OUT: tuple[Style, ...] = (noodles, peas, swirl, flakes)


def styles(*, held_out: bool) -> tuple[str, ...]:
    """The names of the styles of one split."""
    return tuple(style.__name__ for style in (HELD_OUT if held_out else TRAIN))


def soiled(plate: Model, rng: Generator, *, held_out: bool) -> Model:
    """The same plate with leftovers on it.

    Args:
        plate: A plate (anything with a `dish`).
        rng: Decides style, colour and place.
        held_out: In the styles that training never shows.

    Raises:
        ValueError: The thing has no `dish`.
    """
    if not plate.dish:
        raise ValueError(f"{plate.name} is no plate: nothing can lie on it")
    choice = HELD_OUT if held_out else TRAIN
    style = choice[int(rng.integers(len(choice)))]
    radius = max(r for r, _ in plate.dish)
    heights = np.array(sorted(plate.dish))
    build = Builder()
    colours = _seen_on(rng, plate.colour)
    covered, layer = 0.0, 0
    while covered < LEAST * np.pi * radius**2 and layer < 4:
        flat = style(rng, 0.92 * radius)
        covered += _area(flat)
        paint = build.paint(
            f"dirt{layer}", near(rng, colours[layer % 2], 0.05), specular=rng.uniform(0, 0.35)
        )
        build.mesh(
            f"dirt{layer}",
            _draped(flat, heights, 0.0009 + 0.0004 * layer),
            paint,
            role="dirt",
            crease=60,
        )
        layer += 1
    name = plate.name
    return replace(
        plate,
        paints=plate.paints + tuple(build.paints),
        parts=plate.parts + tuple(replace(part, mesh=f"{name}{part.mesh}") for part in build.parts),
        files={**plate.files, **{f"{name}{file}": data for file, data in build.files.items()}},
    ).named(f"{name}-{style.__name__}-{int(rng.integers(2**24)):06x}")


def _seen_on(rng: Generator, ground: Colour) -> tuple[Colour, Colour]:
    """Two colours that stand out from the plate's own."""
    far = [c for c in COLOURS if np.linalg.norm(np.subtract(c, ground)) > 0.45]
    if len(far) < 2:
        far = sorted(COLOURS, key=lambda c: -float(np.linalg.norm(np.subtract(c, ground))))[:2]
    first, second = rng.permutation(len(far))[:2]
    return far[int(first)], far[int(second)]


def _draped(flat: Mesh, heights: Floats, lift: float) -> Mesh:
    r = np.hypot(flat.points[:, 0], flat.points[:, 1])
    limit = heights[-1, 0] * 0.965
    shrink = np.minimum(1, limit / np.maximum(r, 1e-9))
    points = flat.points * np.stack([shrink, shrink, np.ones_like(shrink)], 1)
    points[:, 2] += np.interp(r * shrink, heights[:, 0], heights[:, 1]) + lift
    return Mesh(points, flat.uv, flat.faces)


def _area(mesh: Mesh) -> float:
    a, b, c = (mesh.points[mesh.faces[:, k], :2] for k in range(3))
    u, v = b - a, c - a
    return float(np.clip(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], 0, None).sum() / 2)
