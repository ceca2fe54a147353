"""Which grasps are tried: half of them antipodal on the true heights, half anywhere on a thing."""

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tpvqa_robots.grasps.above import PIXEL, SIDE, from_above, top_of
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.grasp import DEEP, LOWEST, Grasp

OF_A_THING = 0.008
"""Metres above the table from which on something is taken for part of a thing."""
REACH = 0.14
"""Metres from the middle of the table beyond which nothing is tried."""


def closing_height(heights: NDArray[np.float64], row: int, column: int, table: float) -> float:
    """How high above the floor the fingers close at a pixel, metres."""
    return table + max(LOWEST, top_of(heights, row, column) - DEEP)


def pixel_of(x: float, y: float, centre: tuple[float, float]) -> tuple[int, int]:
    """The pixel of `above.from_above` that shows a place."""
    row, column = ((v - c) / PIXEL + SIDE / 2 for v, c in zip((x, y), centre, strict=True))
    return int(np.clip(row, 0, SIDE - 1)), int(np.clip(column, 0, SIDE - 1))


def candidates(
    points: NDArray[np.float64], table: float, rng: Generator, count: int
) -> list[Grasp]:
    """Grasps to try around the origin.

    Args:
        points: n × 3, what a camera without errors sees, metres.
        table: Height of the table's top, metres.
        rng: Which.
        count: How many at most.
    """
    middle = (0.0, 0.0)
    heights = from_above(points, middle, table)
    near = np.hypot(points[:, 0], points[:, 1]) < REACH
    thing = (points[:, 2] > table + OF_A_THING) & near
    if thing.sum() < 30:
        return []
    across = antipodal(points, thing, centre=middle, table=table)
    chosen = [across[i] for i in rng.permutation(len(across))[: count // 2]]
    places = points[thing]
    found: list[Grasp] = []
    for grasp in chosen:
        row, column = pixel_of(grasp.x, grasp.y, middle)
        z = closing_height(heights, row, column, table)
        found.append(Grasp(grasp.x, grasp.y, z, grasp.angle, grasp.width, 0.0))
    for _ in range(count - len(found)):
        x, y, _ = places[rng.integers(len(places))]
        z = closing_height(heights, *pixel_of(x, y, middle), table)
        found.append(Grasp(float(x), float(y), z, float(rng.uniform(0, np.pi)), 0.0, 0.0))
    return found
