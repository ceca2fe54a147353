"""Food and packets, among them what may be taken for an apple or a loaf."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Mesh, joined
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, clouds, hsv, mix, near, one_of, png
from tpvqa_household.kitchen.assets.shapes import blob, box, lathe, tube


def _round(build: Builder, kind: str, radius: float, z: float, mass: float) -> Model:
    build.solid("sphere", (min(radius, z / 2),), (0, 0, z / 2))
    return build.done(
        kind,
        (2 * radius, 2 * radius, z),
        mass,
        colour=build.paints[0].rgba[:3],
        grasps=(Grasp((0, 0, z / 2), (1, 0, 0), (0, 1, 0), width=1.9 * radius),),
    )


def _peel(rng: Generator, base: Colour, *, pores: float) -> bytes:
    size = 96
    fine = clouds(rng, size, size, rows=24, columns=24, octaves=2)
    broad = clouds(rng, size, size, rows=3, columns=3)
    picture = mix(base, near(rng, base, 0.12), broad)
    return png(picture * (1 - pores * np.clip(fine - 0.6, 0, 1))[..., None])


def orange(rng: Generator) -> Model:
    """An orange: even colour, pores, no dimple and no long stem."""
    r = rng.uniform(0.034, 0.045)
    build = Builder()
    colour = near(rng, (0.95, 0.52, 0.08))
    build.paint("peel", texture=_peel(rng, colour, pores=0.6), specular=0.3)
    build.paint("navel", (0.35, 0.42, 0.12))
    build.mesh("body", blob(2 * r, 2 * r, 1.92 * r, rows=16, columns=24), "peel", crease=70)
    build.shape("navel", "ellipsoid", (0.004, 0.004, 0.0015), "navel", pos=(0, 0, 1.92 * r))
    return _round(build, "orange", r, 1.92 * r, 0.18)


def lemon(rng: Generator) -> Model:
    """A lemon lying on its side."""
    x, y = rng.uniform(0.075, 0.095), rng.uniform(0.05, 0.06)
    build = Builder()
    build.paint("peel", texture=_peel(rng, near(rng, (0.96, 0.84, 0.2)), pores=0.4), specular=0.35)
    t = np.linspace(0, 1, 18)
    radius = y / 2 * np.clip(np.sin(np.pi * t) ** 0.75, 0.02, 1)
    radius[[1, 2, -3, -2]] = y / 2 * np.array([0.2, 0.36, 0.36, 0.24])
    body = tube(np.stack([(t - 0.5) * x, 0 * t, 0 * t + y / 2], 1), radius, steps=20)
    build.mesh("body", body, "peel", crease=70)
    build.standing("box", (0.8 * x, 0.7 * y, y))
    return build.done(
        "lemon",
        (x, y, y),
        0.12,
        colour=(0.95, 0.85, 0.2),
        grasps=(Grasp((0, 0, y / 2), (0, 1, 0), (0, 0, -1), width=0.95 * y),),
    )


def tomato(rng: Generator) -> Model:
    """A tomato: flat, glossy, with a green star on top."""
    r = rng.uniform(0.03, 0.043)
    z = r * rng.uniform(1.35, 1.6)
    build = Builder()
    build.paint("skin", near(rng, (0.82, 0.12, 0.06)), specular=0.8, shininess=0.8)
    build.paint("green", near(rng, (0.22, 0.42, 0.1)))
    t = np.linspace(-np.pi / 2, np.pi / 2, 16)
    lift = np.sin(t) - 0.14 * np.exp(-(((t - np.pi / 2) / 0.35) ** 2))
    curve = [
        (float(r * np.cos(a) ** 0.85), float(z * (b + 1) / 1.95))
        for a, b in zip(t, lift, strict=True)
    ]
    curve[0], curve[-1] = (0.0, curve[0][1]), (0.0, curve[-1][1])
    build.mesh("body", lathe(curve, steps=26), "skin", crease=70)
    top = curve[-1][1]
    rays = [
        tube(
            [[0, 0, top + 0.002], [0.45 * r, 0, top + 0.004], [0.75 * r, 0, top - 0.002]],
            [0.003, 0.003, 0.001],
            steps=5,
            flat=0.4,
        ).turned(2, a)
        for a in range(0, 360, 72)
    ]
    stalk = tube([[0, 0, top], [0.001, 0, top + 0.009]], 0.002, steps=5)
    build.mesh("star", joined([*rays, stalk]), "green")
    return _round(build, "tomato", r, z, 0.12)


def pear(rng: Generator) -> Model:
    """Held out, for apples: a pear."""
    r = rng.uniform(0.034, 0.04)
    z = r * rng.uniform(2.6, 3.0)
    build = Builder()
    colour = one_of(rng, ((0.72, 0.72, 0.25), (0.6, 0.62, 0.2), (0.65, 0.5, 0.25)))
    build.paint("peel", texture=_peel(rng, colour, pores=0.5), specular=0.25)
    build.paint("stem", (0.3, 0.2, 0.1))
    t = np.linspace(0, 1, 18)
    width = np.interp(t, [0, 0.1, 0.32, 0.55, 0.75, 0.9, 1], [0, 0.75, 1, 0.8, 0.45, 0.36, 0])
    smooth = np.convolve(np.r_[0, width, 0], [0.25, 0.5, 0.25])[2:-2]
    smooth[[0, -1]] = 0
    curve = [(float(r * a), float(z * b)) for a, b in zip(smooth, t, strict=True)]
    build.mesh("body", lathe(curve, steps=24), "peel", crease=80)
    build.mesh("stem", tube([[0, 0, z - 0.004], [0.004, 0, z + 0.016]], 0.0016, steps=5), "stem")
    return _round(build, "pear", r, z, 0.17)


def banana(rng: Generator) -> Model:
    """A banana lying on its side."""
    x = rng.uniform(0.16, 0.2)
    build = Builder()
    build.paint("peel", near(rng, (0.93, 0.79, 0.2)), specular=0.25)
    build.paint("tip", (0.25, 0.2, 0.08))
    t = np.linspace(-1, 1, 16)
    path = np.stack([t * x / 2, 0.045 * t**2 - 0.02, 0 * t + 0.018], 1)
    radius = 0.018 * np.clip(1.1 - np.abs(t) ** 5, 0.3, 1)
    build.mesh("body", tube(path, radius, steps=6), "peel", crease=50)
    build.shape("tip", "sphere", (0.006,), "tip", pos=(x / 2, 0.025, 0.018))
    build.standing("box", (x, 0.06, 0.034))
    return build.done(
        "banana",
        (x, 0.08, 0.036),
        0.15,
        colour=(0.93, 0.8, 0.2),
        grasps=(Grasp((0, -0.02, 0.018), (0, 1, 0), (0, 0, -1), width=0.034),),
    )


def croissant(rng: Generator) -> Model:
    """A croissant: a crescent of rolls."""
    x = rng.uniform(0.12, 0.16)
    build = Builder()
    gold = near(rng, (0.76, 0.48, 0.18))
    size = 64
    layers = 0.5 + 0.5 * np.sin(np.linspace(0, 22 * np.pi, size))[None, :] * np.ones((size, 1))
    patches = clouds(rng, size, size, rows=4, columns=4)
    build.paint(
        "crust",
        texture=png(mix(gold, (0.45, 0.22, 0.07), layers * 0.5 + patches * 0.3)),
        specular=0.3,
    )
    t = np.linspace(-1, 1, 30)
    angle = t * 1.25
    r = x / 2 / np.sin(1.25)
    path = np.stack([r * np.sin(angle), r * (1 - np.cos(angle)) - 0.015, 0 * t + 0.026], 1)
    bulge = 0.03 * np.cos(t * 1.35) * (0.9 + 0.22 * np.abs(np.sin((t + 1) * 3.5 * np.pi)))
    body = tube(path, np.clip(bulge, 0.005, 1), steps=14, flat=0.85)
    grid_uv = np.stack([body.uv[:, 1], body.uv[:, 0]], 1)
    build.mesh("body", body.mapped(grid_uv), "crust", crease=60)
    build.standing("box", (x, 0.07, 0.05))
    return build.done(
        "croissant",
        (x, 0.09, 0.052),
        0.08,
        colour=gold,
        grasps=(Grasp((0, 0, 0.026), (0, 1, 0), (0, 0, -1), width=0.055),),
    )


def cake(rng: Generator) -> Model:
    """Held out, for loaves: a cake on a round base with icing."""
    r, z = rng.uniform(0.08, 0.11), rng.uniform(0.06, 0.08)
    build = Builder()
    build.paint("sponge", one_of(rng, ((0.45, 0.25, 0.12), (0.85, 0.7, 0.42))))
    build.paint("icing", one_of(rng, ((0.96, 0.93, 0.9), (0.95, 0.6, 0.7), (0.3, 0.16, 0.08))))
    build.paint("cherry", (0.75, 0.05, 0.1), specular=0.7)
    body = lathe([(0, 0), (r, 0), (r, 0.8 * z), (0, 0.8 * z)], steps=32)
    icing = lathe(
        [(0, 0.76 * z), (r * 1.02, 0.72 * z), (r * 1.03, 0.94 * z), (r * 0.95, z), (0, z)], steps=32
    )
    build.mesh("sponge", body, "sponge", crease=30)
    build.mesh("icing", icing, "icing")
    for k in range(6):
        a = k * np.pi / 3
        build.shape(
            f"cherry{k}",
            "sphere",
            (0.009,),
            "cherry",
            pos=(float(0.7 * r * np.cos(a)), float(0.7 * r * np.sin(a)), z + 0.005),
        )
    build.standing("cylinder", (2 * r, 2 * r, z))
    return build.done("cake", (2 * r, 2 * r, z + 0.014), 0.8, colour=build.paints[1].rgba[:3])


def potato(rng: Generator) -> Model:
    """Held out, for loaves and apples: a potato."""
    x, y, z = rng.uniform(0.08, 0.12), rng.uniform(0.055, 0.07), rng.uniform(0.045, 0.055)
    build = Builder()
    colour = near(rng, (0.7, 0.55, 0.34))
    build.paint("skin", texture=_peel(rng, colour, pores=0.9))
    mesh = blob(x, y, z, rows=14, columns=20)
    bump = 1 + 0.06 * np.sin(mesh.points[:, 0] * 90 + 1) * np.cos(mesh.points[:, 1] * 70)
    build.mesh(
        "body",
        type(mesh)(mesh.points * np.c_[bump, bump, np.ones_like(bump)], mesh.uv, mesh.faces),
        "skin",
        crease=80,
    )
    build.standing("box", (0.8 * x, 0.8 * y, z))
    return build.done(
        "potato",
        (x, y, z),
        0.2,
        colour=colour,
        grasps=(Grasp((0, 0, z / 2), (0, 1, 0), (0, 0, -1), width=y),),
    )


def _print(rng: Generator) -> bytes:
    """The front of a packet: blocks of colour, a picture, lines of print."""
    size = 96
    picture = np.ones((size, size, 3)) * np.array(
        hsv(rng.random(), rng.uniform(0.3, 0.9), rng.uniform(0.5, 1))
    )
    picture[: int(rng.integers(14, 34))] = hsv(rng.random(), 0.8, rng.uniform(0.4, 1))
    y, x = np.mgrid[0:size, 0:size]
    for _ in range(int(rng.integers(2, 5))):
        cx, cy, r = rng.uniform(20, 76), rng.uniform(35, 75), rng.uniform(8, 20)
        picture[np.hypot(x - cx, y - cy) < r] = hsv(rng.random(), 0.7, 0.95)
    for row in (8, 84, 88):
        wide = int(rng.integers(18, 40))
        picture[row : row + 3, 48 - wide : 48 + wide] = 0.95 if row < 20 else 0.15
    return png(picture)


def packet(rng: Generator) -> Model:
    """A printed cardboard box: cereal, tea, pasta."""
    x, y, z = rng.uniform(0.09, 0.2), rng.uniform(0.045, 0.08), rng.uniform(0.12, 0.28)
    return _boxed(rng, "box", x, y, z)


def flat_packet(rng: Generator) -> Model:
    """A long low box in bread's size, for loaves."""
    x, y, z = rng.uniform(0.17, 0.25), rng.uniform(0.08, 0.11), rng.uniform(0.06, 0.1)
    if rng.random() < 0.5:
        return _boxed(rng, "box", x, y, z)
    build = Builder()
    card = near(rng, (0.68, 0.52, 0.34))
    build.paint("card", card)
    build.paint("tape", (0.8, 0.72, 0.55), specular=0.4)
    build.mesh("box", box(x, y, z, bevel=0.002), "card")
    build.mesh("tape", box(x + 0.001, 0.03, z + 0.0015), "tape")
    return _boxed_done(build, "box", x, y, z, card)


def _boxed(rng: Generator, kind: str, x: float, y: float, z: float) -> Model:
    build = Builder()
    build.paint("print", texture=_print(rng), specular=0.2)
    build.mesh("box", box(x, y, z, bevel=0.0015), "print")
    return _boxed_done(build, kind, x, y, z, (0.6, 0.5, 0.4))


def _boxed_done(build: Builder, kind: str, x: float, y: float, z: float, colour: Colour) -> Model:
    build.standing("box", (x, y, z))
    return build.done(
        kind,
        (x, y, z),
        0.3,
        colour=colour,
        grasps=(Grasp((0, 0, 0.6 * z), (0, 1, 0), (0, 0, -1), width=y),),
    )


def carton(rng: Generator) -> Model:
    """A milk or juice carton with a gable top."""
    w, z = rng.uniform(0.065, 0.08), rng.uniform(0.18, 0.24)
    build = Builder()
    build.paint("print", texture=_print(rng), specular=0.2)
    build.paint("top", (0.94, 0.95, 0.96))
    build.paint("cap", hsv(rng.random(), 0.8, 0.7))
    build.mesh("body", box(w, w, z), "print")
    ridge = np.array([[-w / 2, 0], [w / 2, 0]])
    roof = []
    for s in (-1, 1):
        a, b = [-w / 2, s * w / 2, z], [w / 2, s * w / 2, z]
        c, d = [ridge[1][0], 0, z + 0.035], [ridge[0][0], 0, z + 0.035]
        roof.append((a, b, c, d) if s < 0 else (b, a, d, c))
    quads = [Mesh.of([*q], [[0, 1, 2], [0, 2, 3]]) for q in roof]
    ends = [
        Mesh.of(
            [[s * w / 2, -s * w / 2, z], [s * w / 2, s * w / 2, z], [s * w / 2, 0, z + 0.035]],
            [[0, 1, 2]],
        )
        for s in (-1, 1)
    ]
    crest = box(w, 0.004, 0.02).moved(z=z + 0.033)
    build.mesh("top", joined([*quads, *ends, crest]), "top", crease=20)
    build.shape(
        "cap", "cylinder", (0.012, 0.006), "cap", pos=(0, -w / 4, z + 0.024), euler=(47, 0, 0)
    )
    build.standing("box", (w, w, z + 0.04))
    return build.done(
        "milk",
        (w, w, z + 0.053),
        1.0,
        colour=(0.9, 0.9, 0.9),
        grasps=(Grasp((0, 0, 0.55 * z), (1, 0, 0), (0, 1, 0), width=w),),
    )
