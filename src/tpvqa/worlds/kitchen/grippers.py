"""The robot's two grippers, and how they hold things.

A gripper's frame has its origin between the finger tips: x is the direction in which the fingers
close, y the one in which they point, z faces the robot's own camera.
"""

from dataclasses import dataclass

import numpy as np

from tpvqa.worlds.kitchen.assets import Model
from tpvqa.worlds.kitchen.rotation import Array, about_y

PIECES = ("finger_a", "finger_b", "tip_a", "tip_b", "palm", "wrist", "arm")


@dataclass(frozen=True, slots=True)
class GripperShape:
    """Sizes of a gripper, metres.

    Attributes:
        finger: Half sizes of a finger.
        palm: Half sizes of the palm.
        arm: Radius of the forearm.
        open: How far the fingers stand apart when nothing is held.
        colours: Of fingers, palm and arm.
    """

    finger: tuple[float, float, float]
    palm: tuple[float, float, float]
    arm: float
    open: float
    colours: tuple[Array, Array, Array]


def draw_gripper(rng: np.random.Generator, split: str) -> GripperShape:
    """A random gripper. Held-out ones are slimmer or broader than any trained on, and coloured."""
    held_out = split == "held_out"
    thick = float(rng.uniform(0.004, 0.006) if held_out else rng.uniform(0.007, 0.012))
    broad = float(rng.uniform(0.018, 0.024) if held_out else rng.uniform(0.008, 0.015))
    long = float(rng.uniform(0.035, 0.055))
    palm = (
        float(rng.uniform(0.03, 0.045)),
        float(rng.uniform(0.02, 0.04)),
        float(rng.uniform(0.018, 0.03)),
    )
    dark = rng.uniform(0.05, 0.3) * np.ones(3)
    bright = rng.uniform(0.6, 0.95) * np.ones(3)
    colour = rng.uniform(0.1, 0.9, 3)
    choice = [dark, bright, colour] if held_out else [dark, bright, dark]
    order = rng.permutation(3)
    return GripperShape(
        finger=(thick, long, broad),
        palm=palm,
        arm=float(rng.uniform(0.024, 0.036)),
        open=float(rng.uniform(0.05, 0.09)),
        colours=(choice[order[0]], choice[order[1]], choice[order[2]]),
    )


def gripper_body(hand: str) -> str:
    """A gripper as a body that is put where it is wanted."""
    geoms = []
    for piece in PIECES:
        shape = "capsule" if piece in ("wrist", "arm") else "box"
        material = {"palm": "gripper", "wrist": "gripper", "arm": "arm"}.get(piece, "pads")
        geoms.append(
            f'<geom name="{hand}/{piece}" type="{shape}" size=".01 .02 .02" pos=".01 .02 .03"'
            f' quat=".7 .1 .7 .1" material="{material}" contype="0" conaffinity="0" group="1"'
            ' mass="0"/>'
        )
    return f'<body name="{hand}" mocap="true" pos="0 0 -20">{"".join(geoms)}</body>'


def pieces(shape: GripperShape, width: float) -> dict[str, tuple[Array, Array]]:
    """Place and MuJoCo size of every piece when the fingers are `width` apart."""
    thick, long, broad = shape.finger
    x = width / 2 + thick
    palm_y = -2 * long - shape.palm[1] + 0.012
    palm_x = max(shape.palm[0], x + thick)
    return {
        "finger_a": (np.array([-x, -long + 0.012, 0]), np.array([thick, long, broad])),
        "finger_b": (np.array([x, -long + 0.012, 0]), np.array([thick, long, broad])),
        "tip_a": (
            np.array([-x + 0.6 * thick, 0.002, 0]),
            np.array([0.4 * thick, 0.011, broad * 1.15]),
        ),
        "tip_b": (
            np.array([x - 0.6 * thick, 0.002, 0]),
            np.array([0.4 * thick, 0.011, broad * 1.15]),
        ),
        "palm": (np.array([0, palm_y, 0]), np.array([palm_x, shape.palm[1], shape.palm[2]])),
        "wrist": (np.array([0, palm_y - 0.06, 0]), np.array([shape.arm * 0.8, 0.04, 0])),
        "arm": (np.array([0, palm_y - 0.3, 0]), np.array([shape.arm, 0.2, 0])),
    }


def hand_pose(
    hand: str, camera: Array, position: Array, rng: np.random.Generator
) -> tuple[Array, Array]:
    """Where a hand is in the robot's own view: low at its side, pointing ahead and up.

    Args:
        hand: Left or right.
        camera: Axes of the camera (right, up, backward as columns).
        position: Of the camera.
        rng: Varies the pose.

    Returns:
        The point between the finger tips and the gripper's axes as columns.
    """
    side = -1.0 if hand == "left" else 1.0
    tip = np.array(
        [side * rng.uniform(0.15, 0.19), rng.uniform(-0.135, -0.1), -rng.uniform(0.44, 0.5)]
    )
    pointing = np.array([-side * rng.uniform(-0.05, 0.3), rng.uniform(0.5, 0.8), -0.7])
    y = pointing / np.linalg.norm(pointing)
    z = -tip / np.linalg.norm(tip)
    z = z - y * (z @ y)
    z /= np.linalg.norm(z)
    axes = np.stack([np.cross(y, z), y, z], axis=1) @ about_y(float(rng.uniform(-0.35, 0.35)))
    return position + camera @ tip, camera @ axes


def held_pose(
    model: Model, tip: Array, axes: Array, rng: np.random.Generator, *, face: Array | None = None
) -> tuple[Array, Array, Array]:
    """Where a held thing is, and how the gripper turns to show its face.

    Args:
        model: What is held; its grasp says how.
        tip: The point between the finger tips.
        axes: The gripper's axes.
        face: The direction of the thing that should face the robot; its top by default.

    Returns:
        Position and axes of the thing, and the axes of the gripper.
    """
    if not model.grasps:
        raise ValueError(f"{model.name} cannot be held: it has no grasp")
    grasp = model.grasps[0]
    closing, along = _unit(grasp.axis), _unit(grasp.approach)
    own = np.stack([closing, along, np.cross(closing, along)], axis=1)
    look = np.array([0.0, 0.0, 1.0]) if face is None else face
    in_hand = own.T @ look
    # Turn the gripper about its pointing direction until the face looks at the robot.
    turn = float(np.arctan2(in_hand[0], in_hand[2])) + float(rng.uniform(-0.45, 0.45))
    if np.hypot(in_hand[0], in_hand[2]) < 0.2:
        turn = float(rng.uniform(-0.5, 0.5))
    turned = axes @ about_y(-turn)
    rotation = turned @ own.T
    return tip - rotation @ np.asarray(grasp.offset), rotation, turned


def _unit(vector: tuple[float, float, float]) -> Array:
    array = np.asarray(vector, float)
    return np.asarray(array / np.linalg.norm(array))
