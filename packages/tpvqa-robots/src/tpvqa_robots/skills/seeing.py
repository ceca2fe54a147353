"""What the robot makes of a picture with depth: where a thing is, by its colour."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.toys.cameras import Shot

HUES: Mapping[str, tuple[float, float]] = {
    "blue_container": (212, 255),
    "cyan_container": (165, 200),
    "toy_eggplant": (265, 320),
    "goal_area": (345, 375),
}
"""Degrees around the colour wheel; 360 and above is red again."""
GREY, DARK = 0.5, 0.12
"""Least saturation and brightness of a pixel that has a colour."""
ENOUGH = 250
"""Pixels that a thing must have to be taken for seen."""
LARGE = 0.16
"""Metres from the middle of a thing beyond which a pixel of its colour is something else."""
LOW = 0.10
"""Metres below the table's top at which things are no longer taken for on it."""


@dataclass(frozen=True, slots=True)
class Seen:
    """A thing in a picture.

    Attributes:
        x: Of its middle, metres ahead of the arm's foot.
        y: Metres to its left.
        top: Its highest point above the floor, metres.
        pixels: How many show it.
        cut: Whether it goes over the picture's edge.
        mask: Which pixels: height × width.
    """

    x: float
    y: float
    top: float
    pixels: int
    cut: bool
    mask: NDArray[np.bool_]


def hue_mask(rgb: NDArray[np.uint8], low: float, high: float) -> NDArray[np.bool_]:
    """Which pixels have a colour between two hues, degrees."""
    red, green, blue = (rgb[..., i] for i in range(3))
    brightest = np.maximum(np.maximum(red, green), blue) / 255
    darkest = np.minimum(np.minimum(red, green), blue) / 255
    grey = (brightest - darkest) / np.maximum(brightest, 1e-6) < GREY
    found: NDArray[np.bool_] = ~grey & (brightest >= DARK)
    values = rgb[found] / 255  # few have a colour at all
    most, least = values.max(-1), values.min(-1)
    spread = np.maximum(most - least, 1e-6)
    r, g, b = values.T
    hue = np.where(
        most == r,
        ((g - b) / spread) % 6,
        np.where(most == g, (b - r) / spread + 2, (r - g) / spread + 4),
    )
    degrees = 60 * hue
    found[found] = (degrees >= low) & (degrees <= high) | (degrees + 360 <= high)
    return found


def see(shot: Shot, thing: str, *, table: float) -> Seen | None:
    """Where a thing is; None where it is not seen, or is not on the table or above it.

    Args:
        shot: The picture.
        thing: One of `HUES`.
        table: Height of the table's top, metres.
    """
    return seen_as(shot, hue_mask(shot.rgb, *HUES[thing]), table=table)


def seen_as(shot: Shot, mask: NDArray[np.bool_], *, table: float) -> Seen | None:
    """A thing that some pixels show; None where they are too few, or not on the table or above it.

    Args:
        shot: The picture.
        mask: The pixels, height × width.
        table: Height of the table's top, metres.
    """
    mask = mask & (shot.points[..., 2] > table - LOW)
    if mask.sum() < ENOUGH:
        return None
    points = shot.points[mask]
    middle = np.median(points, axis=0)
    near = np.linalg.norm(points[:, :2] - middle[:2], axis=1) < LARGE
    if near.sum() < ENOUGH:
        return None
    rows, columns = np.nonzero(mask)
    mask[rows[~near], columns[~near]] = False
    low, high = np.percentile(points[near][:, :2], [2, 98], axis=0)
    edge = np.concatenate([mask[0], mask[-1], mask[:, 0], mask[:, -1]])
    return Seen(
        x=float((low[0] + high[0]) / 2),
        y=float((low[1] + high[1]) / 2),
        top=float(np.percentile(points[near][:, 2], 95)),
        pixels=int(near.sum()),
        cut=bool(edge.any()),
        mask=mask,
    )
