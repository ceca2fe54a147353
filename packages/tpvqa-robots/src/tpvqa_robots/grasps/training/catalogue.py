"""Which things there are, which of them taught the network, and which it never saw."""

from pathlib import Path

from numpy.random import Generator

from tpvqa_robots.grasps.training import shapes
from tpvqa_robots.grasps.training.meshes import (
    OF_ROBOSUITE,
    OF_ROBOSUITE_HELD_OUT,
    SCANS,
    SCANS_HELD_OUT,
    of_robosuite,
    scan,
)
from tpvqa_robots.grasps.training.solids import Thing

PACK = Path("packages/tpvqa-household/src/tpvqa_household/kitchen/assets/scanned.zip")
"""The scans, from the folder of a clone: they are part of another package."""
TAUGHT = (*shapes.TAUGHT, *SCANS, *OF_ROBOSUITE)
HELD_OUT = (*shapes.HELD_OUT, *SCANS_HELD_OUT, *OF_ROBOSUITE_HELD_OUT)


def named(name: str, rng: Generator, *, vary: bool = False, pack: Path = PACK) -> Thing:
    """A thing of the catalogue.

    Args:
        name: One of `TAUGHT` or `HELD_OUT`.
        rng: Draws the sizes of what is made up.
        vary: Draw the sizes of the others, too, as training does.
        pack: Where the scans are.
    """
    if name in shapes.TAUGHT or name in shapes.HELD_OUT:
        return shapes.shape(name, rng)
    scale = float(rng.uniform(0.8, 1.1)) if vary else 1.0
    if name in OF_ROBOSUITE or name in OF_ROBOSUITE_HELD_OUT:
        return of_robosuite(name, scale=scale)
    return scan(pack, name, scale=scale)
