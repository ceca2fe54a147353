"""How a knife is put together, and what its parts look like."""

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, near, one_of
from tpvqa_household.kitchen.assets.shapes import surface, tube

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


@dataclass(frozen=True, slots=True)
class Steel:
    """What a blade's steel looks like."""

    colour: Colour
    specular: float
    shininess: float


def any_steel(rng: Generator) -> Steel:
    """Steel as kitchens and lights show it: nearly black to white, cold or warm, dull or bright."""
    bright, tint = rng.uniform(0.25, 0.97), rng.normal(0, 0.025)
    red, blue = (float(np.clip(bright + sign * tint, 0, 1)) for sign in (1, -1))
    return Steel((red, float(bright), blue), rng.uniform(0.2, 1.0), rng.uniform(0.3, 0.9))


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


def build_knife(
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
    look: Steel | None = None,
    butt: Colour | None = None,
    swell: Floats | None = None,
) -> Model:
    """A knife lying flat, its edge towards -y, its tip towards +x.

    Args:
        rng: Varies the colours and the handle's swelling.
        blade: Its blade.
        handle: Length of the handle, metres.
        thick: Height of the handle as it lies, metres.
        colour: Of the handle.
        rivets: How many.
        bolster: Whether a collar of steel joins blade and handle.
        bend: How far the handle's middle lies off the line between its ends, metres.
        wide: Width of the handle over its height.
        serrated: Whether the edge is a saw.
        look: What the steel looks like; drawn near `STEEL` unless given.
        butt: Colour of the last third of the handle; None is that of the rest.
        swell: Width of the handle at 12 points from blade to end, over `thick * wide`; drawn
            unless given.
    """
    build = Builder()
    look = look or Steel(near(rng, STEEL, 0.03), 0.9, 0.8)
    steel = build.paint("steel", look.colour, specular=look.specular, shininess=look.shininess)
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
    if swell is not None:
        shape = swell
    path = np.stack([-t * handle, bend * np.sin(np.pi * t) - 0.3 * abs(bend), 0 * t], 1)
    bar = tube(path, thick / 2 * wide * shape, steps=12, flat=1 / wide)
    build.mesh("handle", bar.moved(x=shift, z=z), grip, role="handle", crease=60)
    if butt is not None:
        end = tube(path[8:], thick / 2 * wide * shape[8:] * 1.03, steps=12, flat=1 / wide)
        build.mesh("butt", end.moved(x=shift, z=z), build.paint("butt", butt, specular=0.3))
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


def grip_colour(rng: Generator) -> Colour:
    """Colour of a handle: as usual, of steel as the blade, or any."""
    draw = rng.random()
    if draw < 0.25:
        return near(rng, STEEL, 0.03)
    if draw < 0.45:
        return (rng.uniform(0.05, 0.95), rng.uniform(0.05, 0.95), rng.uniform(0.05, 0.95))
    return one_of(rng, HANDLES)
