"""Two-fingered grippers with a piece of forearm; held out: claws, mittens and tongs.

A gripper's frame is unlike that of other things: the origin is the point between the finger
tips, z is where the fingers point (`Grasp.approach`), y is how they close (`Grasp.axis`). The
bodies "left" and "right" slide along +y and -y; the joint's value is half the opening. The body
"forearm" turns freely about the wrist and reaches along its own -z. Grippers have no solids.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from tpvqa.worlds.kitchen.assets.builder import Builder
from tpvqa.worlds.kitchen.assets.mesh import Mesh, joined
from tpvqa.worlds.kitchen.assets.model import Joint, Model
from tpvqa.worlds.kitchen.assets.paint import Colour, near, one_of
from tpvqa.worlds.kitchen.assets.shapes import box, tube

METALS: tuple[Colour, ...] = (
    (0.12, 0.12, 0.13),
    (0.75, 0.76, 0.78),
    (0.9, 0.9, 0.89),
    (0.35, 0.37, 0.4),
    (0.15, 0.25, 0.5),
)
ACCENTS: tuple[Colour, ...] = (
    (0.05, 0.05, 0.06),
    (0.9, 0.5, 0.1),
    (0.2, 0.45, 0.75),
    (0.75, 0.12, 0.12),
    (0.6, 0.62, 0.64),
    (0.3, 0.6, 0.35),
)
OPEN = 0.075
TIP = 0.012


def _upright(
    x: float, y: float, low: float, high: float, *, y0: float = 0.0, bevel: float = 0.003
) -> Mesh:
    """A box between two heights whose inner side is at y0."""
    return box(x, y, high - low, bevel=bevel).moved(y=y0 + y / 2, z=low)


Finger = Callable[[Generator, float], tuple[Mesh, Mesh]]
"""Body and pad of the left finger: inner side at y = 0, from the palm at z = -length to the tip."""


def _thin(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    wide = rng.uniform(0.014, 0.02)
    body = joined(
        [
            _upright(wide, 0.009, -0.045, TIP, y0=0.003),
            _upright(wide * 1.3, 0.022, -length, -0.04, y0=0.003),
        ]
    )
    return body, _upright(wide, 0.003, -0.03, TIP - 0.001, bevel=0.001)


def _thick(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    wide = rng.uniform(0.026, 0.036)
    body = joined(
        [
            _upright(wide, 0.016, -0.06, TIP, y0=0.004, bevel=0.005),
            _upright(wide * 0.8, 0.03, -length, -0.05, y0=0.008, bevel=0.005),
        ]
    )
    return body, _upright(wide * 0.9, 0.005, -0.04, TIP - 0.002, bevel=0.001)


def _rounded(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    r = rng.uniform(0.009, 0.013)
    t = np.linspace(0, 1, 8)
    path = np.stack([0 * t, r + 0.004 + 0.02 * t**2, TIP - r - (length + TIP - r) * t], 1)
    radii = r * np.r_[0.55, np.full(6, 1.0), 1.2]
    pad = tube([[0, r * 0.8, TIP - r], [0, r * 0.8, -0.03]], r * 0.8, steps=10)
    return tube(path, radii, steps=12), pad


def _knuckled(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    wide = rng.uniform(0.018, 0.026)
    bow = rng.uniform(0.03, 0.045)
    joints = [[0, 0.008, TIP - 0.006], [0, 0.012, -0.035], [0, bow, -0.07], [0, 0.02, -length]]
    bones = []
    for a, b in pairwise(joints):
        bones.append(tube(np.linspace(a, b, 3), wide * 0.42, steps=6))
    knobs = [
        tube([[-wide * 0.62, p[1], p[2]], [wide * 0.62, p[1], p[2]]], wide * 0.52, steps=10)
        for p in joints[1:]
    ]
    return joined(bones + knobs), _upright(wide * 0.8, 0.004, -0.03, TIP - 0.004, bevel=0.001)


def _fin_ray(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    wide, deep = rng.uniform(0.018, 0.024), rng.uniform(0.035, 0.05)
    inner = [[0, 0.002, TIP], [0, 0.002, -length]]
    outer = [[0, 0.004, TIP], [0, deep, -length]]
    bars = [
        tube(np.linspace(inner[0], inner[1], 3), wide / 2, steps=4, flat=0.3),
        tube(np.linspace(outer[0], outer[1], 3), wide / 2, steps=4, flat=0.3),
    ]
    for share in np.linspace(0.3, 0.92, 5):
        z = TIP - share * (length + TIP)
        bars.append(
            tube(
                [[0, 0.002, z + 0.006], [0, 0.004 + share * (deep - 0.004), z]],
                wide / 2.2,
                steps=4,
                flat=0.25,
            )
        )
    return joined(bars), _upright(wide, 0.001, -length, TIP, bevel=0.0)


def _claw(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    t = np.linspace(0, 1, 12)
    bow = rng.uniform(0.035, 0.055)
    path = np.stack([0 * t, 0.002 + bow * np.sin(np.pi * t**0.8), TIP - (length + TIP) * t], 1)
    radii = np.interp(t, [0, 0.3, 1], [0.002, 0.009, 0.014])
    side = tube(path, radii, steps=10)
    return side, _upright(0.006, 0.003, -0.004, TIP, bevel=0.001)


def _mitten(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    r = rng.uniform(0.008, 0.0105)
    fingers = []
    for k in range(3):
        x = (k - 1) * 2.05 * r
        t = np.linspace(0, 1, 7)
        short = 0.008 * abs(k - 1)
        path = np.stack(
            [
                x + 0 * t,
                r + 0.016 * np.sin(np.pi * t) + 0.004,
                TIP - short - (length + TIP - short) * t,
            ],
            1,
        )
        fingers.append(tube(path, r * np.r_[0.6, np.full(6, 1.0)], steps=9))
    return joined(fingers), _upright(4 * r, 0.004, -0.015, TIP - 0.006, bevel=0.002)


def _tongs(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    wide = rng.uniform(0.02, 0.03)
    t = np.linspace(0, 1, 8)
    path = np.stack(
        [0 * t, 0.002 + 0.012 * t + 0.014 * np.sin(np.pi * t), TIP - (length + TIP) * t], 1
    )
    strip = tube(path, wide / 2 * np.interp(t, [0, 0.2, 1], [1.15, 0.8, 0.7]), steps=8, flat=0.18)
    return strip, _upright(wide, 0.003, -0.012, TIP, bevel=0.001)


def _gripper(
    rng: Generator,
    finger: Finger,
    *,
    round_palm: bool,
    shell: Colour,
    accent: Colour,
    pad_colour: Colour,
) -> Model:
    length = rng.uniform(0.1, 0.13)
    build = Builder()
    gloss = rng.uniform(0.1, 0.6)
    build.paint("shell", shell, specular=gloss, shininess=0.5)
    build.paint("accent", accent, specular=gloss, shininess=0.5)
    build.paint("pad", pad_colour, specular=0.1)
    body, pad = finger(rng, length)
    for side, name in ((1, "left"), (-1, "right")):
        build.mesh(f"{name}_finger", body.scaled(1, side, 1), "accent", body=name)
        build.mesh(f"{name}_pad", pad.scaled(1, side, 1), "pad", body=name)
        build.joints.append(Joint(name, "slide", (0, 0, 0), (0, float(side), 0), (0.0, OPEN)))
    deep, wide, tall = rng.uniform(0.04, 0.055), rng.uniform(0.13, 0.16), rng.uniform(0.03, 0.045)
    top = -length + 0.006
    if round_palm:
        palm = joined(
            [
                tube([[0, -wide / 2, top - 0.02], [0, wide / 2, top - 0.02]], 0.023, steps=14),
                tube(
                    np.linspace([0, 0, top - 0.02], [0, 0, top - 0.075], 3),
                    [0.03, 0.036, 0.03],
                    steps=16,
                ),
            ]
        )
    else:
        palm = joined(
            [
                box(deep * 0.8, wide + 0.03, 0.016, bevel=0.003).moved(z=top - 0.016),
                box(deep, wide * 0.75, tall, bevel=0.008).moved(z=top - 0.01 - tall),
                tube([[0, 0, top - tall], [0, 0, top - 0.085]], 0.032, steps=16),
            ]
        )
    build.mesh("palm", palm, "shell")
    wrist = top - 0.085
    r = rng.uniform(0.032, 0.045)
    build.mesh(
        "wrist", tube([[0, 0, 0.018], [0, 0, -0.03]], r * 1.1, steps=18), "accent", body="forearm"
    )
    line = np.linspace([0, 0, -0.02], [0, 0, -0.6], 7)
    swell = r * np.array([0.9, 0.95, 1.0, 1.08, 1.18, 1.28, 1.35])
    build.mesh("arm", tube(line, swell, steps=18), "shell", body="forearm")
    rings = [
        tube([[0, 0, z], [0, 0, z - 0.014]], r * grow, steps=18)
        for z, grow in ((-0.16, 1.06), (-0.42, 1.3))
    ]
    build.mesh("rings", joined(rings), "accent", body="forearm")
    build.joints.append(Joint("forearm", "ball", (0, 0, wrist), (0, 0, 1), (0.0, 180.0)))
    return build.done("gripper", (deep, wide, length + 0.1), 1.0, colour=shell)


def _of(finger: Finger, *, round_palm: bool = False) -> Callable[[Generator], Model]:
    def make(rng: Generator) -> Model:
        return _gripper(
            rng,
            finger,
            round_palm=round_palm,
            shell=one_of(rng, METALS),
            accent=one_of(rng, ACCENTS),
            pad_colour=one_of(rng, ACCENTS),
        )

    return make


def _held_out(finger: Finger, *, round_palm: bool) -> Callable[[Generator], Model]:
    def make(rng: Generator) -> Model:
        shell = one_of(
            rng, ((0.85, 0.75, 0.6), (0.45, 0.2, 0.5), (0.2, 0.45, 0.42), (0.6, 0.6, 0.58))
        )
        return _gripper(
            rng,
            finger,
            round_palm=round_palm,
            shell=shell,
            accent=near(rng, (0.93, 0.8, 0.2) if rng.random() < 0.4 else (0.8, 0.8, 0.82)),
            pad_colour=near(rng, (0.5, 0.5, 0.5)),
        )

    return make


TRAIN: dict[str, Callable[[Generator], Model]] = {
    "thin": _of(_thin),
    "thick": _of(_thick),
    "rounded": _of(_rounded, round_palm=True),
    "knuckled": _of(_knuckled),
    "fin-ray": _of(_fin_ray, round_palm=True),
}
HELD_OUT: dict[str, Callable[[Generator], Model]] = {
    "claw": _held_out(_claw, round_palm=True),
    "mitten": _held_out(_mitten, round_palm=False),
    "tongs": _held_out(_tongs, round_palm=False),
}
