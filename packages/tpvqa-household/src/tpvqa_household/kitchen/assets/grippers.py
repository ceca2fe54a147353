"""Two-fingered grippers with a piece of forearm.

A gripper's frame is unlike that of other things: the origin is the point between the finger
tips, z is where the fingers point (`Grasp.approach`), y is how they close (`Grasp.axis`). The
bodies "left" and "right" slide along +y and -y; the joint's value is half the opening. The body
"forearm" turns freely about the wrist and reaches along its own -z. Grippers have no solids.
"""

from collections.abc import Callable

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets import fingers
from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.fingers import Finger
from tpvqa_household.kitchen.assets.mesh import joined
from tpvqa_household.kitchen.assets.model import Joint, Model
from tpvqa_household.kitchen.assets.paint import Colour, hsv, near, one_of
from tpvqa_household.kitchen.assets.shapes import box, tube

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


def any_colour(rng: Generator) -> Colour:
    """Pale, dark, the grey of metal or plastic, or saturated."""
    draw = rng.random()
    if draw < 0.3:
        return hsv(rng.random(), rng.uniform(0, 0.15), rng.uniform(0.75, 1))
    if draw < 0.45:
        return hsv(rng.random(), rng.uniform(0, 0.3), rng.uniform(0.04, 0.2))
    if draw < 0.65:
        return hsv(rng.random(), rng.uniform(0, 0.06), rng.uniform(0.35, 0.8))
    return hsv(rng.random(), rng.uniform(0.4, 1), rng.uniform(0.35, 1))


def _varied(finger: Finger) -> Callable[[Generator], Model]:
    def make(rng: Generator) -> Model:
        accent = any_colour(rng)
        return _gripper(
            rng,
            finger,
            round_palm=rng.random() < 0.5,
            shell=any_colour(rng) if rng.random() < 0.7 else accent,
            accent=accent,
            pad_colour=any_colour(rng) if rng.random() < 0.6 else accent,
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
    "thin": _of(fingers.thin),
    "thick": _of(fingers.thick),
    "rounded": _of(fingers.rounded, round_palm=True),
    "knuckled": _of(fingers.knuckled),
    "fin-ray": _of(fingers.fin_ray, round_palm=True),
    "slender": _varied(fingers.slender),
    "curved": _varied(fingers.curved),
    "forked": _varied(fingers.forked),
    "strap": _varied(fingers.strap),
    "paddle": _varied(fingers.paddle),
    "bellows": _varied(fingers.bellows),
}
HELD_OUT: dict[str, Callable[[Generator], Model]] = {
    "claw": _held_out(fingers.claw, round_palm=True),
    "mitten": _held_out(fingers.mitten, round_palm=False),
    "tongs": _held_out(fingers.tongs, round_palm=False),
}
