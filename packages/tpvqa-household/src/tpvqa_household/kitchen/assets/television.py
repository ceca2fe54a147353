"""TVs whose screen can be switched: flat ones of many shapes; held out: tubes and easels.

The part with the role "screen" has the paint `OFF`; a scene turns the TV on by giving that geom
the material of the paint `ON`.
"""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Mesh, joined
from tpvqa_household.kitchen.assets.model import Model
from tpvqa_household.kitchen.assets.paint import Colour, near, one_of
from tpvqa_household.kitchen.assets.pictures import picture
from tpvqa_household.kitchen.assets.shapes import box, quad, tube

OFF, ON = "screen_off", "screen_on"
CASES: tuple[Colour, ...] = (
    (0.04, 0.04, 0.045),
    (0.1, 0.1, 0.11),
    (0.55, 0.56, 0.58),
    (0.85, 0.85, 0.85),
)


def screen(
    build: Builder,
    rng: Generator,
    x: float,
    z: float,
    *,
    pos: tuple[float, float, float],
    held_out: bool,
    tilt: float = 0.0,
) -> None:
    """The switchable screen, its front at `pos`."""
    dark = rng.uniform(0.012, 0.035)
    build.paint(OFF, (dark, dark, dark * 1.1), specular=0.7, shininess=0.85, reflectance=0.0)
    build.paint(ON, (1, 1, 1), texture=picture(rng, held_out=held_out), specular=0.0, emission=0.8)
    build.mesh("screen", quad(x, z), OFF, pos=pos, euler=(tilt, 0, 0), role="screen")


def flat(rng: Generator) -> Model:
    """A flat TV on feet, a pillar, a bar or a plate."""
    width = rng.uniform(0.62, 1.15)
    high = width * rng.uniform(0.56, 0.6)
    deep, rim = rng.uniform(0.03, 0.06), rng.uniform(0.006, 0.028)
    chin = rim * rng.choice([1.0, 1.6, 2.4])
    build = Builder()
    case = build.paint("case", one_of(rng, CASES), specular=0.4, shininess=0.6)
    foot = build.paint("foot", one_of(rng, CASES), specular=0.4, shininess=0.6)
    lift = rng.uniform(0.03, 0.09)
    build.mesh("case", box(width, deep, high, bevel=0.006).moved(z=lift), case)
    build.mesh(
        "back",
        box(width * 0.6, 0.04, high * 0.55, bevel=0.015).moved(y=deep / 2 + 0.01, z=lift + 0.1),
        case,
    )
    screen(
        build,
        rng,
        width - 2 * rim,
        high - rim - chin,
        pos=(0, -deep / 2 - 0.0015, lift + chin + (high - rim - chin) / 2),
        held_out=False,
    )
    base = rng.uniform(0.18, 0.26)
    stand = str(rng.choice(["feet", "pillar", "bar", "oval"]))
    build.mesh("foot", _stand(stand, width, base, lift + 0.02), foot)
    return _finish(build, width, base, high + lift)


def _stand(style: str, width: float, deep: float, lift: float) -> Mesh:
    if style == "feet":
        leg = [[0, -deep / 2, 0.006], [0, 0, lift], [0, deep / 2, 0.006]]
        return joined([tube(leg, 0.007, steps=6).moved(x=side * width * 0.36) for side in (-1, 1)])
    if style == "bar":
        plate = box(width * 0.7, deep, 0.012, bevel=0.004)
        posts = [box(0.03, 0.02, lift, bevel=0.003).moved(x=s * width * 0.25) for s in (-1, 1)]
        return joined([plate, *posts])
    post = box(0.09, 0.025, lift, bevel=0.005)
    if style == "pillar":
        return joined([box(width * 0.42, deep, 0.014, bevel=0.005), post])
    angle = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    from tpvqa_household.kitchen.assets.shapes import slab

    oval = np.stack([0.24 * width * np.cos(angle), deep / 2 * np.sin(angle)], 1)
    return joined([slab(oval, 0, 0.014, bevel=0.005), post])


def _finish(build: Builder, x: float, y: float, z: float) -> Model:
    build.solid("box", (x / 2, y / 2, z / 2), (0, 0, z / 2))
    return build.done("tv", (x, y, z), 9.0)


def tube_set(rng: Generator) -> Model:
    """Held out: a deep old set with knobs, in plastic or wood colours."""
    width = rng.uniform(0.5, 0.68)
    high, deep = width * rng.uniform(0.74, 0.82), width * rng.uniform(0.6, 0.75)
    build = Builder()
    shell = one_of(rng, ((0.32, 0.2, 0.12), (0.7, 0.7, 0.68), (0.12, 0.12, 0.13), (0.75, 0.3, 0.2)))
    case = build.paint("case", shell, specular=0.3)
    front = build.paint("front", near(rng, (0.16, 0.15, 0.15)))
    knob = build.paint("knob", (0.8, 0.78, 0.7), specular=0.6)
    legs = 0.05
    build.mesh(
        "case", box(width, 0.45 * deep, high, bevel=0.02).moved(y=-0.25 * deep, z=legs), case
    )
    build.mesh(
        "tail",
        box(0.72 * width, 0.6 * deep, 0.72 * high, bevel=0.06).moved(
            y=0.2 * deep, z=legs + 0.14 * high
        ),
        case,
    )
    face = -0.475 * deep
    build.mesh(
        "front",
        box(0.95 * width, 0.01, 0.92 * high, bevel=0.004).moved(
            y=face - 0.002, z=legs + 0.04 * high
        ),
        front,
    )
    side = rng.random() < 0.6
    x = 0.7 * width if side else 0.86 * width
    z = 0.78 * high if side else 0.68 * high
    off = -0.09 * width if side else 0.0
    up = legs + (0.5 if side else 0.57) * high
    screen(build, rng, x, z, pos=(off, face - 0.009, up), held_out=True)
    for k in range(2):
        place = (
            (0.37 * width, face - 0.012, legs + (0.75 - 0.2 * k) * high)
            if side
            else ((0.3 - 0.12 * k) * width, face - 0.012, legs + 0.12 * high)
        )
        build.shape(f"knob{k}", "cylinder", (0.022, 0.012), knob, pos=place, euler=(90, 0, 0))
    for k, (sx, sy) in enumerate(((-1, -1), (1, -1), (-1, 0.4), (1, 0.4))):
        build.shape(
            f"leg{k}",
            "cylinder",
            (0.014, legs / 2 + 0.01),
            knob,
            pos=(sx * 0.38 * width, sy * 0.4 * deep, legs / 2 + 0.01),
        )
    return _finish(build, width, deep, high + legs)


def easel(rng: Generator) -> Model:
    """Held out: a framed flat screen, leaning on three wooden legs."""
    width = rng.uniform(0.7, 1.0)
    high, rim = width * 0.6, rng.uniform(0.03, 0.05)
    build = Builder()
    wood = build.paint(
        "wood", one_of(rng, ((0.72, 0.52, 0.32), (0.4, 0.26, 0.15), (0.9, 0.9, 0.88)))
    )
    lift = rng.uniform(0.1, 0.2)
    build.mesh("frame", box(width, 0.035, high, bevel=0.01).moved(z=lift), wood)
    screen(
        build, rng, width - 2 * rim, high - 2 * rim, pos=(0, -0.019, lift + high / 2), held_out=True
    )
    legs = [
        [[s * 0.12 * width, 0, lift + 0.7 * high], [s * 0.34 * width, -0.07, 0.01]] for s in (-1, 1)
    ]
    legs.append([[0, 0.02, lift + 0.7 * high], [0, 0.2, 0.01]])
    build.mesh(
        "legs",
        joined([tube(np.linspace(a, b, 3), 0.012, steps=8).moved(y=0.03) for a, b in legs]),
        wood,
    )
    return _finish(build, width, 0.3, high + lift)
