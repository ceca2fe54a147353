"""Fingers of grippers; held out: claws, mittens and tongs."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.mesh import Mesh, joined
from tpvqa_household.kitchen.assets.shapes import blob, box, tube

TIP = 0.012
"""How far fingers reach beyond the point between them, metres."""

Finger = Callable[[Generator, float], tuple[Mesh, Mesh]]
"""Body and pad of the left finger: inner side at y = 0, from the palm at z = -length to the tip."""


def _upright(
    x: float, y: float, low: float, high: float, *, y0: float = 0.0, bevel: float = 0.003
) -> Mesh:
    """A box between two heights whose inner side is at y0."""
    return box(x, y, high - low, bevel=bevel).moved(y=y0 + y / 2, z=low)


def thin(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A slim bar on a thicker root."""
    wide = rng.uniform(0.014, 0.02)
    body = joined(
        [
            _upright(wide, 0.009, -0.045, TIP, y0=0.003),
            _upright(wide * 1.3, 0.022, -length, -0.04, y0=0.003),
        ]
    )
    return body, _upright(wide, 0.003, -0.03, TIP - 0.001, bevel=0.001)


def thick(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A broad bar, bevelled."""
    wide = rng.uniform(0.026, 0.036)
    body = joined(
        [
            _upright(wide, 0.016, -0.06, TIP, y0=0.004, bevel=0.005),
            _upright(wide * 0.8, 0.03, -length, -0.05, y0=0.008, bevel=0.005),
        ]
    )
    return body, _upright(wide * 0.9, 0.005, -0.04, TIP - 0.002, bevel=0.001)


def rounded(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A round finger that leans outwards."""
    r = rng.uniform(0.009, 0.013)
    t = np.linspace(0, 1, 8)
    path = np.stack([0 * t, r + 0.004 + 0.02 * t**2, TIP - r - (length + TIP - r) * t], 1)
    radii = r * np.r_[0.55, np.full(6, 1.0), 1.2]
    pad = tube([[0, r * 0.8, TIP - r], [0, r * 0.8, -0.03]], r * 0.8, steps=10)
    return tube(path, radii, steps=12), pad


def knuckled(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Bones between round knuckles."""
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


def fin_ray(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Two ribs joined by rungs."""
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


def slender(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A thin rod, slightly bowed, with a knob at its end."""
    r, bow = rng.uniform(0.0035, 0.007), rng.uniform(0.003, 0.012)
    t = np.linspace(0, 1, 9)
    path = np.stack([0 * t, r + bow * np.sin(np.pi * t), TIP - r - (length + TIP - r) * t], 1)
    radii = r * np.r_[rng.uniform(0.8, 1.4), np.full(7, 1.0), 1.6]
    return tube(path, radii, steps=9), _upright(2 * r, 0.002, -0.012, TIP - 0.003, bevel=0.0005)


def curved(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A round finger of even thickness that bows outwards and ends bluntly."""
    r, bow = rng.uniform(0.007, 0.012), rng.uniform(0.01, 0.026)
    t = np.linspace(0, 1, 11)
    rise = np.sin(np.pi * t ** rng.uniform(0.9, 1.4))
    path = np.stack([0 * t, r + bow * rise, TIP - r - (length + TIP - r) * t], 1)
    radii = r * np.r_[0.8, np.linspace(1.0, rng.uniform(1.0, 1.3), 10)]
    return tube(path, radii, steps=11), _upright(1.3 * r, 0.004, -0.02, TIP - 0.004, bevel=0.001)


def forked(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Two rods side by side, joined by a bar."""
    r, gap, lean = rng.uniform(0.004, 0.008), rng.uniform(0.009, 0.014), rng.uniform(0, 0.025)
    t = np.linspace(0, 1, 6)
    rods = [
        tube(
            np.stack([x * (1 - 0.4 * t), r + lean * t**2, TIP - r - (length + TIP - r) * t], 1),
            r * np.r_[0.7, np.full(5, 1.0)],
            steps=8,
        )
        for x in (-gap, gap)
    ]
    bar = tube([[-gap, r, -0.03], [gap, r, -0.03]], r * 0.8, steps=7)
    return joined([*rods, bar]), _upright(
        2 * gap + 1.5 * r, 0.003, -0.012, TIP - 0.003, bevel=0.001
    )


def strap(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A flat band of even width, bent outwards at an elbow."""
    wide, thick = rng.uniform(0.012, 0.022), rng.uniform(0.0025, 0.004)
    elbow, out = -rng.uniform(0.03, 0.07), rng.uniform(0.012, 0.035)
    low = [_upright(wide, thick, elbow, TIP, bevel=0.0008)]
    line = np.linspace([0, thick / 2, elbow], [0, out, -length], 4)
    low.append(tube(line, wide / 2, steps=4, flat=1.6 * thick / wide))
    return joined(low), _upright(wide, 0.002, -0.015, TIP, bevel=0.0005)


def paddle(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A broad plate with a rounded end on a slim arm."""
    wide, tall = rng.uniform(0.028, 0.042), rng.uniform(0.035, 0.055)
    arm, out = rng.uniform(0.006, 0.01), rng.uniform(0.005, 0.03)
    plate = blob(wide, 0.009, tall, rows=9, columns=16, power=0.45)
    line = np.linspace([0, 0.006, TIP - tall * 0.6], [0, out, -length], 5)
    body = joined([plate.moved(y=0.006, z=TIP - tall), tube(line, arm, steps=9)])
    return body, _upright(wide * 0.6, 0.003, TIP - tall * 0.8, TIP - tall * 0.2, bevel=0.001)


def bellows(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """A soft finger of rings, bowed a little, thinner towards its end."""
    r, rings = rng.uniform(0.008, 0.013), int(rng.integers(5, 9))
    t = np.linspace(0, 1, 4 * rings + 1)
    wave = 1 + 0.16 * np.cos(2 * np.pi * rings * t)
    bow = rng.uniform(0.0, 0.02)
    path = np.stack([0 * t, r + bow * np.sin(np.pi * t), TIP - r - (length + TIP - r) * t], 1)
    radii = r * wave * (0.75 + 0.4 * t)
    radii[0] *= 0.6
    return tube(path, radii, steps=10), _upright(1.2 * r, 0.003, -0.02, TIP - 0.006, bevel=0.001)


def claw(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Held out: a crescent that tapers to a point."""
    t = np.linspace(0, 1, 12)
    bow = rng.uniform(0.035, 0.055)
    path = np.stack([0 * t, 0.002 + bow * np.sin(np.pi * t**0.8), TIP - (length + TIP) * t], 1)
    radii = np.interp(t, [0, 0.3, 1], [0.002, 0.009, 0.014])
    side = tube(path, radii, steps=10)
    return side, _upright(0.006, 0.003, -0.004, TIP, bevel=0.001)


def mitten(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Held out: three round fingers side by side."""
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


def tongs(rng: Generator, length: float) -> tuple[Mesh, Mesh]:
    """Held out: a bowed strip."""
    wide = rng.uniform(0.02, 0.03)
    t = np.linspace(0, 1, 8)
    path = np.stack(
        [0 * t, 0.002 + 0.012 * t + 0.014 * np.sin(np.pi * t), TIP - (length + TIP) * t], 1
    )
    strip = tube(path, wide / 2 * np.interp(t, [0, 0.2, 1], [1.15, 0.8, 0.7]), steps=8, flat=0.18)
    return strip, _upright(wide, 0.003, -0.012, TIP, bevel=0.001)
