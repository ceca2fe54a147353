"""Apples, whole and halved."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, clouds, mix, near, one_of, png
from tpvqa_household.kitchen.assets.shapes import surface, tube

RED: tuple[Colour, ...] = ((0.68, 0.08, 0.1), (0.78, 0.16, 0.12), (0.55, 0.05, 0.09))
GREEN: tuple[Colour, ...] = ((0.5, 0.68, 0.18), (0.42, 0.6, 0.16))
YELLOW: tuple[Colour, ...] = ((0.86, 0.72, 0.25), (0.8, 0.74, 0.35))


def profile(radius: float, height: float, shoulder: float, steps: int = 18) -> Floats:
    """Half a cross section with a dimple at both ends, bottom to top."""
    t = np.linspace(-np.pi / 2, np.pi / 2, steps)
    r = np.cos(t) * (1 + shoulder * np.sin(t))
    r = radius * r / r.max()
    z = np.sin(t) - 0.32 * np.exp(-(((t - np.pi / 2) / 0.42) ** 2))
    z = z + 0.14 * np.exp(-(((t + np.pi / 2) / 0.35) ** 2))
    z = (z - z.min()) / np.ptp(z) * height
    r[0] = r[-1] = 0.0
    return np.stack([r, z], axis=1)


def _body(curve: Floats, angles: Floats, lobes: float) -> Mesh:
    """The curve turned about z through the angles, with five soft lobes at the bottom."""
    swell = 1 + lobes * np.outer(np.cos(5 * angles), (1 - np.linspace(0, 1, len(curve))) ** 2)
    radius = curve[:, 0] * swell
    grid = np.stack(
        [
            radius * np.cos(angles)[:, None],
            radius * np.sin(angles)[:, None],
            np.broadcast_to(curve[:, 1], radius.shape),
        ],
        -1,
    )
    u = np.broadcast_to((angles / (2 * np.pi))[:, None], radius.shape)
    v = np.broadcast_to(np.linspace(0, 1, len(curve)), radius.shape)
    return surface(grid, uv=np.stack([u, v], -1))


def skin(rng: Generator, base: Colour, blush: Colour, amount: float) -> bytes:
    """An apple's skin: bottom to top, with streaks, a blush on one side and small dots."""
    height, width = 96, 160
    v = np.linspace(1, 0, height)[:, None] * np.ones((1, width))
    streaks = clouds(rng, height, width, rows=2, columns=20, octaves=3)
    side = 0.5 + 0.5 * np.cos(np.linspace(0, 2 * np.pi, width) + rng.uniform(0, 6))[None, :]
    picture = mix(base, blush, (side - 0.45) * amount * 1.5 + (streaks - 0.5) * 1.1 * amount)
    ends = np.exp(-(((v - 1) / 0.16) ** 2)) + 0.6 * np.exp(-((v / 0.1) ** 2))
    picture = mix(picture, (0.66, 0.6, 0.24), ends * 0.7)
    dots = rng.random((height, width)) < 0.012
    picture = mix(picture, (0.95, 0.9, 0.7), dots * 0.45)
    return png(picture)


def flesh(rng: Generator, radius: float, height: float) -> bytes:
    """The cut face: pale flesh, a core with two chambers and pips; the top is up."""
    size = 96
    y, x = np.mgrid[0:size, 0:size] / size * 2 - 1
    y = -y
    tone = near(rng, (0.97, 0.93, 0.74), 0.03)
    picture = mix(tone, (0.9, 0.82, 0.55), clouds(rng, size, size, rows=6, columns=6) * 0.3)
    core = np.hypot(x / 0.36, (y + 0.05) / 0.5)
    picture = mix(picture, (0.83, 0.76, 0.5), np.exp(-(((core - 1) / 0.09) ** 2)) * 0.7)
    for sign in (-1, 1):
        pip = np.hypot((x - sign * 0.15) / 0.07, (y + 0.06) / 0.16)
        chamber = np.hypot((x - sign * 0.15) / 0.12, (y + 0.06) / 0.27)
        picture = mix(picture, (0.8, 0.72, 0.47), (chamber < 1) * 0.8)
        picture = mix(picture, (0.26, 0.13, 0.06), np.clip((1.05 - pip) * 6, 0, 1))
    picture = mix(picture, (0.7, 0.62, 0.35), (np.abs(x) < 0.025) * (np.abs(y) > 0.4) * 0.8)
    return png(picture)


def apple(rng: Generator) -> Model:
    """An apple of random size, shape and colour: red, green, yellow or two-coloured."""
    kind = rng.random()
    if kind < 0.45:
        base, blush, amount = one_of(rng, RED), near(rng, (0.85, 0.55, 0.25)), rng.uniform(0, 0.5)
    elif kind < 0.65:
        base, blush, amount = one_of(rng, GREEN), near(rng, (0.65, 0.74, 0.3)), 0.4
    elif kind < 0.75:
        base, blush, amount = one_of(rng, YELLOW), one_of(rng, RED), rng.uniform(0, 0.4)
    else:
        base, blush, amount = one_of(rng, YELLOW), one_of(rng, RED), rng.uniform(0.7, 1.2)
    radius = rng.uniform(0.034, 0.045)
    return _apple(rng, radius, radius * rng.uniform(1.6, 1.9), base, blush, amount, lobes=0.03)


def tall_apple(rng: Generator) -> Model:
    """Held out: tall, ribbed, dark or russet apples, some with a leaf."""
    dark = rng.random() < 0.6
    base = near(rng, (0.38, 0.03, 0.1)) if dark else near(rng, (0.6, 0.46, 0.2))
    blush = near(rng, (0.6, 0.1, 0.12)) if dark else near(rng, (0.7, 0.3, 0.15))
    radius = rng.uniform(0.033, 0.042)
    return _apple(
        rng, radius, radius * rng.uniform(2.0, 2.25), base, blush, 0.7, lobes=0.08, leaf=True
    )


def _apple(
    rng: Generator,
    radius: float,
    height: float,
    base: Colour,
    blush: Colour,
    amount: float,
    *,
    lobes: float,
    leaf: bool = False,
) -> Model:
    curve = profile(radius, height, rng.uniform(0.1, 0.26))
    build = Builder()
    peel = skin(rng, base, blush, amount)
    gloss = rng.uniform(0.25, 0.5)
    build.paint("skin", texture=peel, specular=gloss, shininess=0.5)
    build.paint("stem", (0.3, 0.2, 0.1))
    build.mesh(
        "body", _body(curve, np.linspace(0, 2 * np.pi, 29), lobes), "skin", role="skin", crease=70
    )
    dip = float(curve[-1, 1])
    lean = rng.uniform(-0.006, 0.006)
    path = [[0, 0, dip - 0.002], [lean / 3, 0, dip + 0.007], [lean, 0.001, dip + 0.018]]
    build.mesh("stem", tube(path, [0.0014, 0.0011, 0.0016], steps=5), "stem")
    if leaf:
        build.paint("leaf", near(rng, (0.25, 0.45, 0.14)))
        build.mesh(
            "leaf", _leaf().turned(2, float(rng.uniform(0, 360))).moved(z=dip + 0.012), "leaf"
        )
    build.solid("sphere", (radius * 0.97,), (0, 0, radius * 0.97))
    top = float(curve[:, 1].max())
    z = 0.5 * height
    return build.done(
        "apple",
        (2 * radius, 2 * radius, top),
        rng.uniform(0.12, 0.2),
        grasps=(
            Grasp((0, 0, z), axis=(1, 0, 0), approach=(0, 1, 0), width=1.9 * radius),
            Grasp((0, 0, z), axis=(0, 1, 0), approach=(0, 0, -1), width=1.9 * radius),
        ),
        colour=base,
        half=_half(rng, curve, radius, peel, gloss, lobes),
    )


def _half(
    rng: Generator, curve: Floats, radius: float, peel: bytes, gloss: float, lobes: float
) -> Model:
    height = float(np.ptp(curve[:, 1]))
    build = Builder()
    build.paint("skin", texture=peel, specular=gloss, shininess=0.5)
    build.paint("flesh", texture=flesh(rng, radius, height), specular=0.15)
    # Cut through the axis; then the cut side, which faces +y, is turned up.
    body = _body(curve, np.linspace(np.pi, 2 * np.pi, 15), lobes)
    swell = 1 + lobes * np.cos(5 * np.pi) * (1 - np.linspace(0, 1, len(curve))) ** 2
    swell_far = 1 + lobes * (1 - np.linspace(0, 1, len(curve))) ** 2
    left = np.stack([-curve[:, 0] * swell, 0 * curve[:, 0], curve[:, 1]], 1)
    right = np.stack([curve[:, 0] * swell_far, 0 * curve[:, 0], curve[:, 1]], 1)
    loop = np.r_[right, left[-2:0:-1]]
    middle = np.array([[0, 0, 0.5 * height]])
    n = len(loop)
    points = np.r_[loop, middle, loop - [0, 0.001, 0], middle - [0, 0.001, 0]]
    fan = [[n, (k + 1) % n, k] for k in range(n)]
    back = [[2 * n + 1, n + 1 + k, n + 1 + (k + 1) % n] for k in range(n)]
    uv = np.stack([0.5 + points[:, 0] / (2.1 * radius), points[:, 2] / height], 1)
    face = Mesh.of(points, fan + back, uv)
    shift = -0.5 * height
    for name, mesh in (("skin", body), ("flesh", face)):
        flat = mesh.moved(z=shift).turned(0, 90).moved(z=radius)
        build.mesh(name, flat, name, role=name, crease=70)
    build.solid("cylinder", (0.85 * radius, 0.46 * radius), (0, 0, 0.5 * radius))
    return build.done(
        "apple_half",
        (2 * radius, height, radius),
        0.08,
        grasps=(Grasp((0, 0, 0.6 * radius), (1, 0, 0), (0, 0, -1), width=1.8 * radius),),
        colour=(0.95, 0.9, 0.7),
    )


def _leaf() -> Mesh:
    t = np.linspace(0, 1, 7)
    wide = 0.009 * np.sin(np.pi * t**0.8)
    grid = np.stack(
        [np.stack([0.034 * t, s * wide, 0.008 * np.sin(2.2 * t)], 1) for s in (-1, 0, 1)], 1
    )
    sheet = surface(grid)
    return Mesh(
        np.r_[sheet.points, sheet.points - [0, 0, 0.0005]],
        np.r_[sheet.uv, sheet.uv],
        np.r_[sheet.faces, sheet.faces[:, ::-1] + len(sheet.points)],
    )


def half(rng: Generator) -> Model:
    """A half of a random apple."""
    return _of(apple(rng))


def tall_half(rng: Generator) -> Model:
    """Held out: a half of a tall apple."""
    return _of(tall_apple(rng))


def _of(whole: Model) -> Model:
    assert whole.half is not None
    return whole.half
