"""Utensils and odds and ends, among them what may be taken for a knife."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Floats, Mesh, joined
from tpvqa_household.kitchen.assets.model import Grasp, Model
from tpvqa_household.kitchen.assets.paint import Colour, clouds, hsv, mix, near, one_of, png
from tpvqa_household.kitchen.assets.shapes import blob, box, slab, surface, tube
from tpvqa_household.kitchen.assets.textures import draw_texture

STEEL: Colour = (0.76, 0.77, 0.79)
HANDLES: tuple[Colour, ...] = (STEEL, (0.08, 0.08, 0.08), (0.5, 0.32, 0.18), (0.65, 0.1, 0.1))


def _sheet(grid: Floats, thick: float) -> Mesh:
    """A grid of points made into a thin two-sided sheet."""
    top = surface(grid)
    n = len(top.points)
    points = np.r_[top.points, top.points - [0, 0, thick]]
    return Mesh(points, np.r_[top.uv, top.uv], np.r_[top.faces, top.faces[:, ::-1] + n])


def _long(build: Builder, kind: str, x: float, y: float, z: float) -> Model:
    build.solid("box", (x / 2, y / 3, z / 2), (0, 0, z / 2))
    return build.done(
        kind,
        (x, y, z),
        0.08,
        colour=build.paints[0].rgba[:3],
        grasps=(Grasp((-0.25 * x, 0, z / 2), (0, 1, 0), (1, 0, 0), width=0.016),),
    )


def _stem(x: float, end: float, thick: float) -> Mesh:
    """A slim handle from the left end, bent up a little, as of spoons and forks."""
    t = np.linspace(0, 1, 9)
    path = np.stack([-x / 2 + t * (end + x / 2), 0 * t, 0.006 + 0.006 * np.sin(np.pi * t)], 1)
    return tube(
        path, thick * np.interp(t, [0, 0.15, 0.8, 1], [1.1, 1.3, 0.7, 0.6]), steps=8, flat=0.4
    )


def spoon(rng: Generator) -> Model:
    """A spoon: a hollow bowl on a slim handle."""
    x = rng.uniform(0.15, 0.21)
    build = Builder()
    build.paint("steel", near(rng, STEEL, 0.03), specular=0.9, shininess=0.8)
    build.paint("grip", one_of(rng, HANDLES), specular=0.4)
    a, b = 0.17 * x, 0.115 * x
    u = np.linspace(0, 1, 7)
    angle = np.linspace(0, 2 * np.pi, 21)
    grid = np.stack(
        [
            np.outer(u, a * np.cos(angle)),
            np.outer(u, b * np.sin(angle)),
            0.012 * np.outer(u**2, np.ones(21)) + 0.003,
        ],
        -1,
    )
    middle = x / 2 - a
    build.mesh("bowl", _sheet(grid, 0.0012).moved(x=middle), "steel")
    build.mesh("handle", _stem(x, middle - 0.9 * a, 0.0055).moved(z=0.004), "grip", crease=60)
    return _long(build, "spoon", x, 2 * b, 0.018)


def fork(rng: Generator) -> Model:
    """A fork with three or four prongs."""
    x = rng.uniform(0.17, 0.21)
    build = Builder()
    build.paint("steel", near(rng, STEEL, 0.03), specular=0.9, shininess=0.8)
    build.paint("grip", one_of(rng, HANDLES), specular=0.4)
    count, wide = int(rng.choice([3, 4])), rng.uniform(0.02, 0.026)
    start = x / 2 - 0.075
    lanes = (np.arange(count) - (count - 1) / 2) * wide / count
    prongs = [
        tube(
            [[start + 0.025, lane, 0.006], [start + 0.05, lane, 0.005], [x / 2, lane, 0.012]],
            [0.0022, 0.002, 0.001],
            steps=5,
        )
        for lane in lanes
    ]
    t = np.linspace(0, 1, 6)
    half = np.interp(t, [0, 0.6, 1], [0.003, wide * 0.48, wide * 0.48])
    root = np.stack(
        [np.stack([start + 0.03 * t, s * half, 0.007 - 0.001 * t], 1) for s in (-1, 1)], 1
    )
    build.mesh("prongs", joined([*prongs, _sheet(root, 0.002)]), "steel")
    build.mesh("handle", _stem(x, start + 0.004, 0.0055), "grip", crease=60)
    return _long(build, "fork", x, wide, 0.016)


def spatula(rng: Generator) -> Model:
    """A turner: a broad slotted plate on a long handle."""
    x = rng.uniform(0.26, 0.32)
    build = Builder()
    build.paint(
        "blade", one_of(rng, ((0.1, 0.1, 0.1), STEEL, (0.65, 0.47, 0.28), (0.7, 0.15, 0.12)))
    )
    build.paint("grip", one_of(rng, HANDLES))
    wide, long = rng.uniform(0.06, 0.08), rng.uniform(0.08, 0.1)
    bars = [
        box(long, wide / 6, 0.003).moved(x=x / 2 - long / 2, y=(k - 2) * wide / 4.4, z=0.004)
        for k in range(5)
    ]
    ends = [box(0.012, wide, 0.003).moved(x=p, z=0.004) for p in (x / 2 - 0.006, x / 2 - long)]
    build.mesh("blade", joined([*bars, *ends]), "blade")
    t = np.linspace(0, 1, 6)
    path = np.stack([-x / 2 + t * (x - long), 0 * t, 0.01 + 0.008 * np.sin(np.pi * t)], 1)
    build.mesh(
        "handle", tube(path, np.interp(t, [0, 0.5, 1], [0.01, 0.008, 0.004]), steps=8), "grip"
    )
    return _long(build, "spatula", x, wide, 0.022)


def peeler(rng: Generator) -> Model:
    """Held out, for knives: a Y-shaped peeler."""
    x = rng.uniform(0.13, 0.15)
    build = Builder()
    build.paint("grip", one_of(rng, ((0.75, 0.2, 0.15), (0.1, 0.1, 0.1), (0.2, 0.5, 0.3))))
    build.paint("steel", STEEL, specular=0.9)
    fork_x = 0.12 * x
    arms = [
        tube(
            [[fork_x, 0, 0.01], [fork_x + 0.02, s * 0.028, 0.01], [x / 2, s * 0.028, 0.01]],
            0.005,
            steps=7,
        )
        for s in (-1, 1)
    ]
    handle = tube(
        np.linspace([-x / 2, 0, 0.01], [fork_x, 0, 0.01], 5),
        [0.009, 0.011, 0.009, 0.008, 0.006],
        steps=9,
    )
    build.mesh("grip", joined([handle, *arms]), "grip")
    build.mesh("blade", box(0.009, 0.056, 0.0015).moved(x=x / 2 - 0.006, z=0.012), "steel")
    return _long(build, "peeler", x, 0.066, 0.021)


def whisk(rng: Generator) -> Model:
    """Held out, for knives: a balloon whisk."""
    x = rng.uniform(0.24, 0.3)
    build = Builder()
    build.paint("wire", near(rng, STEEL), specular=0.9)
    build.paint("grip", one_of(rng, HANDLES))
    t = np.linspace(0, np.pi, 11)
    r, long = rng.uniform(0.026, 0.034), 0.45 * x
    middle = x / 2 - long
    loop = np.stack([middle + long * np.sin(t) ** 0.8, r * np.cos(t), 0 * t], 1)
    loop[[0, -1], 1] *= 0.25
    wires = [tube(loop, 0.0011, steps=4).turned(0, a) for a in (0, 45, 90, 135)]
    build.mesh("wire", joined(wires).moved(z=r), "wire")
    build.mesh("handle", tube([[-x / 2, 0, r], [middle, 0, r]], 0.009, steps=9), "grip")
    return _long(build, "whisk", x, 2 * r, 2 * r)


def book(rng: Generator) -> Model:
    """A closed book lying flat."""
    x, y, z = rng.uniform(0.14, 0.22), rng.uniform(0.19, 0.28), rng.uniform(0.015, 0.04)
    build = Builder()
    size = 96
    cover = np.ones((size, size, 3)) * np.array(
        hsv(rng.random(), rng.uniform(0.2, 0.9), rng.uniform(0.2, 0.9))
    )
    ink = hsv(rng.random(), rng.uniform(0, 0.8), rng.uniform(0.6, 1.0))
    for row in (16, 24, 80):
        wide = int(rng.integers(14, 38))
        cover[row : row + 5, 48 - wide : 48 + wide] = ink
    yy, xx = np.mgrid[0:size, 0:size]
    cover[np.hypot(xx - 48, yy - 52) < rng.uniform(8, 20)] = ink
    build.paint("cover", texture=png(cover), specular=0.3)
    build.paint("pages", (0.93, 0.9, 0.82))
    boards = [
        box(x, y, 0.003),
        box(x, y, 0.003).moved(z=z - 0.003),
        box(0.004, y, z).moved(x=-x / 2),
    ]
    build.mesh("cover", joined(boards), "cover")
    build.mesh("pages", box(x - 0.006, y - 0.008, z - 0.006).moved(z=0.003), "pages")
    build.standing("box", (x, y, z))
    return build.done("book", (x, y, z), 0.4, colour=(0.5, 0.4, 0.4))


def cloth(rng: Generator) -> Model:
    """A kitchen cloth, folded or lying in waves."""
    x, y = rng.uniform(0.16, 0.26), rng.uniform(0.13, 0.2)
    build = Builder()
    use = ("table", "wall")[int(rng.integers(2))]
    build.paint(
        "cloth",
        texture=draw_texture("table" if use == "table" else "wall", rng, held_out=False).png,
        specular=0.0,
    )
    n = 16
    u, v = np.meshgrid(np.linspace(-0.5, 0.5, n), np.linspace(-0.5, 0.5, n), indexing="ij")
    bumps = clouds(rng, n, n, rows=2, columns=2, octaves=2)
    height = 0.006 + 0.022 * bumps * (1 - (2 * np.maximum(np.abs(u), np.abs(v))) ** 4)
    skew = 0.02 * np.sin(4 * v + rng.uniform(0, 6))
    grid = np.stack([u * x + skew, v * y, height], -1)
    build.mesh("cloth", _sheet(grid, 0.004), "cloth", crease=70)
    build.standing("box", (x, y, 0.012))
    return build.done("cloth", (x + 0.04, y, 0.03), 0.06, colour=(0.6, 0.6, 0.6))


def sponge(rng: Generator) -> Model:
    """A washing-up sponge with a scouring side."""
    x, y, z = rng.uniform(0.085, 0.11), rng.uniform(0.055, 0.07), rng.uniform(0.028, 0.04)
    build = Builder()
    size = 64
    holes = clouds(rng, size, size, rows=16, columns=16, octaves=2)
    colour = one_of(rng, ((0.95, 0.85, 0.25), (0.9, 0.5, 0.6), (0.4, 0.65, 0.85)))
    build.paint(
        "foam",
        texture=png(
            mix(
                colour,
                (colour[0] * 0.6, colour[1] * 0.6, colour[2] * 0.5),
                np.clip(holes - 0.55, 0, 1) * 2.5,
            )
        ),
    )
    build.paint("pad", near(rng, (0.15, 0.38, 0.2)))
    build.mesh("foam", box(x, y, z, bevel=0.004), "foam")
    build.mesh("pad", box(x, y, 0.008, bevel=0.002).moved(z=z), "pad")
    build.standing("box", (x, y, z + 0.008))
    return build.done(
        "sponge",
        (x, y, z + 0.008),
        0.03,
        colour=colour,
        grasps=(Grasp((0, 0, z / 2), (0, 1, 0), (0, 0, -1), width=y),),
    )


def remote(rng: Generator) -> Model:
    """A remote control with rows of buttons."""
    x, y, z = rng.uniform(0.14, 0.2), rng.uniform(0.04, 0.055), 0.02
    build = Builder()
    build.paint("case", one_of(rng, ((0.06, 0.06, 0.07), (0.75, 0.75, 0.77))), specular=0.4)
    build.paint("keys", one_of(rng, ((0.5, 0.5, 0.52), (0.15, 0.15, 0.16))))
    build.paint("power", (0.8, 0.1, 0.1))
    build.mesh("case", box(x, y, z, bevel=0.006), "case")
    keys = [
        blob(0.009, 0.008, 0.004, rows=4, columns=8).moved(x=a, y=b, z=z - 0.001)
        for a in np.arange(-0.36, 0.3, 0.11) * x
        for b in (-0.28 * y, 0, 0.28 * y)
    ]
    build.mesh("keys", joined(keys), "keys")
    build.shape("power", "ellipsoid", (0.006, 0.006, 0.003), "power", pos=(0.42 * x, 0.2 * y, z))
    build.standing("box", (x, y, z))
    return build.done(
        "remote",
        (x, y, z),
        0.15,
        colour=build.paints[0].rgba[:3],
        grasps=(Grasp((0, 0, z / 2), (0, 1, 0), (0, 0, -1), width=y),),
    )


def pencil_case(rng: Generator) -> Model:
    """Held out: a round pouch."""
    x, y = rng.uniform(0.18, 0.22), rng.uniform(0.05, 0.07)
    build = Builder()
    build.paint("cloth", hsv(rng.random(), 0.6, rng.uniform(0.3, 0.8)))
    build.paint("zip", (0.8, 0.75, 0.4), specular=0.7)
    t = np.linspace(0, 2 * np.pi, 20, endpoint=False)
    outline = np.stack(
        [
            x / 2 * np.sign(np.cos(t)) * np.abs(np.cos(t)) ** 0.35,
            y / 2 * np.sign(np.sin(t)) * np.abs(np.sin(t)) ** 0.6,
        ],
        1,
    )
    build.mesh("case", slab(outline, 0, 0.045, bevel=0.014), "cloth", crease=60)
    build.mesh("zip", box(0.8 * x, 0.004, 0.003).moved(z=0.044), "zip")
    build.standing("box", (x, y, 0.045))
    return build.done("pencil_case", (x, y, 0.047), 0.1, colour=build.paints[0].rgba[:3])
