"""Textures for walls, floors, table tops and worktops: families for training, others held out.

Every texture repeats seamlessly and says how many metres one repeat measures.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.random import Generator

from tpvqa.errors import UnknownNameError
from tpvqa_household.kitchen.assets.mesh import Floats
from tpvqa_household.kitchen.assets.paint import Colour, clouds, hsv, mix, near, one_of, png

SIZE = 192
Use = Literal["wall", "floor", "table", "worktop", "cabinet"]


@dataclass(frozen=True, slots=True)
class Texture:
    """A repeating picture.

    Attributes:
        family: The way it was made.
        held_out: True if training must not show it.
        png: The picture's bytes.
        metres: The size of one repeat.
        shine: How strongly it reflects lights, 0..1.
        colour: Its mean colour.
    """

    family: str
    held_out: bool
    png: bytes
    metres: float
    shine: float
    colour: Colour


Made = tuple[Floats, float, float]
"""Picture, metres, shine."""

WOODS: tuple[Colour, ...] = (
    (0.72, 0.53, 0.33),
    (0.55, 0.37, 0.21),
    (0.36, 0.23, 0.14),
    (0.82, 0.68, 0.48),
    (0.48, 0.4, 0.33),
    (0.6, 0.3, 0.17),
)
PALE: tuple[Colour, ...] = (
    (0.9, 0.89, 0.85),
    (0.83, 0.86, 0.86),
    (0.88, 0.82, 0.72),
    (0.75, 0.8, 0.72),
    (0.7, 0.77, 0.84),
    (0.85, 0.75, 0.72),
)
STONES: tuple[Colour, ...] = (
    (0.78, 0.77, 0.74),
    (0.3, 0.3, 0.32),
    (0.6, 0.55, 0.5),
    (0.16, 0.17, 0.18),
    (0.9, 0.89, 0.86),
)


def _flat(colour: Colour) -> Floats:
    return np.full((SIZE, SIZE, 3), colour, dtype=np.float64)


def _cells(rows: int, columns: int, shift: float = 0.0) -> tuple[Floats, Floats, Floats, Floats]:
    """For each pixel: row and column of its tile, and its place in the tile (0..1)."""
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    row = np.floor(y * rows)
    u = x * columns + shift * row
    column = np.floor(u) % columns
    return row, column, y * rows - row, u - np.floor(u)


def _jitter(rng: Generator, row: Floats, column: Floats, spread: float) -> Floats:
    table = rng.normal(0, spread, (int(row.max()) + 1, int(column.max()) + 1))
    return np.asarray(table[row.astype(int), column.astype(int)])


def _grain(rng: Generator, base: Colour) -> Floats:
    fine = clouds(rng, SIZE, SIZE, rows=24, columns=2, octaves=3)
    broad = clouds(rng, SIZE, SIZE, rows=5, columns=1, octaves=3)
    dark: Colour = (base[0] * 0.62, base[1] * 0.57, base[2] * 0.52)
    return mix(base, dark, 0.75 * fine * 0.6 + 0.55 * broad - 0.15)


def wood(rng: Generator) -> Made:
    """Wood with the grain along x."""
    return _grain(rng, one_of(rng, WOODS)), rng.uniform(0.5, 1.1), rng.uniform(0.05, 0.3)


def planks(rng: Generator) -> Made:
    """Boards with joints."""
    rows = int(rng.integers(4, 8))
    row, column, v, u = _cells(rows, 2, 0.5 if rows % 2 == 0 else 0.0)
    picture = _grain(rng, one_of(rng, WOODS))
    picture = picture * (1 + _jitter(rng, row, column, 0.09))[..., None]
    joint = (v < 0.04) | (u < 0.008)
    return mix(picture, (0.15, 0.1, 0.07), joint * 0.7), rng.uniform(0.6, 1.0), 0.12


def plain(rng: Generator) -> Made:
    """Paint with a little unevenness."""
    colour = (
        one_of(rng, PALE)
        if rng.random() < 0.7
        else hsv(rng.random(), rng.uniform(0.1, 0.55), rng.uniform(0.4, 0.95))
    )
    uneven = clouds(rng, SIZE, SIZE, rows=6, columns=6, octaves=4)
    return _flat(colour) * (1 + (uneven[..., None] - 0.5) * 0.07), 1.0, 0.03


def tiles(rng: Generator) -> Made:
    """Square or brick-shaped tiles with joints."""
    rows, columns = ((4, 4), (6, 3), (3, 3), (8, 8))[int(rng.integers(4))]
    row, column, v, u = _cells(rows, columns, 0.5 if rows == 6 else 0.0)
    base = one_of(rng, PALE + STONES)
    picture = _flat(base) * (1 + _jitter(rng, row, column, rng.uniform(0.01, 0.07)))[..., None]
    gap = rng.uniform(0.02, 0.05)
    joint = (v < gap * rows / 4) | (u < gap * columns / 4)
    grout = near(rng, (0.7, 0.69, 0.66)) if rng.random() < 0.6 else near(rng, (0.35, 0.34, 0.33))
    return mix(picture, grout, joint * 1.0), rng.uniform(0.3, 0.8), 0.3


def checks(rng: Generator) -> Made:
    """Squares in two colours."""
    n = int(rng.choice([2, 4, 8]))
    row, column, _, _ = _cells(n, n)
    first, second = one_of(rng, PALE), one_of(rng, STONES + WOODS)
    if rng.random() < 0.3:
        second = hsv(rng.random(), rng.uniform(0.4, 0.8), rng.uniform(0.3, 0.8))
    spots = clouds(rng, SIZE, SIZE, rows=8, columns=8)[..., None]
    picture = mix(first, second, (row + column) % 2) * (0.95 + 0.1 * spots)
    return picture, n * rng.uniform(0.06, 0.22), 0.2


def stripes(rng: Generator) -> Made:
    """Upright stripes, as on wallpaper."""
    n = int(rng.integers(2, 7))
    wide = rng.uniform(0.25, 0.7)
    u = (np.arange(SIZE) / SIZE * n) % 1
    base = one_of(rng, PALE)
    other = hsv(rng.random(), rng.uniform(0.1, 0.5), rng.uniform(0.5, 0.9))
    return mix(base, other, (u < wide)[None, :] * np.ones((SIZE, 1))), rng.uniform(0.3, 0.8), 0.03


def stone(rng: Generator) -> Made:
    """Granite: a base with specks."""
    base = one_of(rng, STONES)
    cloud = clouds(rng, SIZE, SIZE, rows=6, columns=6, octaves=5)
    speck = clouds(rng, SIZE, SIZE, rows=48, columns=48, octaves=2)
    picture = _flat(base) * (0.8 + 0.4 * cloud)[..., None]
    picture = mix(picture, near(rng, (0.9, 0.88, 0.85)), np.clip(speck - 0.68, 0, 1) * 3)
    return mix(picture, (0.08, 0.08, 0.09), np.clip(0.32 - speck, 0, 1) * 3), 0.5, 0.35


def fabric(rng: Generator) -> Made:
    """Woven cloth."""
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    weave = 0.5 + 0.25 * np.sin(x * np.pi / 2) + 0.25 * np.sin(y * np.pi / 2)
    base = one_of(rng, (*PALE, (0.3, 0.35, 0.5), (0.5, 0.2, 0.2), (0.25, 0.4, 0.3)))
    uneven = clouds(rng, SIZE, SIZE, rows=12, columns=12)
    return _flat(base) * (0.82 + 0.2 * weave + 0.1 * uneven)[..., None], 0.35, 0.0


def concrete(rng: Generator) -> Made:
    """Smooth grey or beige concrete with clouds."""
    base = one_of(rng, ((0.6, 0.6, 0.59), (0.7, 0.66, 0.6), (0.45, 0.46, 0.47)))
    cloud = clouds(rng, SIZE, SIZE, rows=3, columns=3, octaves=6)
    return _flat(base) * (0.85 + 0.3 * cloud)[..., None], 1.5, 0.1


def terrazzo(rng: Generator) -> Made:
    """Held out: chips of several colours in a pale base."""
    picture = _flat(one_of(rng, PALE, 0.03))
    chips = [hsv(rng.random(), rng.uniform(0.1, 0.6), rng.uniform(0.25, 0.85)) for _ in range(4)]
    near_by = np.arange(-8, 9)
    dy, dx = np.meshgrid(near_by, near_by, indexing="ij")
    for _ in range(150):
        cy, cx = rng.integers(0, SIZE, 2)
        a, r, squeeze = rng.uniform(0, np.pi), rng.uniform(2, 8), rng.uniform(0.4, 1)
        p, q = dx * np.cos(a) + dy * np.sin(a), dy * np.cos(a) - dx * np.sin(a)
        inside = np.abs(p) + np.abs(q) / squeeze < r
        rows, columns = (cy + dy[inside]) % SIZE, (cx + dx[inside]) % SIZE
        picture[rows, columns] = chips[int(rng.integers(4))]
    return picture, rng.uniform(0.4, 0.7), 0.3


def herringbone(rng: Generator) -> Made:
    """Held out: short boards laid in zigzag."""
    unit = SIZE // 8
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    i, j = x // unit, y // unit
    # Blocks of 1 x 4: the diagonal index tells lying from standing ones.
    k = (i - j) % 8
    lying = k < 4
    across = np.where(lying, y % unit, x % unit) / unit
    start = np.where(lying, i - k, j - (7 - k))
    lane = np.where(lying, j, i)
    shade = rng.normal(0, 0.1, 97)[(start * 7 + lane * 13).astype(int) % 97]
    grain = clouds(rng, SIZE, SIZE, rows=20, columns=20, octaves=2)
    picture = _flat(one_of(rng, WOODS)) * (1 + shade * 1.2 + 0.18 * (grain - 0.5))[..., None]
    return mix(picture, (0.12, 0.08, 0.05), (across < 0.07) * 0.6), rng.uniform(0.5, 0.9), 0.15


def marble(rng: Generator) -> Made:
    """Held out: pale or dark stone with veins."""
    base, vein = (0.92, 0.91, 0.9), (0.5, 0.5, 0.53)
    if rng.random() < 0.35:
        base, vein = (0.12, 0.16, 0.15), (0.75, 0.75, 0.7)
    picture = _flat(near(rng, base, 0.02))
    for width in (0.03, 0.05, 0.09):
        field = clouds(rng, SIZE, SIZE, rows=2, columns=2, octaves=6)
        picture = mix(picture, vein, np.clip(1 - np.abs(field - 0.5) / width, 0, 1) * 0.5)
    return picture, rng.uniform(0.6, 1.2), 0.45


def dots(rng: Generator) -> Made:
    """Held out: a grid of dots in two colours."""
    n = int(rng.integers(4, 9))
    _, _, v, u = _cells(n, n, 0.5 if n % 2 == 0 else 0.0)
    spot = np.hypot(u - 0.5, v - 0.5) < rng.uniform(0.14, 0.3)
    ink = hsv(rng.random(), rng.uniform(0.2, 0.6), rng.uniform(0.4, 0.9))
    return mix(one_of(rng, PALE), ink, spot * 1.0), rng.uniform(0.3, 0.7), 0.03


def hexagons(rng: Generator) -> Made:
    """Held out: six-sided tiles."""
    n = 4
    y, x = np.mgrid[0:SIZE, 0:SIZE] / SIZE
    best = np.full((SIZE, SIZE), 9.0)
    second = np.full((SIZE, SIZE), 9.0)
    owner = np.zeros((SIZE, SIZE), int)
    for r in range(n):
        for c in range(n):
            cx, cy = ((c + 0.5 * (r % 2)) / n) % 1, (r + 0.5) / n
            dx = np.abs(x - cx)
            dy = np.abs(y - cy)
            d = np.hypot(np.minimum(dx, 1 - dx), np.minimum(dy, 1 - dy) * 0.95)
            second = np.where(d < best, best, np.minimum(second, d))
            owner = np.where(d < best, r * n + c, owner)
            best = np.minimum(best, d)
    base = one_of(rng, PALE + STONES)
    picture = _flat(base) * (1 + rng.normal(0, 0.09, n * n)[owner])[..., None]
    grout = near(rng, (0.8, 0.79, 0.76)) if sum(base) < 1.6 else near(rng, (0.4, 0.4, 0.4))
    return mix(picture, grout, (second - best < 0.018) * 1.0), rng.uniform(0.35, 0.7), 0.25


Maker = Callable[[Generator], Made]
TRAIN: dict[Use, tuple[Maker, ...]] = {
    "wall": (plain, plain, plain, tiles, stripes, concrete, stone),
    "floor": (planks, planks, tiles, checks, concrete, stone, fabric),
    "table": (wood, wood, planks, plain, stone, fabric, checks),
    "worktop": (wood, stone, stone, plain, concrete),
    "cabinet": (plain, plain, wood, planks),
}
HELD_OUT: dict[Use, tuple[Maker, ...]] = {
    "wall": (dots, hexagons, marble),
    "floor": (herringbone, terrazzo, hexagons),
    "table": (marble, herringbone, dots),
    "worktop": (marble, terrazzo),
    "cabinet": (herringbone, marble),
}


def draw_texture(use: Use, rng: Generator, *, held_out: bool) -> Texture:
    """A random texture for a use.

    Args:
        use: Where it goes.
        rng: Decides everything.
        held_out: From the held-out families instead of those for training.

    Raises:
        UnknownNameError: There is no such use.
    """
    choice = HELD_OUT if held_out else TRAIN
    if use not in choice:
        raise UnknownNameError("use of a texture", use, choice)
    make = choice[use][int(rng.integers(len(choice[use])))]
    picture, metres, shine = make(rng)
    r, g, b = (float(c) for c in np.clip(picture, 0, 1).mean(axis=(0, 1)))
    return Texture(make.__name__, held_out, png(picture), metres, shine, (r, g, b))
