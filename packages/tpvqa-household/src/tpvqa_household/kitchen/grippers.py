"""The robot's two grippers, and how they hold things.

A gripper's frame, as in the library, has its origin between the finger tips: y is the direction
in which the fingers close, z the one in which they point, x faces the robot's own camera.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from tpvqa_household.kitchen.assets import Grasp, Model
from tpvqa_household.kitchen.rotation import Array, about_z

OPEN = (0.045, 0.075)
"""Range of the opening of a hand that holds nothing, metres."""
_SHOULDER = np.array([0.22, -0.5, 0.05])


@dataclass(frozen=True, slots=True)
class Hand:
    """A pose of a gripper.

    Attributes:
        tip: The point between the finger tips.
        axes: Its axes as columns.
        width: How far the fingers are apart.
    """

    tip: Array
    axes: Array
    width: float


def empty_hand(side: str, camera: Array, position: Array, rng: np.random.Generator) -> Hand:
    """Where a hand is in the robot's own view: low at its side, pointing ahead and up.

    Args:
        side: Left or right.
        camera: Axes of the camera (right, up, backward as columns).
        position: Of the camera.
        rng: Varies the pose.
    """
    sign = -1.0 if side == "left" else 1.0
    tip = np.array(
        [sign * rng.uniform(0.15, 0.19), rng.uniform(-0.115, -0.08), -rng.uniform(0.44, 0.5)]
    )
    pointing = np.array([-sign * rng.uniform(-0.05, 0.3), rng.uniform(0.5, 0.8), -0.7])
    z = pointing / np.linalg.norm(pointing)
    x = -tip / np.linalg.norm(tip)
    x = x - z * (x @ z)
    x /= np.linalg.norm(x)
    axes = np.stack([x, np.cross(z, x), z], axis=1) @ about_z(float(rng.uniform(-0.35, 0.35)))
    return Hand(position + camera @ tip, camera @ axes, float(rng.uniform(*OPEN)))


def forearm(side: str, hand: Hand, wrist: Array, camera: Array, position: Array) -> Array:
    """Axes of the forearm in the gripper's frame, so that it comes from the robot's shoulder."""
    sign = -1.0 if side == "left" else 1.0
    shoulder = position + camera @ (_SHOULDER * [sign, 1, 1])
    away = hand.axes.T @ (hand.tip + hand.axes @ wrist - shoulder)
    z = away / np.linalg.norm(away)
    x = np.array([1.0, 0, 0]) - z * z[0]
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z], axis=1)


def holding(
    model: Model, hand: Hand, rng: np.random.Generator, *, level: float = 0.0
) -> tuple[Array, Array, Hand]:
    """Where a held thing is, and how the gripper turns about its own z to show the thing's top.

    Args:
        model: What is held; its grasps say how.
        hand: The hand before it turns.
        rng: Varies how it is held.
        level: From 0 to 1: how far a thing on which something lies is kept level.

    Returns:
        Position and axes of the thing, and the hand that holds it.
    """
    grasp = _grasp(model, rng)
    closing, along = _unit(grasp.axis), _unit(grasp.approach)
    own = np.stack([np.cross(closing, along), closing, along], axis=1)
    top = own.T @ np.array([0.0, 0.0, 1.0])
    turn = float(rng.uniform(-0.35, 0.35))
    if np.hypot(top[0], top[1]) > 0.2:  # the top is not along the fingers: turn it to the robot
        turn -= float(np.arctan2(top[1], top[0]))
    axes = hand.axes @ about_z(turn)
    if level > 0:
        up = (1 - level) * (axes @ top) + level * np.array([0, 0, 1.0])
        along_hand = axes[:, 2] - up * (axes[:, 2] @ up) / (up @ up)
        z, y = _unit(along_hand), _unit(up * np.sign(top[1] or 1.0))
        axes = np.stack([np.cross(y, z), y, z], axis=1)
    rotation = axes @ own.T
    position = hand.tip - rotation @ np.asarray(grasp.offset)
    return position, rotation, Hand(hand.tip, axes, grasp.width)


def _grasp(model: Model, rng: np.random.Generator) -> Grasp:
    """The preferred grasp; bread is mostly held by its side, so that its top is in view."""
    if not model.grasps:
        raise ValueError(f"{model.name} cannot be held: it has no grasp")
    if model.kind == "bread" and rng.random() < 0.75:
        return model.grasps[-1]
    return model.grasps[0]


def _unit(vector: ArrayLike) -> Array:
    array = np.asarray(vector, float)
    return np.asarray(array / np.linalg.norm(array))
