"""Tables, kitchen cabinets and TV stands."""

import numpy as np
from numpy.random import Generator

from tpvqa_household.kitchen.assets.builder import Builder
from tpvqa_household.kitchen.assets.mesh import Mesh, joined
from tpvqa_household.kitchen.assets.model import Model
from tpvqa_household.kitchen.assets.paint import Colour, near, one_of
from tpvqa_household.kitchen.assets.shapes import box, disc, tube
from tpvqa_household.kitchen.assets.textures import PALE, WOODS, Use, draw_texture

HEIGHT = 0.88
DEPTH = 0.6
TOP = 0.035


def textured(
    build: Builder, rng: Generator, name: str, use: Use, *, held_out: bool = False
) -> float:
    """A paint with a drawn texture; gives the repeats per metre for the mesh's texture places."""
    texture = draw_texture(use, rng, held_out=held_out)
    build.paint(name, texture=texture.png, specular=texture.shine, shininess=0.5)
    return 1 / texture.metres


def _legs(style: str, x: float, y: float, z: float, thick: float) -> Mesh:
    inset = thick / 2 + 0.02
    corners = [(sx * (x / 2 - inset), sy * (y / 2 - inset)) for sx in (-1, 1) for sy in (-1, 1)]
    if style == "square":
        return joined([box(thick, thick, z, bevel=0.004).moved(a, b) for a, b in corners])
    if style == "round":
        line = np.linspace([0, 0, 0.0], [0, 0, z], 4)
        shape = np.linspace(0.28, 0.5, 4) * thick
        return joined([tube(line, shape, steps=10).moved(a, b) for a, b in corners])
    legs = []
    for a, b in corners:
        line = np.linspace([a * 1.0, b * 1.0, 0.0], [a * 0.8, b * 0.72, z], 3)
        legs.append(tube(line, thick * 0.35, steps=8))
    return joined(legs)


def table(rng: Generator) -> Model:
    """A table with four legs, square or round top edges."""
    x, y, z = rng.uniform(1.1, 1.6), rng.uniform(0.75, 1.0), rng.uniform(0.7, 0.77)
    build = Builder()
    scale = textured(build, rng, "top", "table")
    leg = build.paint("leg", one_of(rng, (*WOODS, (0.1, 0.1, 0.1), (0.9, 0.9, 0.88))))
    thick = rng.uniform(0.022, 0.05)
    build.mesh(
        "top", box(x, y, thick, bevel=0.006, uv_scale=scale).moved(z=z - thick), "top", role="top"
    )
    style = str(rng.choice(["square", "round", "splayed"]))
    wide = rng.uniform(0.045, 0.09)
    build.mesh("legs", _legs(style, x, y, z - thick, wide), leg)
    if style != "splayed":
        rail = [box(x - 0.2, 0.02, 0.07).moved(y=s * (y / 2 - 0.08)) for s in (-1, 1)]
        rail += [box(0.02, y - 0.2, 0.07).moved(x=s * (x / 2 - 0.08)) for s in (-1, 1)]
        build.mesh("rails", joined(rail).moved(z=z - thick - 0.07), leg)
    return _table(build, x, y, z)


def _table(build: Builder, x: float, y: float, z: float, *, fill: float = 1.0) -> Model:
    half = (fill * x / 2, fill * y / 2)
    build.solid("box", (half[0], half[1], 0.03), (0, 0, z - 0.03))
    build.top("top", (0, 0, z), half)
    return build.done("table", (x, y, z), 25.0)


def round_table(rng: Generator) -> Model:
    """A round or oval table on a pillar."""
    x, z = rng.uniform(1.05, 1.3), rng.uniform(0.7, 0.76)
    y = x * rng.uniform(0.85, 1.0)
    build = Builder()
    scale = textured(build, rng, "top", "table")
    leg = build.paint("leg", one_of(rng, (*WOODS, (0.1, 0.1, 0.1))))
    top = disc(0.5, thickness=1.0, steps=40).scaled(x, y, 0.035).moved(z=z - 0.035)
    build.mesh("top", top.mapped(top.points[:, :2] * scale), "top", role="top")
    foot = joined(
        [
            tube(
                np.linspace([0, 0, 0.02], [0, 0, z - 0.035], 5),
                np.array([0.09, 0.05, 0.04, 0.05, 0.1]),
                steps=16,
            ),
            *[
                tube([[0, 0, 0.12], [0.2, 0, 0.06], [0.36, 0, 0.02]], 0.03, steps=8).turned(2, a)
                for a in (45, 135, 225, 315)
            ],
        ]
    )
    build.mesh("foot", foot, leg)
    # Only the square inside the ellipse can be relied on.
    return _table(build, x, y, z, fill=0.72)


def trestle_table(rng: Generator) -> Model:
    """Held out: boards or stone on trestles."""
    x, y, z = rng.uniform(1.2, 1.6), rng.uniform(0.75, 0.9), rng.uniform(0.71, 0.77)
    build = Builder()
    scale = textured(build, rng, "top", "table", held_out=True)
    leg = build.paint("leg", near(rng, (0.75, 0.6, 0.42)))
    build.mesh(
        "top", box(x, y, 0.03, bevel=0.003, uv_scale=scale).moved(z=z - 0.03), "top", role="top"
    )
    bars = []
    for s in (-1, 1):
        at = s * x * 0.32
        for t in (-1, 1):
            for u in (-1, 1):
                line = np.linspace(
                    [at + u * 0.12, t * y * 0.36, 0.0], [at, t * y * 0.32, z - 0.03], 3
                )
                bars.append(tube(line, 0.022, steps=4))
        bars.append(box(0.05, y * 0.85, 0.05).moved(x=at, z=z - 0.08))
    build.mesh("legs", joined(bars), leg, crease=30)
    return _table(build, x, y, z)


def fronts(
    build: Builder, rng: Generator, x: float, *, low: float, high: float, metal: str, paint: str
) -> None:
    """Doors or drawers with handles on the front of a cabinet."""
    style = str(rng.choice(["doors", "drawers", "mixed"]))
    grip = str(rng.choice(["bar", "knob", "long"]))
    gap, y = 0.003, -DEPTH / 2
    columns = 2 if x > 0.55 and style != "drawers" else 1
    rows = {"doors": [1.0], "drawers": [0.24, 0.38, 0.38], "mixed": [0.22, 0.78]}[style]
    frame = rng.random() < 0.4
    panels, handles = [], []
    top = high
    for k, share in enumerate(rows):
        tall = share * (high - low)
        wide = x / columns
        for column in range(columns):
            at = -x / 2 + wide * (column + 0.5)
            panels.append(
                box(wide - 2 * gap, 0.018, tall - 2 * gap, bevel=0.003).moved(
                    x=at, y=y - 0.009, z=top - tall + gap
                )
            )
            if frame:
                panels.append(
                    box(wide - 0.12, 0.008, max(tall - 0.12, 0.03), bevel=0.004).moved(
                        x=at, y=y - 0.02, z=top - tall / 2 - max(tall - 0.12, 0.03) / 2
                    )
                )
            door = style == "doors" or (style == "mixed" and k == 1)
            side = (1 - 2 * column) if columns == 2 else 1
            place = (at + side * (wide / 2 - 0.05), top - 0.12) if door else (at, top - 0.06)
            handles.append(
                _grip(grip, wide, upright=door).moved(x=place[0], y=y - 0.02, z=place[1])
            )
        top -= tall
    build.mesh("fronts", joined(panels), paint)
    build.mesh("handles", joined(handles), metal)


def _grip(style: str, wide: float, *, upright: bool) -> Mesh:
    if style == "knob":
        return tube([[0, 0, 0], [0, -0.012, 0], [0, -0.026, 0]], [0.006, 0.008, 0.016], steps=8)
    half = 0.06 if style == "bar" else min(0.3 * wide, 0.2)
    path = [[-half, 0, 0], [-half, -0.028, 0], [half, -0.028, 0], [half, 0, 0]]
    bar = tube(path, 0.0055, steps=6)
    return bar.turned(1, 90) if upright else bar


def cabinet(rng: Generator, *, held_out: bool, basin: float = 0.0) -> tuple[Builder, float]:
    """A floor cabinet with fronts; gives its width too.

    Args:
        rng: Decides colours and fronts.
        held_out: Which split.
        basin: Depth of the room left open at the top instead of a worktop.
    """
    x = float(rng.choice([0.45, 0.5, 0.6, 0.6, 0.8]))
    build = Builder()
    if rng.random() < 0.35:
        scale = textured(build, rng, "body", "cabinet", held_out=held_out)
    else:
        colours: tuple[Colour, ...] = (
            *PALE,
            (0.3, 0.4, 0.35),
            (0.2, 0.25, 0.35),
            (0.35, 0.35, 0.36),
        )
        if held_out:
            colours = ((0.75, 0.35, 0.25), (0.9, 0.75, 0.3), (0.45, 0.3, 0.4))
        build.paint("body", one_of(rng, colours), specular=rng.uniform(0, 0.4))
        scale = 1.0
    metal = build.paint(
        "metal",
        one_of(rng, ((0.75, 0.75, 0.77), (0.12, 0.12, 0.12), (0.7, 0.55, 0.3))),
        specular=0.8,
        shininess=0.7,
    )
    build.paint("plinth", (0.12, 0.11, 0.1))
    high = HEIGHT - TOP
    body = [box(x, DEPTH, high - 0.1 - basin, uv_scale=scale).moved(z=0.1)]
    if basin:
        wall = 0.016
        low = high - basin
        body += [
            box(wall, DEPTH, basin, uv_scale=scale).moved(x=s * (x - wall) / 2, z=low)
            for s in (-1, 1)
        ]
        body += [
            box(x, wall, basin, uv_scale=scale).moved(y=s * (DEPTH - wall) / 2, z=low)
            for s in (-1, 1)
        ]
    build.mesh("body", joined(body), "body")
    build.mesh("plinth", box(x, DEPTH - 0.06, 0.1).moved(y=0.03), "plinth")
    fronts(build, rng, x, low=0.1, high=high, metal=metal, paint="body")
    if not basin:
        scale = textured(build, rng, "worktop", "worktop", held_out=held_out)
        top = box(x, DEPTH + 0.03, TOP, bevel=0.004, uv_scale=scale)
        build.mesh("worktop", top.moved(y=-0.015, z=high), "worktop", role="top")
    return build, x


def counter(rng: Generator) -> Model:
    """A floor cabinet with a worktop."""
    return _counter(rng, held_out=False)


def bold_counter(rng: Generator) -> Model:
    """Held out: other colours and worktops."""
    return _counter(rng, held_out=True)


def _counter(rng: Generator, *, held_out: bool) -> Model:
    build, x = cabinet(rng, held_out=held_out)
    build.standing("box", (x, DEPTH, HEIGHT))
    build.top("top", (0, 0, HEIGHT), (x / 2, DEPTH / 2))
    return build.done("counter", (x, DEPTH + 0.06, HEIGHT), 40.0)


def wall_cabinet(rng: Generator) -> Model:
    """A cabinet that hangs on the wall; its back is at +y."""
    x, y, z = float(rng.choice([0.4, 0.6, 0.8])), 0.33, rng.uniform(0.55, 0.75)
    build = Builder()
    build.paint("body", one_of(rng, PALE + WOODS), specular=0.2)
    build.paint("metal", (0.7, 0.7, 0.72), specular=0.8)
    doors = [
        box(x / 2 - 0.006, 0.018, z - 0.006, bevel=0.003).moved(
            x=s * x / 4, y=-y / 2 - 0.009, z=0.003
        )
        for s in (-1, 1)
    ]
    build.mesh("body", joined([box(x, y, z), *doors]), "body")
    grips = [
        _grip("bar", x / 2, upright=True).moved(x=s * 0.04, y=-y / 2 - 0.018, z=0.13)
        for s in (-1, 1)
    ]
    build.mesh("handles", joined(grips), "metal")
    build.standing("box", (x, y, z))
    return build.done("wall_cabinet", (x, y + 0.05, z), 15.0)


def tvstand(rng: Generator) -> Model:
    """A low board with doors or open shelves."""
    return _tvstand(rng, held_out=False)


def tv_bench(rng: Generator) -> Model:
    """Held out: a slab on hairpin legs, or stacked blocks."""
    return _tvstand(rng, held_out=True)


def _tvstand(rng: Generator, *, held_out: bool) -> Model:
    x, y, z = rng.uniform(1.0, 1.6), rng.uniform(0.36, 0.48), rng.uniform(0.4, 0.62)
    build = Builder()
    scale = textured(build, rng, "body", "table" if held_out else "cabinet", held_out=held_out)
    build.paint("dark", (0.1, 0.09, 0.08))
    build.paint("metal", (0.6, 0.6, 0.62), specular=0.8)
    foot = 0.0
    if held_out:
        build.mesh("top", box(x, y, 0.05, bevel=0.005, uv_scale=scale).moved(z=z - 0.05), "body")
        legs = [
            tube([[a, b, z - 0.05], [a + 0.02, b, 0.0], [a + 0.06, b, z - 0.05]], 0.006, steps=6)
            for a in (-0.42 * x, 0.36 * x)
            for b in (-0.4 * y, 0.4 * y)
        ]
        build.mesh("legs", joined(legs), "dark")
        build.mesh("shelf", box(0.8 * x, 0.8 * y, 0.02, uv_scale=scale).moved(z=0.4 * z), "body")
    else:
        foot = rng.uniform(0.03, 0.14)
        build.mesh("legs", _legs("round", x, y, foot, 0.05), "dark")
        build.mesh("body", box(x, y, z - foot, bevel=0.004, uv_scale=scale).moved(z=foot), "body")
        columns = int(rng.integers(2, 4))
        wide = x / columns
        inner = z - foot - 0.05
        for k in range(columns):
            at = -x / 2 + wide * (k + 0.5)
            if rng.random() < 0.5:
                build.mesh(
                    f"open{k}",
                    box(wide - 0.04, 0.004, inner - 0.01).moved(
                        x=at, y=-y / 2 - 0.001, z=foot + 0.03
                    ),
                    "dark",
                )
            else:
                build.mesh(
                    f"door{k}",
                    box(wide - 0.02, 0.016, inner, bevel=0.003, uv_scale=scale).moved(
                        x=at, y=-y / 2 - 0.006, z=foot + 0.025
                    ),
                    "body",
                )
                build.mesh(
                    f"knob{k}",
                    _grip("knob", wide, upright=True).moved(x=at, y=-y / 2 - 0.014, z=z - 0.09),
                    "metal",
                )
    build.standing("box", (x, y, z))
    build.top("top", (0, 0, z), (x / 2, y / 2))
    return build.done("tvstand", (x, y + 0.06, z), 30.0)
