"""Grasps from above at which both fingers meet surfaces that face each other.

On a map of heights made of a depth image, in the manner of Nguyen 1988, Constructing Force-Closure
Grasps: the edges that the pads meet have to face each other within a cone of friction. What the
camera did not see is taken to be free.
"""

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.grasps.grasp import DEEP, LOWEST, Grasp

CELL = 0.003
"""Side of a cell of the map, metres."""
AROUND = 0.16
"""Half the side of the map."""
HALF_OPEN, FINGER = 0.0425, 0.016
"""Half the gripper's opening, and how far a finger goes beyond it, metres."""
SPARE = 0.004
"""Left between an open finger and the thing, metres."""
PAD = (-0.010, -0.005, 0.0, 0.005, 0.010)
"""Where along a pad its edge is looked at, metres."""
CONE = 0.45
"""The greatest slope of an edge against the pad: what friction holds."""
ANGLES = 18
STARTS = 350


def heights(
    points: NDArray[np.float64], centre: tuple[float, float], table: float
) -> NDArray[np.float64]:
    """The highest point of each cell around a place, 0 and rows along x first; metres above floor.

    Args:
        points: n × 3, metres.
        centre: Of the map, x and y.
        table: What is taken where nothing was seen.
    """
    side = int(2 * AROUND / CELL)
    cells = np.floor((points[:, :2] - np.array(centre) + AROUND) / CELL)
    inside = np.isfinite(points).all(1) & (cells >= 0).all(1) & (cells < side).all(1)
    cells = cells[inside].astype(np.int64)
    found = np.full((side, side), -np.inf)
    np.maximum.at(found, (cells[:, 0], cells[:, 1]), points[inside, 2])
    around = np.stack([np.roll(found, (i, j), (0, 1)) for i in (-1, 0, 1) for j in (-1, 0, 1)])
    found = np.where(np.isfinite(found), found, around.max(0))
    return np.where(np.isfinite(found), found, table)


def antipodal(
    points: NDArray[np.float64],
    thing: NDArray[np.bool_],
    *,
    centre: tuple[float, float],
    table: float,
) -> list[Grasp]:
    """Grasps of a thing, the best first; none where none is found.

    Args:
        points: What the camera saw, n × 3, metres from the arm's foot.
        thing: Which of them are of the thing.
        centre: The thing's middle, x and y.
        table: Height of the table's top above the floor, metres.
    """
    seen = heights(points, centre, table)
    own = heights(points[thing], centre, -np.inf)
    rows, columns = np.nonzero(np.isfinite(own) & (own > table + LOWEST))
    if not len(rows):
        return []
    every = max(1, len(rows) // STARTS)
    rows, columns = rows[::every], columns[::every]
    found: list[Grasp] = []
    for angle in np.arange(ANGLES) * np.pi / ANGLES:
        found += _closing(seen, rows, columns, angle, centre, table)
    return sorted(found, key=lambda grasp: -grasp.quality)


def _closing(
    seen: NDArray[np.float64],
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    angle: float,
    centre: tuple[float, float],
    table: float,
) -> list[Grasp]:
    along = np.array([np.cos(angle), np.sin(angle)])
    across = np.array([-along[1], along[0]])
    reach = np.arange(-HALF_OPEN - FINGER, HALF_OPEN + FINGER + CELL / 2, CELL / 1.5)
    offsets = (
        reach[None, :, None] * along[None, None] + np.array(PAD)[:, None, None] * across[None, None]
    ) / CELL
    cells = np.stack([rows, columns], -1)[:, None, None] + np.rint(offsets)[None]
    cells = np.clip(cells, 0, len(seen) - 1).astype(np.int64)
    profile = seen[cells[..., 0], cells[..., 1]]  # starts × lines × reach
    top = seen[rows, columns]
    low = np.maximum(table + LOWEST, top - DEEP)
    free = profile < (low - 0.012)[:, None, None]
    inside = np.abs(reach) <= HALF_OPEN - SPARE
    open_ways = free[..., ~inside].all((1, 2))
    solid = (profile >= (low - 0.004)[:, None, None]) & inside
    first = np.where(solid.any(-1), reach[solid.argmax(-1)], np.inf)
    last = np.where(solid.any(-1), reach[len(reach) - 1 - solid[..., ::-1].argmax(-1)], -np.inf)
    whole = np.isfinite(first).all(1) & np.isfinite(last).all(1) & open_ways
    spread = np.array(PAD) / np.square(PAD).sum()  # the slope of a straight line through the edge
    grasps = []
    for i in np.nonzero(whole)[0]:
        steep = float(max(abs(edge[i] @ spread) for edge in (first, last)))
        if steep > CONE:
            continue
        middle = float((first[i] + last[i]).mean() / 2)
        place = (np.array([rows[i], columns[i]]) + 0.5) * CELL - AROUND + middle * along
        off = float(np.hypot(*place))
        width = float((last[i] - first[i]).mean())
        quality = (1 - steep / CONE / 2) * np.exp(-((off / 0.09) ** 2))
        x, y = place + np.array(centre)
        grasps.append(Grasp(float(x), float(y), float(low[i]), angle, width, float(quality)))
    return grasps
