"""Robosuite's door with a latch, on a sideboard before the toys' robot."""

from typing import Any

from tpvqa_robots.toys.mujoco import robosuite_models
from tpvqa_robots.toys.room import TABLE, furnished
from tpvqa_robots.toys.scene import Mast, part_of_robosuite, with_robot
from tpvqa_robots.toys.things import Spot

DOOR, HANDLE = "door", "handle"
"""What tasks call them."""
LATCH, BAR, PANEL = "latch", "handle", "panel"
"""The body that turns with the handle, the geom of it that is gripped, and the door's own geom:
robosuite's names. Geoms and bodies are told apart where there are both."""
HINGE_JOINT, LATCH_JOINT = "hinge", "latch_joint"
HALF_HEIGHT = 0.30
"""Of the door's frame, metres."""
USUALLY = (0.65, 0.0)
"""Where the door's middle stands, metres from the arm's foot."""
SIDE = Mast(
    end="-.05 .34 1.55",
    head="-.04 .34 1.55",
    eye="-.02 .34 1.53",
    axes="-.42 -.9075 0 .66 -.305 .686",
)
"""The camera sees the door's front past the arm."""

_ASSETS = """
  <texture name="grain" type="2d" builtin="flat" rgb1=".66 .54 .40" width="200" height="200"
    mark="random" markrgb=".61 .49 .35" random=".08"/>
  <material name="wood" texture="grain" specular=".15" shininess=".2"/>
"""
_SIDEBOARD = """
  <geom name="table" type="box" pos=".72 0 -.02" size=".17 .42 .02" material="wood" group="1"
    friction="1 .02 .003" condim="4"/>
  <geom type="box" pos=".74 0 -.36" size=".13 .38 .32" rgba=".36 .30 .25 1" group="1"/>
"""


def _door() -> Any:
    """Robosuite's door as a spec; hinge and latch as its own environment has them."""
    spec = part_of_robosuite(robosuite_models() / "objects" / "door_lock.xml")
    for geom in spec.geoms:
        geom.group = 1
    hinge = spec.joint(HINGE_JOINT)
    hinge.frictionloss, hinge.damping = 0.0, 0.1
    return spec


def build(spot: Spot) -> Any:
    """The compiled model.

    Args:
        spot: Where the door's middle stands, and how it is turned.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    room = furnished("door", assets=_ASSETS, table=_SIDEBOARD)
    spec = _door()
    frame = room.worldbody.add_frame(
        pos=[spot.x, spot.y, TABLE + HALF_HEIGHT], euler=[0, 0, spot.yaw]
    )
    frame.attach_body(spec.body("object"), "", "")
    return with_robot(room, SIDE)
