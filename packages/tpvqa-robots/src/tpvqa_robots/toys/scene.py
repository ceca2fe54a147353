"""The whole scene as one MuJoCo model: room, table, things, and the robot on its turning base."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from tpvqa_robots.toys.mujoco import load_mujoco, robosuite_models
from tpvqa_robots.toys.room import TABLE, furnished
from tpvqa_robots.toys.scans import SCANS, add_scan, half_height
from tpvqa_robots.toys.things import (
    COLOURS,
    GOAL_SIZE,
    MOVABLE,
    Spot,
    bystanders,
    container,
    eggplant,
)

GOAL = (0.62, 0.0)
"""Centre of the goal area; the arm's foot stands over the origin when the base has not turned."""
ARM_JOINTS = tuple(
    f"arm_{name}_joint"
    for name in ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")
)
YAW_JOINT = "joint_mobile_yaw"
WHEELS = ("mobile_forward", "mobile_side")
"""What a base that drives has besides: how far it has gone ahead and to its left."""
BRAKE = 4000.0
"""How hard these hold to the speed that they are told, Ns/m: robosuite's 1000 roll on too long."""
FINGER_JOINTS = ("arm_hand_finger_joint", "arm_hand_right_outer_knuckle_joint")
FINGER_GAIN, FINGER_TORQUE = 60.0, 3.0
"""Of a finger's motor, Nm/rad and Nm: some 30 N between the pads."""
SPOTS: Mapping[str, Spot] = {
    "blue_container": Spot(0.58, 0.44, 0.6),
    "cyan_container": Spot(0.60, -0.28, -0.35),
    "toy_eggplant": Spot(0.55, -0.56, 0.5),
}
ELSEWHERE = Spot(0.56, 0.70, -0.4)
"""Where a second toy stands."""
FAR = Spot(0.88, -0.44, 0.5)
"""Where the arm reaches nothing unless the base drives."""

_ASSETS = """
  <texture name="grain" type="2d" builtin="flat" rgb1=".66 .54 .40" width="200" height="200"
    mark="random" markrgb=".61 .49 .35" random=".08"/>
  <material name="wood" texture="grain" specular=".15" shininess=".2"/>
  <material name="metal" rgba=".22 .23 .25 1" specular=".4" shininess=".5"/>
  <material name="goal" rgba=".86 .16 .13 1" specular=".1"/>
  <material name="eggplant" rgba=".36 .06 .44 1" specular=".7" shininess=".7"/>
  <material name="cap" rgba=".20 .50 .14 1"/>
  <material name="yellow" rgba=".95 .78 .12 1" specular=".4"/>
  <material name="orange" rgba=".93 .48 .10 1" specular=".3"/>
  <material name="green" rgba=".25 .58 .22 1" specular=".3"/>
"""
_TABLE = """
    <geom name="table" type="box" pos=".78 0 -.02" size=".31 .85 .02" material="wood" group="1"
      friction="1 .02 .003" condim="4"/>
    {legs}
    <geom name="goal_area" type="box" pos="{gx} {gy} .0004" size="{ga} {gb} .0006"
      material="goal" group="1" contype="0" conaffinity="0"/>
"""

_MAST = """<mujoco><worldbody><body name="mast">
  <geom type="capsule" fromto="-.42 0 .35 -.42 0 1.78" size=".018" rgba=".25 .26 .28 1" group="1"
    contype="0" conaffinity="0" mass="1"/>
  <geom type="capsule" fromto="-.42 0 1.78 {end}" size=".014" rgba=".25 .26 .28 1" group="1"
    contype="0" conaffinity="0" mass=".4"/>
  <geom type="box" pos="{head}" size=".02 .05 .015" rgba=".12 .12 .13 1" group="1"
    contype="0" conaffinity="0" mass=".1"/>
  <camera name="overhead" pos="{eye}" xyaxes="{axes}" fovy="50"/>
</body></worldbody></mujoco>"""


@dataclass(frozen=True, slots=True)
class Mast:
    """Where the camera above the robot is, in MJCF, metres from the arm's foot.

    Attributes:
        end: Of the boom that carries it.
        head: Of its case.
        eye: Of its lens.
        axes: How it looks: its right and its upward axis.
    """

    end: str = ".40 0 1.78"
    head: str = ".42 0 1.775"
    eye: str = ".42 0 1.74"
    axes: str = "0 -1 0 .984 0 .177"


OVER_THE_TABLE = Mast()


def _materials() -> str:
    return "".join(
        f'<material name="{name}" rgba="{rgba}" specular=".3" shininess=".4"/>'
        for name, rgba in COLOURS.items()
    )


def _things(spots: Mapping[str, Spot]) -> str:
    found = []
    for name, spot in spots.items():
        if name not in MOVABLE:
            continue
        shape = eggplant(name) if name == "toy_eggplant" else container(name)
        found.append(
            f'<body name="{name}" pos="{spot.x} {spot.y} {TABLE + 0.002}" '
            f'euler="0 0 {spot.yaw}"><freejoint/>{shape}</body>'
        )
    return "".join(found)


def _room(spots: Mapping[str, Spot]) -> Any:
    legs = "".join(
        f'<geom type="box" pos="{x} {y} -.37" size=".025 .025 .33" material="metal" group="1"/>'
        for x in (0.52, 1.04)
        for y in (-0.8, 0.8)
    )
    table = _TABLE.format(
        legs=legs, gx=GOAL[0], gy=GOAL[1], ga=GOAL_SIZE[0] / 2, gb=GOAL_SIZE[1] / 2
    )
    things = _things(spots) + bystanders()
    room = furnished("toys", assets=_ASSETS + _materials(), table=table, things=things)
    for name, spot in spots.items():
        if name in SCANS:
            add_scan(room, name, (spot.x, spot.y, TABLE + half_height(name) + 0.002), spot.yaw)
    return room


def part_of_robosuite(file: Path) -> Any:
    """A model of robosuite's as a spec; two meshes of one name are one, as robosuite has it."""
    tree = ET.parse(file)
    for assets in tree.iter("asset"):
        seen: set[tuple[str, str | None]] = set()
        for asset in list(assets):
            key = asset.tag, asset.get("name")
            if key in seen:
                assets.remove(asset)
            seen.add(key)
            if asset.get("file"):
                asset.set("file", str(file.parent / str(asset.get("file"))))
    compiler = tree.getroot().find("compiler")
    if compiler is None:
        compiler = ET.SubElement(tree.getroot(), "compiler")
    compiler.set("angle", "radian")  # as robosuite has it where it puts its parts together
    return load_mujoco().MjSpec.from_string(ET.tostring(tree.getroot(), encoding="unicode"))


def _linked(hand: Any) -> Any:
    """The gripper with its fingers' linkages closed, as they are on the real one.

    The model leaves each finger's inner joints to a soft tendon, by which they close too far. Here
    four bars keep the pads parallel, one motor's turn goes to both fingers, and only what the
    fingers touch outside themselves stops them.
    """
    mj = load_mujoco()
    for tendon in list(hand.tendons):
        hand.delete(tendon)
    for follower, leader, ratio in (
        ("left_inner_finger_joint", "finger_joint", -1.0),
        ("left_inner_knuckle_joint", "finger_joint", 1.0),
        ("right_outer_knuckle_joint", "finger_joint", 1.0),
        ("right_inner_finger_joint", "right_outer_knuckle_joint", -1.0),
        ("right_inner_knuckle_joint", "right_outer_knuckle_joint", 1.0),
    ):
        hand.add_equality(
            type=mj.mjtEq.mjEQ_JOINT,
            name1=follower,
            name2=leader,
            objtype=mj.mjtObj.mjOBJ_JOINT,
            data=[0, ratio, *[0.0] * 9],
            solref=[0.005, 1.0],
        )
    for joint in hand.joints:
        joint.armature, joint.damping = 0.002, 0.05
    for motor in hand.actuators:
        motor.gainprm[0], motor.biasprm[1] = FINGER_GAIN, -FINGER_GAIN
        motor.forcelimited, motor.forcerange = True, [-FINGER_TORQUE, FINGER_TORQUE]
    for geom in hand.geoms:
        geom.solref = [0.01, 1.0]
    tips = {"left_inner_finger", "right_inner_finger"}
    names = [body.name for body in hand.bodies if body.name != "world"]
    for one, other in combinations(names, 2):
        if {one, other} != tips:
            hand.add_exclude(bodyname1=one, bodyname2=other)
    return hand


def gripper() -> Any:
    """The Robotiq 85 as a spec, its fingers' linkages closed.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    return _linked(part_of_robosuite(robosuite_models() / "grippers" / "robotiq_gripper_85.xml"))


def build(spots: Mapping[str, Spot] = SPOTS, *, drives: bool = False) -> Any:
    """The compiled model of the toys' table with the robot before it.

    Args:
        spots: Where the things stand: those of `things.MOVABLE` and `scans.SCANS` that are there.
        drives: Whether the base drives, too.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    return with_robot(_room(spots), drives=drives)


def with_robot(room: Any, camera: Mast = OVER_THE_TABLE, *, drives: bool = False) -> Any:
    """The compiled model: UR5e and Robotiq 85 on an Omron base that turns, as robosuite has them.

    Args:
        room: A spec in which the arm's foot is to stand over the origin; what the arm has to keep
            off is its body `table`.
        camera: Where the camera above it is.
        drives: Whether the base drives, too.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    mj = load_mujoco()
    assets = robosuite_models()
    base = part_of_robosuite(assets / "bases" / "omron_mobile_base.xml")
    for name in ("torso_height",) if drives else (*WHEELS, "torso_height"):
        base.delete(base.actuator(f"actuator_{name}"))
        base.delete(base.joint(f"joint_{name}"))
    for name in (*WHEELS, "mobile_yaw") if drives else ("mobile_yaw",):
        base.joint(f"joint_{name}").frictionloss = 20
    for name in WHEELS if drives else ():
        wheel = base.actuator(f"actuator_{name}")
        wheel.gainprm[0], wheel.biasprm[2] = BRAKE, -BRAKE
    mast = mj.MjSpec.from_string(
        _MAST.format(end=camera.end, head=camera.head, eye=camera.eye, axes=camera.axes)
    )
    base.body("base").add_frame().attach_body(mast.body("mast"), "", "")
    arm = part_of_robosuite(assets / "robots" / "ur5e" / "robot.xml")
    hand = gripper()
    arm.body("right_hand").add_frame().attach_body(
        hand.body("robotiq_85_adapter_link"), "hand_", ""
    )
    base.body("support").add_frame().attach_body(arm.body("base"), "arm_", "")
    room.worldbody.add_frame().attach_body(base.body("base"), "", "")
    return room.compile()
