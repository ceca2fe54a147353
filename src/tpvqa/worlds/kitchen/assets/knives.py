"""Knives in many shapes; held out: cleavers and knives made of one piece of steel."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from tpvqa.worlds.kitchen.assets.builder import Builder
from tpvqa.worlds.kitchen.assets.mesh import Floats, Mesh
from tpvqa.worlds.kitchen.assets.model import Grasp, Model
from tpvqa.worlds.kitchen.assets.paint import Colour, near, one_of
from tpvqa.worlds.kitchen.assets.shapes import surface, tube

HANDLES: tuple[Colour, ...] = (
    (0.06, 0.06, 0.07),
    (0.32, 0.19, 0.1),
    (0.55, 0.36, 0.2),
    (0.6, 0.08, 0.08),
    (0.1, 0.2, 0.45),
    (0.85, 0.84, 0.8),
)
STEEL: Colour = (0.78, 0.79, 0.81)


@dataclass(frozen=True, slots=True)
class Blade:
    """A blade's outline: edge and back as heights over the handle's axis, by length 0..1."""

    length: float
    at: Floats
    edge: Floats
    back: Floats
    thickness: float


def blade_mesh(blade: Blade) -> Mesh:
    """A wedge, thick at the back and sharp at the edge, lying flat, the tip towards +x."""
    t, e, b = blade.at, blade.edge, blade.back
    thick = blade.thickness * np.linspace(1, 0.45, len(t))
    ring = np.stack(
        [
            np.stack([t * blade.length, b, thick / 2], 1),
            np.stack([t * blade.length, e * 0.75 + b * 0.25, thick * 0.42], 1),
            np.stack([t * blade.length, e, 0.0002 + 0 * t], 1),
            np.stack([t * blade.length, e, -0.0002 + 0 * t], 1),
            np.stack([t * blade.length, e * 0.75 + b * 0.25, -thick * 0.42], 1),
            np.stack([t * blade.length, b, -thick / 2], 1),
            np.stack([t * blade.length, b, thick / 2], 1),
        ],
        axis=1,
    )
    first = np.repeat(ring[:1].mean(axis=1, keepdims=True), ring.shape[1], axis=1)
    last = np.repeat(ring[-1:].mean(axis=1, keepdims=True), ring.shape[1], axis=1)
    return surface(np.concatenate([first, ring, last])).flipped()


def _knife(
    rng: Generator,
    blade: Blade,
    handle: float,
    thick: float,
    *,
    colour: Colour,
    rivets: int = 0,
    bolster: bool = False,
    bend: float = 0.0,
    wide: float = 1.25,
    serrated: bool = False,
) -> Model:
    build = Builder()
    steel = build.paint("steel", near(rng, STEEL, 0.03), specular=0.9, shininess=0.8)
    grip = build.paint("grip", colour, specular=rng.uniform(0.1, 0.5), shininess=0.4)
    height = thick
    total = blade.length + handle
    shift = -total / 2 + handle
    z = height / 2
    if serrated:
        wave = 0.0012 * np.sign(np.sin(np.arange(len(blade.at)) * np.pi))
        blade = Blade(blade.length, blade.at, blade.edge + wave, blade.back, blade.thickness)
    build.mesh("blade", blade_mesh(blade).moved(x=shift, z=z), steel, role="blade", crease=25)
    t = np.linspace(0, 1, 12)
    shape = 1 + 0.16 * np.cos(2 * np.pi * t) * rng.uniform(0, 1) - 0.12 * (t > 0.97)
    shape[0] *= 0.85
    path = np.stack([-t * handle, bend * np.sin(np.pi * t) - 0.3 * abs(bend), 0 * t], 1)
    bar = tube(path, thick / 2 * wide * shape, steps=12, flat=1 / wide)
    build.mesh("handle", bar.moved(x=shift, z=z), grip, role="handle", crease=60)
    if bolster:
        side = thick / 2 * wide * 1.04
        build.shape(
            "bolster", "ellipsoid", (0.009, side, side / wide * 0.98), steel, pos=(shift, 0, z)
        )
    for k in range(rivets):
        place = shift - handle * (k + 1) / (rivets + 1)
        build.shape(
            "rivet" + str(k),
            "cylinder",
            (0.0026, thick * 0.51),
            steel,
            pos=(place, bend * np.sin(np.pi * (k + 1) / (rivets + 1)) - 0.3 * abs(bend), z),
        )
    low, high = float(blade.edge.min()), float(blade.back.max())
    return _finish(build, total, 2 * max(-low, high, thick * wide / 2), height, handle)


def _finish(build: Builder, x: float, y: float, z: float, handle: float) -> Model:
    build.solid("box", (x / 2, max(y / 4, 0.008), z / 2), (0, 0, z / 2))
    hold = -x / 2 + 0.5 * handle
    return build.done(
        "knife",
        (x, y, z),
        0.12,
        grasps=(
            Grasp((hold, 0, z / 2), axis=(0, 1, 0), approach=(1, 0, 0), width=0.022),
            Grasp((hold, 0, z / 2), axis=(0, 1, 0), approach=(0, 0, -1), width=0.022),
        ),
        colour=STEEL,
    )


def _grip(rng: Generator) -> Colour:
    """Colour of a handle: as usual, of steel as the blade, or any."""
    draw = rng.random()
    if draw < 0.25:
        return near(rng, STEEL, 0.03)
    if draw < 0.45:
        return (rng.uniform(0.05, 0.95), rng.uniform(0.05, 0.95), rng.uniform(0.05, 0.95))
    return one_of(rng, HANDLES)


def chef(rng: Generator) -> Model:
    """A wide kitchen knife whose edge curves up to the tip."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.034, 0.05), rng.uniform(0.16, 0.23)
    belly = rng.uniform(2.2, 3.5)
    edge = -wide * 0.72 * (1 - t**belly)
    back = wide * 0.28 * (1 - t**4)
    back[-1] = edge[-1] + 0.001
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.0028),
        rng.uniform(0.11, 0.135),
        0.018,
        colour=_grip(rng),
        rivets=int(rng.choice([0, 2, 3])),
        bolster=rng.random() < 0.5,
    )


def paring(rng: Generator) -> Model:
    """A small knife with a narrow blade."""
    t = np.linspace(0, 1, 14)
    wide, length = rng.uniform(0.018, 0.025), rng.uniform(0.085, 0.12)
    edge = -wide * 0.6 * (1 - t**3)
    back = wide * 0.4 * (1 - t ** rng.uniform(2, 5))
    back[-1] = edge[-1] + 0.0008
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.002),
        rng.uniform(0.095, 0.115),
        0.016,
        colour=_grip(rng),
        rivets=int(rng.choice([0, 2])),
        bend=rng.uniform(0, 0.004),
    )


def santoku(rng: Generator) -> Model:
    """A wide blade with a straight edge and a back that drops to the tip."""
    t = np.linspace(0, 1, 18)
    wide, length = rng.uniform(0.042, 0.052), rng.uniform(0.15, 0.185)
    edge = -wide * 0.75 * (1 - 0.12 * t**4)
    back = wide * 0.25 - wide * 0.88 * np.clip((t - 0.72) / 0.28, 0, 1) ** 2.2
    back[-1] = edge[-1] + 0.001
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.0024),
        rng.uniform(0.115, 0.135),
        0.019,
        colour=_grip(rng),
        rivets=int(rng.choice([0, 3])),
        bolster=rng.random() < 0.6,
    )


def bread_knife(rng: Generator) -> Model:
    """A long narrow blade with a saw edge."""
    t = np.linspace(0, 1, 44)
    wide, length = rng.uniform(0.026, 0.034), rng.uniform(0.19, 0.24)
    edge = -wide * 0.6 + 0 * t
    back = wide * 0.4 - wide * 0.75 * np.clip((t - 0.9) / 0.1, 0, 1) ** 2
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.11, 0.13),
        0.018,
        colour=_grip(rng),
        rivets=int(rng.choice([0, 3])),
        serrated=True,
    )


def table_knife(rng: Generator) -> Model:
    """A dinner knife: slim, round tip, handle of steel or of plastic."""
    t = np.linspace(0, 1, 16)
    wide, length = rng.uniform(0.018, 0.023), rng.uniform(0.1, 0.125)
    tip = np.sqrt(np.clip(1 - np.clip((t - 0.86) / 0.14, 0, 1) ** 2, 0, 1))
    edge = -wide * (0.45 + 0.12 * np.sin(np.pi * t)) * tip
    back = wide * 0.45 * tip
    colour = near(rng, STEEL, 0.03) if rng.random() < 0.5 else one_of(rng, HANDLES)
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.0022),
        rng.uniform(0.095, 0.11),
        0.011,
        colour=colour,
        wide=1.6,
    )


def cleaver(rng: Generator) -> Model:
    """Held out: a rectangular blade."""
    t = np.linspace(0, 1, 6)
    wide, length = rng.uniform(0.065, 0.085), rng.uniform(0.15, 0.185)
    edge = -wide * 0.78 + 0 * t
    back = wide * (0.22 + 0.05 * t)
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.003),
        rng.uniform(0.11, 0.13),
        0.021,
        colour=near(rng, (0.42, 0.28, 0.16)),
        rivets=int(rng.choice([0, 2])),
    )


def steel_knife(rng: Generator) -> Model:
    """Held out: blade and curved handle of one piece of steel, or with a two-coloured grip."""
    t = np.linspace(0, 1, 18)
    wide, length = rng.uniform(0.024, 0.032), rng.uniform(0.14, 0.19)
    sweep = 0.012 * t**2.2
    edge = -wide * 0.62 * (1 - t**5) + sweep
    back = wide * 0.38 * (1 - t**2.5) + sweep
    back[-1] = edge[-1] + 0.0008
    colour = near(rng, STEEL, 0.03) if rng.random() < 0.5 else near(rng, (0.85, 0.45, 0.1))
    return _knife(
        rng,
        Blade(length, t, edge, back, 0.0024),
        rng.uniform(0.12, 0.14),
        0.017,
        colour=colour,
        bend=0.009,
        wide=1.4,
        bolster=True,
    )
