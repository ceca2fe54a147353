"""Colours, noise and PNG bytes for textures."""

import colorsys
from io import BytesIO
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.random import Generator
from PIL import Image

from tpvqa_household.kitchen.assets.mesh import Floats

Colour = tuple[float, float, float]


def png(picture: Floats) -> bytes:
    """A (height, width, 3) picture in 0..1 as PNG."""
    data = (np.clip(picture, 0, 1) * 255 + 0.5).astype(np.uint8)
    out = BytesIO()
    Image.fromarray(data).save(out, "png", compress_level=1)
    return out.getvalue()


def hsv(hue: float, saturation: float, value: float) -> Colour:
    """A colour by hue (0..1, wraps), saturation and value."""
    return colorsys.hsv_to_rgb(hue % 1.0, min(max(saturation, 0), 1), min(max(value, 0), 1))


def near(rng: Generator, colour: Colour, spread: float = 0.06) -> Colour:
    """A colour near another: other brightness, slightly other hue."""
    light = 1 + rng.normal(0, spread)
    r, g, b = (float(np.clip(c * light + rng.normal(0, spread / 2.5), 0, 1)) for c in colour)
    return r, g, b


def one_of(rng: Generator, colours: tuple[Colour, ...], spread: float = 0.06) -> Colour:
    """One of the colours, varied."""
    return near(rng, colours[int(rng.integers(len(colours)))], spread)


def noise(rng: Generator, height: int, width: int, *, rows: int, columns: int) -> Floats:
    """Smooth noise in 0..1 that repeats at its edges: `rows` by `columns` random knots."""
    knots = rng.random((rows, columns))
    y = np.arange(height) * rows / height
    x = np.arange(width) * columns / width
    return _cubic(_cubic(knots, y, 0), x, 1)


def _cubic(knots: Floats, at: Floats, axis: int) -> Floats:
    n = knots.shape[axis]
    base = np.floor(at).astype(int)
    t = at - base
    t = t * t * (3 - 2 * t)
    low = np.take(knots, base % n, axis=axis)
    high = np.take(knots, (base + 1) % n, axis=axis)
    t = t[:, None] if axis == 0 else t[None, :]
    return np.asarray(low * (1 - t) + high * t)


def clouds(
    rng: Generator, height: int, width: int, *, rows: int = 4, columns: int = 4, octaves: int = 4
) -> Floats:
    """Noise of several sizes, stretched to 0..1; repeats at its edges."""
    total = np.zeros((height, width))
    for octave in range(octaves):
        grown = 2**octave
        if rows * grown > height or columns * grown > width:
            break
        total += noise(rng, height, width, rows=rows * grown, columns=columns * grown) / grown
    total -= total.min()
    return np.asarray(total / max(total.max(), 1e-9))


def mix(
    low: Colour | Floats, high: Colour | Floats, amount: npt.NDArray[np.floating[Any]]
) -> Floats:
    """From `low` (amount 0) to `high` (amount 1), for each pixel."""
    a = np.clip(amount, 0, 1)[..., None]
    return np.asarray(np.asarray(low) * (1 - a) + np.asarray(high) * a)
