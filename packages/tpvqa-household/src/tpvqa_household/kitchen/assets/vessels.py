"""Vessels that stand about in a kitchen, among them what may be taken for a plate."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, joined
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, clouds, hsv, mix, near, one_of, png
from tpvqa_household.kitchen.assets.shapes import box, lathe, slab, tube

CERAMICS: tuple[Colour, ...] = (
    (0.94, 0.94, 0.92),
    (0.85, 0.8, 0.68),
    (0.3, 0.45, 0.6),
    (0.65, 0.2, 0.16),
    (0.25, 0.42, 0.32),
    (0.2, 0.2, 0.22),
)
STEEL: Colour = (0.72, 0.73, 0.75)
Profile = Sequence[tuple[float, float]]


def finish(build: Builder, kind: str, radius: float, z: float, mass: float) -> Model:
    """An upright round thing."""
    build.standing("cylinder", (2 * radius, 2 * radius, z))
    return build.done(
        kind,
        (2 * radius, 2 * radius, z),
        mass,
        grasps=(Grasp((0, 0, 0.6 * z), (1, 0, 0), (0, 1, 0), width=1.96 * radius),),
        colour=build.paints[0].rgba[:3],
    )


def _hollow(outer: Profile, wall: float) -> list[tuple[float, float]]:
    """An open vessel from its outer profile: up the outside, over the lip, down the inside."""
    inner = [(max(r - wall, 0.0), max(z, wall)) for r, z in outer]
    lip_r, lip_z = outer[-1]
    return [
        (0.0, outer[0][1]),
        *outer,
        (lip_r - wall / 2, lip_z + wall / 3),
        *inner[::-1],
        (0.0, wall),
    ]


def _handle(x: float, low: float, high: float, reach: float, thick: float) -> Mesh:
    t = np.linspace(0, np.pi, 10)
    middle, half = (low + high) / 2, (high - low) / 2
    path = np.stack([x + reach * np.sin(t), 0 * t, middle - half * np.cos(t)], 1)
    return tube(path, thick, steps=7)


def mug(rng: Generator) -> Model:
    """A mug with a handle, plain or with bands."""
    r, z = rng.uniform(0.036, 0.046), rng.uniform(0.08, 0.105)
    build = Builder()
    colour = one_of(rng, CERAMICS)
    texture = bands(rng, colour) if rng.random() < 0.4 else None
    build.paint("glaze", (1, 1, 1) if texture else colour, texture=texture, specular=0.5)
    taper = rng.uniform(0.8, 1.0)
    outer = [(r * taper * 0.92, 0.0), (r * taper, 0.006), (r, z * 0.6), (r, z)]
    build.mesh("body", lathe(_hollow(outer, 0.004), steps=28), "glaze")
    build.mesh("handle", _handle(r - 0.004, 0.2 * z, 0.8 * z, 0.03, 0.006), "glaze")
    return finish(build, "mug", r, z, 0.3)


def bands(rng: Generator, colour: Colour) -> bytes:
    """Rings around a vessel."""
    v = np.linspace(1, 0, 64)
    ink = hsv(rng.random(), rng.uniform(0.3, 0.9), rng.uniform(0.2, 0.8))
    mark = np.zeros(64)
    for _ in range(int(rng.integers(1, 4))):
        mark[np.abs(v - rng.uniform(0.1, 0.45)) < rng.uniform(0.01, 0.05)] = 1
    return png(mix(colour, ink, mark[:, None] * np.ones((1, 8))))


def bowl(rng: Generator) -> Model:
    """A deep bowl: clearly no plate."""
    r, z = rng.uniform(0.065, 0.11), rng.uniform(0.055, 0.085)
    build = Builder()
    build.paint("glaze", one_of(rng, CERAMICS), specular=0.5)
    t = np.linspace(0, np.pi / 2, 9)
    outer = [(0.4 * r, 0.0), *((r * (0.42 + 0.58 * np.sin(a)), z * (1 - np.cos(a))) for a in t[1:])]
    build.mesh("body", lathe(_hollow(outer, 0.004), steps=32), "glaze")
    return finish(build, "bowl", r, z, 0.35)


def cup_and_saucer(rng: Generator) -> Model:
    """A small cup on its saucer."""
    r = rng.uniform(0.06, 0.075)
    build = Builder()
    build.paint("glaze", one_of(rng, CERAMICS[:3]), specular=0.5)
    build.paint("coffee", (0.16, 0.09, 0.05), specular=0.4)
    saucer = [
        (0, 0.001),
        (0.5 * r, 0),
        (r, 0.012),
        (r - 0.003, 0.015),
        (0.5 * r, 0.004),
        (0, 0.004),
    ]
    c, z = 0.55 * r, rng.uniform(0.05, 0.065)
    cup = [(0.5 * c, 0.0), (0.7 * c, 0.008), (0.95 * c, 0.6 * z), (c, z)]
    meshes = [
        lathe(saucer, steps=30),
        lathe(_hollow(cup, 0.003), steps=24).moved(z=0.005),
        _handle(0.85 * c, 0.25 * z, 0.8 * z, 0.02, 0.004).moved(z=0.005),
    ]
    build.mesh("body", joined(meshes), "glaze")
    build.shape("coffee", "cylinder", (0.88 * c, 0.001), "coffee", pos=(0, 0, 0.75 * z))
    return finish(build, "saucer", r, z + 0.005, 0.25)


def lid(rng: Generator) -> Model:
    """A pan's lid: domed, with a knob in the middle."""
    r = rng.uniform(0.085, 0.13)
    build = Builder()
    steel = rng.random() < 0.6
    build.paint("lid", near(rng, STEEL) if steel else one_of(rng, CERAMICS[1:]), specular=0.7)
    build.paint("knob", one_of(rng, ((0.05, 0.05, 0.05), (0.45, 0.28, 0.15), STEEL)))
    rise = rng.uniform(0.02, 0.035)
    t = np.linspace(1, 0, 9)
    dome = [(0.0, 0.001), (r * 0.97, 0.0), (r, 0.004), (r, 0.009)]
    dome += [(r * 0.97 * a, 0.009 + rise * (1 - a**2)) for a in t]
    build.mesh("body", lathe(dome, steps=36), "lid", crease=25)
    top = 0.009 + rise
    knob = [(0.0, 0.0), (0.009, 0.0), (0.009, 0.012), (0.02, 0.018), (0.018, 0.028), (0.0, 0.03)]
    build.mesh("knob", lathe(knob, steps=16).moved(z=top - 0.001), "knob")
    return finish(build, "lid", r, top + 0.03, 0.4)


def tray(rng: Generator) -> Model:
    """Held out, for plates: a rectangular tray with grips."""
    x, y = rng.uniform(0.26, 0.34), rng.uniform(0.18, 0.24)
    build = Builder()
    build.paint("tray", one_of(rng, (*CERAMICS[1:5], (0.5, 0.34, 0.2))), specular=0.3)
    walls = [box(x, 0.008, 0.03, bevel=0.002).moved(y=s * y / 2) for s in (-1, 1)]
    walls += [box(0.008, y, 0.03, bevel=0.002).moved(x=s * x / 2) for s in (-1, 1)]
    grips = [
        tube(
            [
                [s * x / 2, -0.05, 0.03],
                [s * x / 2, -0.04, 0.05],
                [s * x / 2, 0.04, 0.05],
                [s * x / 2, 0.05, 0.03],
            ],
            0.006,
            steps=6,
        )
        for s in (-1, 1)
    ]
    build.mesh("body", joined([box(x, y, 0.008), *walls, *grips]), "tray")
    build.standing("box", (x, y, 0.03))
    return build.done("tray", (x, y, 0.055), 0.5, colour=build.paints[0].rgba[:3])


def pan(rng: Generator) -> Model:
    """A frying pan."""
    r, z = rng.uniform(0.1, 0.14), rng.uniform(0.04, 0.06)
    build = Builder()
    build.paint("pan", one_of(rng, ((0.08, 0.08, 0.09), STEEL, (0.6, 0.12, 0.1))), specular=0.6)
    build.paint("grip", (0.06, 0.06, 0.06))
    build.paint("inside", near(rng, (0.1, 0.1, 0.1)), specular=0.4)
    outer = [(0.8 * r, 0.0), (0.84 * r, 0.004), (r, z)]
    build.mesh("body", lathe(_hollow(outer, 0.003), steps=36), "pan")
    build.shape("inside", "cylinder", (0.8 * r, 0.001), "inside", pos=(0, 0, 0.004))
    path = [[r - 0.01, 0, z - 0.012], [r + 0.05, 0, z + 0.004], [r + 0.18, 0, z + 0.012]]
    build.mesh("handle", tube(path, [0.008, 0.01, 0.013], steps=8, flat=0.6), "grip")
    build.solid("cylinder", (r, z / 2), (0, 0, z / 2))
    build.solid("box", (0.09, 0.012, 0.01), (r + 0.09, 0, z))
    return build.done(
        "pan",
        (2 * r + 0.19, 2 * r, z + 0.02),
        0.9,
        colour=build.paints[0].rgba[:3],
        grasps=(Grasp((r + 0.12, 0, z + 0.01), (0, 1, 0), (-1, 0, 0), width=0.026),),
    )


def pot(rng: Generator) -> Model:
    """A cooking pot with two handles and a lid."""
    r, z = rng.uniform(0.085, 0.12), rng.uniform(0.09, 0.14)
    build = Builder()
    build.paint(
        "pot", near(rng, STEEL) if rng.random() < 0.5 else one_of(rng, CERAMICS), specular=0.7
    )
    build.paint("grip", (0.07, 0.07, 0.07))
    profile = [
        (0, 0),
        (r * 0.97, 0),
        (r, 0.006),
        (r, z),
        (r * 1.03, z + 0.004),
        (r, z + 0.01),
        (0.7 * r, z + 0.022),
        (0, z + 0.028),
    ]
    build.mesh("body", lathe(profile, steps=32), "pot", crease=30)
    handles = [
        _handle(0, -0.04, 0.04, 0.035, 0.007)
        .turned(0, 90)
        .turned(2, a)
        .moved(x=r * np.cos(np.radians(a)), y=r * np.sin(np.radians(a)), z=0.8 * z)
        for a in (0, 180)
    ]
    knob = lathe([(0, 0), (0.01, 0), (0.018, 0.014), (0, 0.02)], steps=14).moved(z=z + 0.026)
    build.mesh("handles", joined([*handles, knob]), "grip")
    return finish(build, "pot", r, z + 0.045, 1.2)


def _turned(
    kind: str, outline: Callable[[Generator], tuple[Floats, Colour, Colour]]
) -> Callable[[Generator], Model]:
    """A bottle, jar or can: a body, a label around it, a cap."""

    def make(rng: Generator) -> Model:
        curve, body, cap = outline(rng)
        build = Builder()
        r, z = float(curve[:, 0].max()), float(curve[-1, 1])
        build.paint("body", body, specular=0.6, shininess=0.7)
        build.paint("cap", cap, specular=0.4)
        build.mesh("body", lathe(curve, steps=24), "body", crease=35)
        low, high = 0.16 * z, (0.52 if kind == "bottle" else 0.84) * z
        build.paint("label", texture=label(rng))
        sleeve = [
            (r * 1.004, low),
            (r * 1.012, low + 0.001),
            (r * 1.012, high - 0.001),
            (r * 1.004, high),
        ]
        build.mesh("label", lathe(sleeve, steps=24), "label")
        neck = float(curve[-2, 0])
        lidded = [(0, 0), (neck * 1.08, 0), (neck * 1.08, 0.016), (0, 0.018)]
        if kind != "can":
            build.mesh("cap", lathe(lidded, steps=18).moved(z=z - 0.012), "cap", crease=30)
        return finish(build, kind, r, z + 0.006, 0.5)

    return make


def label(rng: Generator) -> bytes:
    """A printed label: a field of colour, a stripe, a badge and lines of print."""
    height, width = 64, 160
    base = hsv(rng.random(), rng.uniform(0.1, 0.9), rng.uniform(0.5, 1.0))
    ink = hsv(rng.random(), rng.uniform(0.5, 1.0), rng.uniform(0.15, 0.8))
    picture = np.ones((height, width, 3)) * np.array(base)
    band = int(rng.integers(6, 20))
    picture[:band] = ink
    y, x = np.mgrid[0:height, 0:width]
    for middle in (40, 120):
        badge = np.hypot(x - middle, (y - 30) * 1.2) < rng.uniform(10, 20)
        picture[badge] = hsv(rng.random(), 0.7, 0.9)
        for row in (50, 55):
            wide = int(rng.integers(10, 22))
            picture[row : row + 2, middle - wide : middle + wide] = (0.15, 0.15, 0.15)
    return png(picture)


def _bottle(rng: Generator) -> tuple[Floats, Colour, Colour]:
    r, z = rng.uniform(0.03, 0.042), rng.uniform(0.2, 0.31)
    neck, shoulder = rng.uniform(0.28, 0.4) * r / 0.9, rng.uniform(0.55, 0.68)
    curve = np.array(
        [
            (0, 0.003),
            (0.9 * r, 0),
            (r, 0.006),
            (r, shoulder * z),
            (0.75 * r, (shoulder + 0.12) * z),
            (neck, (shoulder + 0.2) * z),
            (neck, z),
            (0, z),
        ]
    )
    glass = one_of(
        rng,
        (
            (0.1, 0.25, 0.12),
            (0.3, 0.16, 0.06),
            (0.75, 0.82, 0.85),
            (0.7, 0.6, 0.1),
            (0.6, 0.1, 0.1),
        ),
    )
    return curve, glass, one_of(rng, CERAMICS)


def _jar(rng: Generator) -> tuple[Floats, Colour, Colour]:
    r, z = rng.uniform(0.032, 0.045), rng.uniform(0.08, 0.14)
    curve = np.array(
        [
            (0, 0.002),
            (0.95 * r, 0),
            (r, 0.006),
            (r, 0.82 * z),
            (0.88 * r, 0.9 * z),
            (0.88 * r, z),
            (0, z),
        ]
    )
    filling = one_of(rng, ((0.6, 0.1, 0.1), (0.75, 0.5, 0.1), (0.35, 0.2, 0.1), (0.4, 0.5, 0.15)))
    return curve, filling, one_of(rng, (*CERAMICS, (0.75, 0.6, 0.2)))


def _can(rng: Generator) -> tuple[Floats, Colour, Colour]:
    r, z = rng.uniform(0.031, 0.05), rng.uniform(0.07, 0.13)
    curve = np.array(
        [
            (0, 0.002),
            (r, 0),
            (r, 0.003),
            (r, z - 0.003),
            (r, z),
            (r - 0.003, z - 0.004),
            (0, z - 0.004),
        ]
    )
    return curve, near(rng, STEEL), STEEL


bottle = _turned("bottle", _bottle)
jar = _turned("jar", _jar)
can = _turned("can", _can)


def vase(rng: Generator) -> Model:
    """Held out: a curvy vase."""
    r, z = rng.uniform(0.05, 0.075), rng.uniform(0.17, 0.26)
    build = Builder()
    build.paint("glaze", one_of(rng, CERAMICS[2:]), specular=0.5)
    t = np.linspace(0, 1, 14)
    wave = r * (0.62 + 0.3 * np.sin(np.pi * (1.7 * t + rng.uniform(-0.1, 0.3))))
    outer = [(float(a), float(b)) for a, b in zip(wave, t * z, strict=True)]
    build.mesh("body", lathe(_hollow(outer, 0.004), steps=28), "glaze")
    return finish(build, "vase", float(wave.max()), z, 0.6)


def teapot(rng: Generator) -> Model:
    """Held out: a teapot with spout, handle and lid."""
    r = rng.uniform(0.07, 0.09)
    build = Builder()
    build.paint("glaze", one_of(rng, CERAMICS), specular=0.5)
    t = np.linspace(-np.pi / 2, np.pi / 2, 14)
    body = [(float(r * np.cos(a) ** 0.7), float(0.8 * r * (1 + np.sin(a)))) for a in t]
    knob = lathe([(0, 0), (0.008, 0), (0.014, 0.014), (0, 0.022)], steps=14).moved(z=1.58 * r)
    spout = tube(
        [[0.8 * r, 0, 0.5 * r], [1.3 * r, 0, 0.9 * r], [1.6 * r, 0, 1.4 * r]],
        [0.022, 0.014, 0.009],
        steps=10,
    )
    handle = _handle(0.8 * r, -0.5 * r, 0.5 * r, 0.6 * r, 0.008).turned(2, 180).moved(z=0.85 * r)
    build.mesh("body", joined([lathe(body, steps=28), knob, spout, handle]), "glaze", crease=50)
    pot = finish(build, "teapot", r, 1.6 * r + 0.02, 0.7)
    return replace(pot, extent=(3.2 * r, 2 * r, pot.extent[2]))


def cutting_board(rng: Generator) -> Model:
    """A wooden or plastic board with rounded corners, and a hole or a grip."""
    x, y, z = rng.uniform(0.26, 0.4), rng.uniform(0.18, 0.26), rng.uniform(0.012, 0.022)
    build = Builder()
    size = 96
    grain = clouds(rng, size, size, rows=16, columns=2, octaves=3)
    base = one_of(rng, ((0.72, 0.52, 0.32), (0.55, 0.36, 0.2), (0.85, 0.72, 0.52)))
    if rng.random() < 0.25:
        base, grain = (
            one_of(rng, ((0.9, 0.9, 0.88), (0.35, 0.6, 0.4), (0.3, 0.45, 0.7))),
            grain * 0.2,
        )
    build.paint(
        "board", texture=png(mix(base, (base[0] * 0.6, base[1] * 0.55, base[2] * 0.5), grain * 0.8))
    )
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    c, s = np.cos(angle), np.sin(angle)
    outline = np.stack(
        [np.sign(c) * np.abs(c) ** 0.18 * x / 2, np.sign(s) * np.abs(s) ** 0.18 * y / 2], 1
    )
    build.mesh("board", slab(outline, 0, z, bevel=0.003), "board")
    build.paint("hole", (0.1, 0.07, 0.05))
    build.shape("hole", "cylinder", (0.009, 0.0006), "hole", pos=(0.43 * x, 0.36 * y, z))
    build.standing("box", (x, y, z))
    build.top("top", (0, 0, z), (0.45 * x, 0.42 * y))
    return build.done("board", (x, y, z), 0.8, colour=base)
