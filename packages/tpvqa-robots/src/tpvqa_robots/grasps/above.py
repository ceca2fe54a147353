"""What a tilted camera saw, as a depth image taken from straight above a thing.

The form that GG-CNN takes: square, 300 pixels a side, holes filled, its mean taken away.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

SIDE = 300
"""Pixels along a side of the image."""
PIXEL = 0.0015
"""What a pixel spans, metres: the image shows 45 × 45 cm."""
COARSE = 2
"""Pixels along a side of the cells into which points are sorted: the camera's are 2 mm apart."""
FILLS = 24
"""How often holes are filled by a cell from their edges; what is left is taken for table."""
HIGHEST, BELOW = 0.2, -0.005
"""Metres above the table from which on something is the robot's own arm, and is left out; what lies
lower than the second, as the floor beside the table, is taken to be there."""
RANGE = 0.1
"""Metres that are 1 in the image. Morrison et al. have metres; things here are centimetres high."""


def from_above(
    points: NDArray[np.float64], centre: tuple[float, float], table: float
) -> NDArray[np.float64]:
    """Heights on a square map around a place, holes filled.

    Args:
        points: n × 3, metres; rows that are not finite are left out.
        centre: The map's middle, x and y.
        table: Height of the table's top, metres.

    Returns:
        `SIDE` × `SIDE`, metres above the table; rows along x, columns along y, the lowest first.
    """
    cells, half = SIDE // COARSE, SIDE * PIXEL / 2
    span = PIXEL * COARSE
    at = np.floor((points[:, :2] - np.array(centre) + half) / span)
    inside = np.isfinite(points).all(1) & (at >= 0).all(1) & (at < cells).all(1)
    inside &= points[:, 2] < table + HIGHEST
    at = at[inside].astype(np.int64)
    found = np.full(cells * cells, -np.inf)
    high = np.maximum(points[inside, 2] - table, BELOW)
    np.maximum.at(found, at[:, 0] * cells + at[:, 1], high)
    return _finer(_filled(found.reshape(cells, cells)))


def mask_from_above(
    points: NDArray[np.float64], centre: tuple[float, float], *, wider: int = 2
) -> NDArray[np.bool_]:
    """Which pixels of the same map some points fall into, and those around them.

    Args:
        points: n × 3, metres.
        centre: The map's middle, x and y.
        wider: Cells of `COARSE` pixels by which the mask is grown.
    """
    cells, half = SIDE // COARSE, SIDE * PIXEL / 2
    at = np.floor((points[:, :2] - np.array(centre) + half) / (PIXEL * COARSE))
    inside = np.isfinite(points).all(1) & (at >= 0).all(1) & (at < cells).all(1)
    at = at[inside].astype(np.int64)
    found: NDArray[np.bool_] = np.zeros((cells, cells), bool)
    found[at[:, 0], at[:, 1]] = True
    for _ in range(wider):
        found = np.array(_around(found).any(0))
    mask: NDArray[np.bool_] = found.repeat(COARSE, 0).repeat(COARSE, 1)
    return mask


def depth_image(heights: NDArray[np.float64]) -> NDArray[np.float32]:
    """The network's input: depth less its mean, clipped to -1 to 1 in units of `RANGE`.

    Args:
        heights: Of `from_above`.

    Returns:
        1 × 1 × `SIDE` × `SIDE`.
    """
    depth = -heights
    image: NDArray[np.float32] = np.clip((depth - depth.mean()) / RANGE, -1, 1).astype(np.float32)
    return image[None, None]


def top_of(heights: NDArray[np.float64], row: int, column: int) -> float:
    """How high what stands around a pixel is: the 90th percentile within a square of 17 mm."""
    around = heights[max(0, row - 5) : row + 6, max(0, column - 5) : column + 6]
    return float(np.percentile(around, 90))


def _around(map_: NDArray[Any]) -> NDArray[Any]:
    wide = np.pad(map_, 1, mode="edge")
    n, m = map_.shape
    return np.stack([wide[i : i + n, j : j + m] for i in range(3) for j in range(3)])


def _filled(found: NDArray[np.float64]) -> NDArray[np.float64]:
    """Holes filled from their edges inwards, each cell with the mean of those known around it."""
    wide = np.pad(np.where(np.isfinite(found), found, np.nan), 1, constant_values=np.nan)
    inner = wide[1:-1, 1:-1]
    for _ in range(FILLS):
        rows, columns = np.nonzero(np.isnan(inner))
        if not len(rows):
            break
        around = np.stack([wide[rows + i, columns + j] for i in range(3) for j in range(3)])
        known = ~np.isnan(around)
        count = known.sum(0)
        mean = np.where(known, around, 0.0).sum(0) / np.maximum(count, 1)
        inner[rows, columns] = np.where(count > 0, mean, np.nan)
    filled: NDArray[np.float64] = np.nan_to_num(inner)
    return filled


def _finer(coarse: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twice as many cells a side, with values between those of the old ones."""
    wide = np.pad(coarse, 1, mode="edge")

    def along(values: NDArray[np.float64]) -> NDArray[np.float64]:
        middle = values[1:-1]
        parts = [0.75 * middle + 0.25 * values[:-2], 0.75 * middle + 0.25 * values[2:]]
        return np.stack(parts, 1).reshape(2 * len(middle), *values.shape[1:])

    return along(along(wide).T).T
