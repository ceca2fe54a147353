"""Plates, and round things that are not plates: saucers, lids, bowls, mugs, pans."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, hsv, one_of, png
from tpvqa_household.kitchen.assets.shapes import lathe

GLAZES: tuple[Colour, ...] = (
    (0.95, 0.95, 0.94),
    (0.93, 0.9, 0.82),
    (0.62, 0.72, 0.82),
    (0.75, 0.76, 0.76),
    (0.7, 0.8, 0.72),
)


def plate_profile(radius: float, depth: float, rim: float, foot: float, thick: float) -> Floats:
    """A plate's cross section: foot, underside, lip, sloping rim, well, flat middle."""
    well = radius - rim
    return np.array(
        [
            (0.0, 0.002),
            (foot - 0.004, 0.002),
            (foot - 0.003, 0.0),
            (foot, 0.0),
            (foot + 0.001, 0.002),
            (well, 0.45 * depth),
            (radius - 0.002, depth - thick),
            (radius, depth - thick / 2),
            (radius - 0.001, depth),
            (radius - 0.004, depth),
            (well + 0.004, 0.5 * depth + thick),
            (well - 0.3 * rim - 0.004, 0.15 * depth + thick + 0.001),
            (well - 0.4 * rim - 0.012, thick + 0.002),
            (0.0, thick + 0.002),
        ]
    )


def glaze(rng: Generator, radius: float, rim: float, colour: Colour, style: str) -> bytes:
    """The picture on a plate, seen from above."""
    size = 192
    y, x = np.mgrid[0:size, 0:size]
    r = np.hypot(x - size / 2 + 0.5, y - size / 2 + 0.5) / (size / 2)
    angle = np.arctan2(y - size / 2, x - size / 2)
    ink = np.array(hsv(rng.random(), rng.uniform(0.4, 0.85), rng.uniform(0.25, 0.75)))
    mark = np.zeros((size, size), bool)
    edge = 1 - rim / radius
    if style == "rings":
        for _ in range(int(rng.integers(1, 4))):
            at, wide = rng.uniform(edge, 0.99), rng.uniform(0.008, 0.04)
            mark |= np.abs(r - at) < wide
    elif style == "rim":
        mark = r > rng.uniform(edge, 0.96)
    elif style == "dots":
        n = int(rng.integers(10, 30))
        turn = (angle * n / (2 * np.pi)) % 1 - 0.5
        mark = np.hypot(turn * 2 * np.pi / n, r - (edge + 1) / 2) < 0.35 * (1 - edge)
    elif style == "rays":
        n = int(rng.integers(16, 48))
        mark = (((angle * n / (2 * np.pi)) % 1) < 0.4) & (r > edge)
    return png(np.where(mark[..., None], ink, np.array(colour)))


def plate(rng: Generator) -> Model:
    """A dinner plate of random radius, depth, rim, colour and decoration."""
    radius, depth = rng.uniform(0.085, 0.14), rng.uniform(0.014, 0.026)
    rim = rng.uniform(0.16, 0.34) * radius
    style = str(rng.choice(["plain", "rings", "rim", "dots"], p=[0.5, 0.25, 0.15, 0.1]))
    return _plate(rng, radius, depth, rim, style, one_of(rng, GLAZES))


def deep_plate(rng: Generator) -> Model:
    """Held out: a deep pasta plate with a narrow or no rim, in dark glazes."""
    radius = rng.uniform(0.09, 0.135)
    colour = one_of(rng, ((0.2, 0.25, 0.3), (0.45, 0.22, 0.18), (0.35, 0.4, 0.3), (0.9, 0.88, 0.8)))
    style = str(rng.choice(["plain", "rays", "rim"]))
    return _plate(rng, radius, rng.uniform(0.028, 0.036), 0.1 * radius, style, colour)


def _plate(
    rng: Generator, radius: float, depth: float, rim: float, style: str, colour: Colour
) -> Model:
    build = Builder()
    texture = None if style == "plain" else glaze(rng, radius, rim, colour, style)
    gloss = rng.uniform(0.3, 0.6)
    ceramic = build.paint(
        "glaze", (1, 1, 1) if texture else colour, texture=texture, specular=gloss, shininess=0.6
    )
    thick = 0.0045
    profile = plate_profile(radius, depth, rim, 0.55 * radius, thick)
    build.mesh("dish", lathe(profile, steps=40, disc_uv=True), ceramic)
    inner = radius - 1.4 * rim - 0.012
    floor = thick + 0.002
    build.solid("cylinder", (0.75 * radius, floor / 2), (0, 0, floor / 2))
    build.solid("cylinder", (radius, depth / 4), (0, 0, 0.75 * depth))
    build.top("middle", (0, 0, floor), (inner * 0.7, inner * 0.7))
    return build.done(
        "plate",
        (2 * radius, 2 * radius, depth),
        rng.uniform(0.3, 0.6),
        grasps=(rim_grasp(radius, depth),),
        colour=colour,
        dish=[(float(r), float(z)) for r, z in profile[:7:-1]],
    )


def rim_grasp(radius: float, depth: float) -> Grasp:
    """From the -y side, one finger above and one below the rim."""
    return Grasp(
        offset=(0, 0.018 - radius, depth - 0.006), axis=(0, 0, 1), approach=(0, 1, 0), width=0.008
    )
