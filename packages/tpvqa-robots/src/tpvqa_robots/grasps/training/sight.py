"""From the bench's depth image to points, with the errors of the robot's camera if wished."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tpvqa_robots.grasps.training.bench import EYE, FOVY, LEAN
from tpvqa_robots.toys.cameras import HEIGHT, NO_ERRORS, WIDTH, Errors
from tpvqa_robots.toys.room import TABLE

WINDOW = 230
"""Pixels along a side of what is kept of a depth image, around the table's middle."""
ROW, COLUMN = (HEIGHT - WINDOW) // 2, (WIDTH - WINDOW) // 2


def window(depth: NDArray[np.float32]) -> NDArray[np.float32]:
    """The part of a depth image that is kept."""
    return depth[ROW : ROW + WINDOW, COLUMN : COLUMN + WINDOW]


def points_of(
    depth: NDArray[np.floating], rng: Generator | None = None, errors: Errors = NO_ERRORS
) -> NDArray[np.float64]:
    """Where each pixel of a window is.

    Args:
        depth: Of `window`, metres.
        rng: Of the errors; none where there is none.
        errors: As `toys.cameras` has them.

    Returns:
        n × 3, metres from the table's middle, z above the floor.
    """
    seen = depth.astype(np.float64)
    f = HEIGHT / 2 / np.tan(np.radians(FOVY) / 2)
    rows, columns = np.indices(seen.shape)
    u = (columns + COLUMN - (WIDTH - 1) / 2) / f
    v = -(rows + ROW - (HEIGHT - 1) / 2) / f
    turned = np.array(EYE) + np.array([0, 0, TABLE])
    across, up = np.array([0.0, -1, 0]), np.array([np.sqrt(1 - LEAN**2), 0, LEAN])
    axes = np.stack([across, up, np.cross(across, up)], -1)
    if rng is not None:
        seen = seen + rng.normal(0, 1, seen.shape) * errors.depth * seen**2
        seen = np.where(rng.random(seen.shape) < errors.missing, np.nan, seen)
        turned = turned + rng.normal(0, errors.shift, 3)
        a, b, c = rng.normal(0, errors.turn, 3)
        axes = (np.eye(3) + np.array([[0, -c, b], [c, 0, -a], [-b, a, 0]])) @ axes
    rays = np.stack([u, v, -np.ones_like(u)], -1)
    points: NDArray[np.float64] = (rays * seen[..., None]).reshape(-1, 3) @ axes.T + turned
    return points
