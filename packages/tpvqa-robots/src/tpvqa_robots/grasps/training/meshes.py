"""Things made by others: robosuite's objects, and the scans that come with the household.

A hollow or branching mesh is taken apart by a grid of cells; the hull of what is in each is what is
seen and touched. So nothing is seen that cannot be touched, and the other way round.
"""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from zipfile import ZipFile

import numpy as np

from tpvqa_robots.grasps.training.solids import Solid, Thing
from tpvqa_robots.toys.mujoco import robosuite_models
from tpvqa_robots.toys.scans import pieces, spread, surface_of
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


def scan(pack: Path, name: str, *, scale: float = 1.0) -> Thing:
    """A thing of the household's zip of scans.

    Args:
        pack: The zip.
        name: Of the thing.
        scale: How much larger it is than it would be.
    """
    with ZipFile(pack) as archive:
        entry = next(e for e in json.loads(archive.read("index.json")) if e["name"] == name)
        parts = [surface_of(archive.read(part["mesh"])) for part in entry["parts"]]
    _, middle, large = np.sort(entry["extent"])
    factor = scale * min(1.0, NARROW / float(middle), LONG / float(large))
    points = spread([replace(part, points=part.points * factor) for part in parts])
    points -= (points.min(0) + points.max(0)) / 2
    count = {**SCANS, **SCANS_HELD_OUT}[name]
    return Thing(name, tuple(Solid("hull", points=piece) for piece in pieces(points, count)))


def of_robosuite(name: str, *, scale: float = 1.0) -> Thing:
    """One of robosuite's objects, as the hull that it collides with there.

    Raises:
        MissingExtraError: Robosuite is not installed.
    """
    model = part_of_robosuite(robosuite_models() / "objects" / f"{name}.xml").compile()
    points = np.array(model.mesh_vert, np.float64) * scale
    points -= (points.min(0) + points.max(0)) / 2
    return Thing(f"{name}-robosuite", (Solid("hull", points=points),))
