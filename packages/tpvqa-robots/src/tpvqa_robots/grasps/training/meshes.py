"""Things made by others: robosuite's objects, and the scans that come with the household.

A hollow or branching mesh is taken apart by a grid of cells; the hull of what is in each is what is
seen and touched. So nothing is seen that cannot be touched, and the other way round.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.grasps.training.solids import Solid, Thing
from tpvqa_robots.toys.mujoco import robosuite_models
from tpvqa_robots.toys.scene import part_of_robosuite

SCANS: Mapping[str, int] = {
    "apple-scopia": 1,
    "ball-soccer": 1,
    "bottle-beer": 4,
    "bottle-yogurt": 4,
    "butter-bmf": 1,
    "creamer-scopia": 4,
    "cupcake-dvachib": 2,
    "hotdog-erickfree": 4,
    "kettle-country": 4,
    "milk-tetrapak": 3,
    "mug-kator": 5,
    "orange-scopia": 1,
    "teddy-manitislate": 4,
    "toaster-scopia": 3,
    "toy-wood": 4,
}
"""Those that training saw, and into how many cells each side of one is parted."""
SCANS_HELD_OUT: Mapping[str, int] = {
    "biplane-toy": 4,
    "bread-yd": 1,
    "hamburger-saizyca": 1,
    "mug-paper": 4,
    "pear-scopia": 3,
    "rubik-farcgs": 1,
    "teapot-scopia": 4,
    "train-toy": 4,
}
"""Those that it never saw."""
OF_ROBOSUITE, OF_ROBOSUITE_HELD_OUT = ("milk", "can", "cereal"), ("bread", "lemon", "bottle")
NARROW, LONG = 0.062, 0.15
"""The middle and the largest of a scan's three sizes, metres at most: larger things are shrunk."""
OVERLAP, THIN, FEW = 0.001, 0.0008, 12
"""How far cells overlap, half of what a flat one is made thick, metres; points it must have."""


@dataclass(frozen=True)
class Surface:
    """Triangles.

    Attributes:
        points: n × 3, metres.
        faces: m × 3, of points.
    """

    points: NDArray[np.float64]
    faces: NDArray[np.int64]


def scan(pack: Path, name: str, *, scale: float = 1.0) -> Thing:
    """A thing of the household's zip of scans.

    Args:
        pack: The zip.
        name: Of the thing.
        scale: How much larger it is than it would be.
    """
    with ZipFile(pack) as archive:
        entry = next(e for e in json.loads(archive.read("index.json")) if e["name"] == name)
        parts = [_surface(archive.read(part["mesh"])) for part in entry["parts"]]
    _, middle, large = np.sort(entry["extent"])
    factor = scale * min(1.0, NARROW / float(middle), LONG / float(large))
    points = _spread([Surface(part.points * factor, part.faces) for part in parts])
    points -= (points.min(0) + points.max(0)) / 2
    count = {**SCANS, **SCANS_HELD_OUT}[name]
    return Thing(name, tuple(_pieces(points, count)))


def of_robosuite(name: str, *, scale: float = 1.0) -> Thing:
    """One of robosuite's objects, as the hull that it collides with there.

    Raises:
        MissingExtraError: Robosuite is not installed.
    """
    model = part_of_robosuite(robosuite_models() / "objects" / f"{name}.xml").compile()
    points = np.array(model.mesh_vert, np.float64) * scale
    points -= (points.min(0) + points.max(0)) / 2
    return Thing(f"{name}-robosuite", (Solid("hull", points=points),))


def _surface(data: bytes) -> Surface:
    """Of the household's format: counts, ranges, then 16 bits a number."""
    points, faces = (int(count) for count in np.frombuffer(data, "<u4", 2))
    ranges = np.frombuffer(data, "<f4", 10, 8).astype(np.float64)
    values = np.frombuffer(data, "<u2", points * 3, 48).reshape(-1, 3)
    at = 48 + points * 10  # places in pictures are left out
    indices = np.frombuffer(data, "<u2", faces * 3, at).reshape(-1, 3).astype(np.int64)
    return Surface(ranges[0:3] + ranges[3:6] * values / 65535, indices)


def _spread(parts: list[Surface], count: int = 12000) -> NDArray[np.float64]:
    """Points spread over surfaces, and all their corners."""
    rng, found = np.random.default_rng(0), [part.points for part in parts]
    corners = np.concatenate([part.points[part.faces] for part in parts])
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    drawn = rng.choice(len(area), count, p=area / area.sum())
    u, v = rng.random((2, count, 1))
    over = u + v > 1
    u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
    found.append(a[drawn] + u * (b - a)[drawn] + v * (c - a)[drawn])
    return np.concatenate(found)


def _pieces(points: NDArray[np.float64], count: int) -> list[Solid]:
    low, side = points.min(0), np.ptp(points, axis=0) / count
    found = []
    for cell in np.ndindex(count, count, count):
        start = low + np.array(cell) * side - OVERLAP
        inside = ((points >= start) & (points <= start + side + 2 * OVERLAP)).all(1)
        if inside.sum() < FEW:
            continue
        own = points[inside]
        _, spans, ways = np.linalg.svd(own - own.mean(0), full_matrices=False)
        if spans[1] / np.sqrt(len(own)) < 0.0002:
            continue  # a line
        if spans[2] / np.sqrt(len(own)) < THIN:
            own = np.concatenate([own + THIN * ways[2], own - THIN * ways[2]])
        found.append(Solid("hull", points=_few(own)))
    return found


def _few(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Those that are farthest in some of 200 directions: enough for the hull."""
    ways = np.random.default_rng(1).normal(size=(200, 3))
    return points[np.unique((points @ ways.T).argmax(0))]
