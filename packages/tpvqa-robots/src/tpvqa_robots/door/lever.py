"""Where a door's handle is, seen or remembered, and how the gripper moves it."""

from collections.abc import Iterator
from dataclasses import astuple, dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.skills.kinematics import Grip

LENGTH, THICK, HIGH = 0.15, 0.03, 0.04
"""Of the handle's bar, metres: along it, towards the door, and upwards. The robot knows them."""
TO_HINGE, TO_PANEL = 0.43, 0.10
"""From the spindle to the hinge along the door, and from the bar's middle to the door's, metres."""
ARM = 0.134
"""From the spindle to where the bar is gripped, metres."""
ARC = 0.02
"""Between two points of an arc, metres at most."""
SEEN = 150
"""Pixels that the bar must have."""


@dataclass(frozen=True, slots=True)
class Lever:
    """A handle, seen from the arm's foot.

    Attributes:
        x: Of its spindle in the bar's plane, metres ahead.
        y: The same to the left.
        z: The same above the floor.
        yaw: Of the direction from the spindle along the bar when it is level, radians from x.
    """

    x: float
    y: float
    z: float
    yaw: float

    @property
    def along(self) -> NDArray[np.float64]:
        """The direction from the spindle along the bar, which is that to the hinge."""
        return np.array([np.cos(self.yaw), np.sin(self.yaw)])

    @property
    def inwards(self) -> NDArray[np.float64]:
        """The direction from the bar to the door."""
        return np.array([-np.sin(self.yaw), np.cos(self.yaw)])

    @property
    def hinge(self) -> NDArray[np.float64]:
        """Where the door turns."""
        way: NDArray[np.float64] = TO_HINGE * self.along + TO_PANEL * self.inwards
        return np.array([self.x, self.y]) + way

    def grip(self, turned: float = 0.0, pulled: float = 0.0) -> Grip:
        """Where the bar is gripped, the fingers closing across it.

        Args:
            turned: How far the handle is turned up, radians.
            pulled: How far the door is turned towards the robot, radians.
        """
        shut = np.array([self.x, self.y]) + ARM * np.cos(turned) * self.along
        x, y = self.hinge + _rotated(shut - self.hinge, pulled)
        z = self.z + ARM * np.sin(turned)
        return Grip(float(x), float(y), float(z), self.yaw + np.pi / 2 + pulled)

    def angles(self, grip: Grip, pulled: float) -> tuple[float, float]:
        """How far handle and door are turned where the gripper is there, radians.

        Args:
            grip: Where it is.
            pulled: How far the door was pulled by whoever tells the first angle; about.
        """
        now = np.array([grip.x, grip.y]) - self.hinge
        back = self.hinge + _rotated(now, -pulled) - np.array([self.x, self.y])
        turned = float(np.arctan2(grip.z - self.z, back @ self.along))
        at = self.grip(turned)
        shut = np.array([at.x, at.y]) - self.hinge
        cross = shut[0] * now[1] - shut[1] * now[0]
        return turned, float(np.arctan2(cross, shut @ now))

    def numbers(self) -> list[float]:
        """As JSON."""
        return list(astuple(self))


def way(lever: Lever, start: tuple[float, float], end: tuple[float, float]) -> Iterator[Grip]:
    """How the gripper moves the handle and the door from two angles to two others, radians."""
    far = ARM * abs(end[0] - start[0]) + TO_HINGE * abs(end[1] - start[1])
    count = int(np.ceil(far / ARC)) or 1
    for part in np.linspace(start, end, count + 1)[1:]:
        yield lever.grip(*(float(angle) for angle in part))


def seen_lever(bar: NDArray[np.float64], panel: NDArray[np.float64]) -> tuple[Lever, float] | None:
    """The handle, and how far it is turned up, radians; None where too few points show it.

    The door's surface tells which way they look, the bar's own direction in it how it is turned.
    The spindle is at the bar's left end for the robot, or below.

    Args:
        bar: Points of the handle's bar, n × 3, metres from the arm's foot, z above the floor.
        panel: The same of the door's front.
    """
    bar, panel = (points[np.isfinite(points).all(1)] for points in (bar, panel))
    if len(bar) < SEEN or len(panel) < SEEN:
        return None
    along = _line(panel[:, :2], np.array([0.0, -1.0]))
    inwards = np.array([-along[1], along[0]])
    flat = np.stack([bar[:, :2] @ along, bar[:, 2]], -1)
    way = _line(flat, np.array([1.0, 0.3]))
    across = np.array([-way[1], way[0]])
    tip = np.percentile(flat @ way, 99)
    middle = np.percentile(flat @ across, [2, 98]).mean()
    u, z = (tip - LENGTH) * way + middle * across
    x, y = u * along + (np.percentile(bar[:, :2] @ inwards, 3) + THICK / 2) * inwards
    yaw, turned = np.arctan2(along[1], along[0]), np.arctan2(way[1], way[0])
    return Lever(float(x), float(y), float(z), float(yaw)), float(turned)


def _rotated(way: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * way[0] - s * way[1], s * way[0] + c * way[1]])


def _line(points: NDArray[np.float64], towards: NDArray[np.float64]) -> NDArray[np.float64]:
    """The direction of the longest extent of points in a plane, without those far off it."""
    for _ in range(2):
        middle = np.median(points, axis=0)
        _, _, ways = np.linalg.svd(points - points.mean(0), full_matrices=False)
        off = np.abs((points - middle) @ ways[1])
        points = points[off <= max(2 * float(np.median(off)), 0.002)]
    _, _, ways = np.linalg.svd(points - points.mean(0), full_matrices=False)
    found: NDArray[np.float64] = ways[0] if ways[0] @ towards > 0 else -ways[0]
    return found
