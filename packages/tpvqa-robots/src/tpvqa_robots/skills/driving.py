"""Where the base has to stand for the arm to reach a thing on the table before it."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

AXIS = -0.21
"""Where the base turns, metres ahead of the arm's foot."""
REACH = 0.80
"""Metres from the arm's foot at which the gripper still comes down from above; tried: .86."""
AHEAD = 0.12
"""By so much, metres, the base can go up to the table, turned however it is."""
ALONG = 0.70
"""By so much, metres, it goes to each side of where it began: the table ends .15 beyond."""
SCAN = (0.0, 0.55, -0.55, 0.95, -0.95)
"""Where the base looks for what is not in sight, radians."""


@dataclass(frozen=True, slots=True)
class Stance:
    """Where the base stands, by its wheels.

    Attributes:
        ahead: Metres towards the table from where it began.
        aside: Metres to the left of that.
        yaw: How far it has turned, radians.
    """

    ahead: float
    aside: float
    yaw: float

    def turned(self, yaw: float) -> "Stance":
        """The same place, turned so."""
        return Stance(self.ahead, self.aside, yaw)


def in_reach(x: float, y: float) -> bool:
    """Whether the arm reaches a thing once the base has turned to it.

    Args:
        x: Of the thing, metres ahead of the arm's foot.
        y: Metres to its left.
    """
    return float(np.hypot(x - AXIS, y)) + AXIS <= REACH


def stance_before(x: float, y: float, here: Stance) -> Stance:
    """Where to stand for a thing to be straight ahead, and as near as the table lets the base come.

    Args:
        x: Of the thing, metres ahead of the arm's foot.
        y: Metres to its left.
        here: Where the base stands now.
    """
    c, s = np.cos(here.yaw), np.sin(here.yaw)
    there_x = here.ahead + c * (x - AXIS) - s * y
    there_y = here.aside + s * (x - AXIS) + c * y
    aside = float(np.clip(there_y, -ALONG, ALONG))
    near = REACH - AXIS - 0.02  # seen again from there, it may be a little elsewhere
    ahead = float(np.clip(there_x - near, 0.0, AHEAD))
    return Stance(ahead, aside, float(np.arctan2(there_y - aside, there_x - ahead)))


def looking(here: Stance, *, drives: bool) -> Iterator[Stance]:
    """Where to look for what is not in sight: from here, turned; then from the table's two ends."""
    yield here
    for yaw in SCAN:
        yield here.turned(yaw)
    if drives:
        for aside in (ALONG, -ALONG):
            for yaw in SCAN[:3]:
                yield Stance(0.0, aside, yaw)
