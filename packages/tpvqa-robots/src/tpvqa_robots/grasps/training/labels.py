"""Maps that the network is to give, painted from grasps that were tried.

As published: where a grasp held, the middle third of its rectangle has its quality, angle and
width; all else is 0. Where several hold in one place the narrower is painted, and of equally narrow
ones that which closes more nearly along the image's rows: else the angles of a cube would average.
What closes aslant may hold, too, as things turn between the fingers: so angles are means of what
held near by, and what was tried at any angle is painted only where nothing antipodal held.
"""

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.grasps.above import PIXEL, SIDE
from tpvqa_robots.grasps.ggcnn import OPENING

NEAR, ALIKE = 0.008, 0.35
"""Metres and radians within which another grasp tells of this one, too."""
ACROSS = 14
"""So many of a scene's grasps, the first ones, are antipodal, where there are as many."""
AROUND, ASLANT = 0.015, 0.6
"""Metres and radians within which antipodal grasps give a common angle, and others none."""
HALF_PAD = 0.009
"""Half a pad's length, metres."""
LEAST = 0.003
"""Half of what is painted along the closing direction, metres at least."""
EQUAL = 0.006
"""Metres by which widths are told apart."""


def qualities(grasps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of each grasp the share that held of those tried near it, itself included; 0 if it failed.

    Args:
        grasps: n × (x, y, angle, width, held), metres and radians.
    """
    apart = np.linalg.norm(grasps[:, None, :2] - grasps[None, :, :2], axis=-1)
    turned = np.abs(np.sin(grasps[:, None, 2] - grasps[None, :, 2]))
    near = (apart < NEAR) & (turned < np.sin(ALIKE))
    held = grasps[:, 4]
    share: NDArray[np.float64] = (near * held).sum(1) / near.sum(1)
    return share * held


def angles(grasps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Of each grasp the mean angle of the antipodal ones near it that held; NaN where it is not to
    be painted.

    Args:
        grasps: n × (x, y, angle, width, held), metres and radians; the first `ACROSS` antipodal.
    """
    held = grasps[:, 4] > 0
    across = held & (np.arange(len(grasps)) < ACROSS)
    near = np.linalg.norm(grasps[:, None, :2] - grasps[None, :, :2], axis=-1) < AROUND
    turned = np.abs(np.sin(grasps[:, None, 2] - grasps[None, :, 2])) < np.sin(ASLANT)
    twice = np.exp(2j * grasps[:, 2])
    mean = np.angle((near & turned & across[None, :]) @ twice) / 2
    alone = ~(near & across[None, :]).any(1)
    kept = np.where(across, mean, np.where(alone, grasps[:, 2], np.nan))
    found: NDArray[np.float64] = np.where(held, kept, np.nan)
    return found


def painted(
    grasps: NDArray[np.float64], corner: tuple[int, int] = (0, 0), side: int = SIDE
) -> NDArray[np.float32]:
    """The four maps: quality, cosine and sine of twice the angle, width as a share.

    Args:
        grasps: n × (x, y, angle, width, held), metres from the image's middle.
        corner: The first row and column of the part that is painted.
        side: Of that part, pixels.

    Returns:
        4 × side × side.
    """
    maps = np.zeros((4, side, side), np.float32)
    share = qualities(grasps)
    row, column = (PIXEL * (start + np.arange(side) + 0.5 - SIDE / 2) for start in corner)
    turned = angles(grasps)
    along_rows = np.abs(np.sin(turned))
    order = np.lexsort((-along_rows, -np.floor(grasps[:, 3] / EQUAL)))
    for i in order:  # the last one stays
        if np.isnan(turned[i]):
            continue
        (x, y), angle, width = grasps[i, :2], turned[i], grasps[i, 3]
        c, s = np.cos(angle), np.sin(angle)
        dx, dy = (row - x)[:, None], (column - y)[None, :]
        inside = (np.abs(c * dx + s * dy) <= max(LEAST, width / 6)) & (
            np.abs(c * dy - s * dx) <= HALF_PAD
        )
        values = share[i], np.cos(2 * angle), np.sin(2 * angle), width / OPENING
        for map_, value in zip(maps, values, strict=True):
            map_[inside] = value
    return maps
