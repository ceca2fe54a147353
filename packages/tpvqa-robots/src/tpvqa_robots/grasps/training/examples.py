"""Scenes as the network learns them: seen with errors, turned, mirrored, cut out."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tpvqa_robots.grasps.above import SIDE, depth_image, from_above
from tpvqa_robots.grasps.training.labels import painted
from tpvqa_robots.grasps.training.sight import points_of
from tpvqa_robots.toys.cameras import Errors
from tpvqa_robots.toys.room import TABLE

CUT = 108
"""Pixels along a side of what is shown at once: the network is fully convolutional."""
ASIDE = 0.02
"""Metres by which the image's middle is beside that of the tried grasps at most."""
NOISE = (0.5, 1.5)
"""The cameras' errors are multiplied by something between these."""


Scene = tuple[NDArray[np.float32], NDArray[np.float64]]


def scenes_of(folder: Path) -> list[Scene]:
    """All scenes that `render` wrote: depth images, and the grasps that were tried."""
    found = []
    for file in sorted(folder.glob("*.npz")):
        with np.load(file) as parts:
            for depth, grasps in zip(parts["depth"], parts["grasps"], strict=True):
                rows = grasps[np.isfinite(grasps).all(1)].astype(np.float64)
                found.append((depth, rows))
    return found


def moved(
    rows: NDArray[np.float64], yaw: float, mirrored: bool, aside: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Grasps as they are in an image that was turned, then mirrored, then moved."""
    c, s = np.cos(yaw), np.sin(yaw)
    found = rows.copy()
    found[:, :2] = rows[:, :2] @ np.array([[c, s], [-s, c]])
    found[:, 2] = rows[:, 2] + yaw
    if mirrored:
        found[:, 1] *= -1
        found[:, 2] *= -1
    found[:, :2] -= aside
    return found


def example(
    depth: NDArray[np.floating[Any]], rows: NDArray[np.float64], rng: Generator
) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """An image and the maps that are wanted: 1 and 4 × `CUT` × `CUT`."""
    points = points_of(depth, rng, Errors().times(rng.uniform(*NOISE)))
    yaw, mirrored = rng.uniform(-np.pi, np.pi), bool(rng.random() < 0.5)
    c, s = np.cos(yaw), np.sin(yaw)
    middle = moved(rows, yaw, mirrored, np.zeros(2))[:, :2]
    aside = np.median(middle, axis=0) + rng.uniform(-ASIDE, ASIDE, 2)
    turned = points.copy()
    turned[:, :2] = points[:, :2] @ np.array([[c, s], [-s, c]])
    if mirrored:
        turned[:, 1] *= -1
    heights = from_above(turned, (float(aside[0]), float(aside[1])), TABLE)
    i, j = (int(start) for start in (SIDE - CUT) // 2 + rng.integers(-12, 13, 2))
    image = depth_image(heights)[0, :, i : i + CUT, j : j + CUT]
    return image, painted(moved(rows, yaw, mirrored, aside), (i, j), CUT)
