"""The bins of robosuite's pick-and-place with its four things, before the toys' robot."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

from tpvqa_robots.toys.mujoco import load_mujoco, robosuite_models
from tpvqa_robots.toys.scene import TABLE, with_robot
from tpvqa_robots.toys.things import Spot

THINGS: Mapping[str, float] = {"milk": 0.085, "bread": 0.045, "cereal": 0.10, "can": 0.06}
"""How far each thing's middle is above what it stands on, metres, as robosuite has it."""
SOURCE = "big_bin"
AT: Mapping[str, tuple[float, float]] = {SOURCE: (0.56, -0.30), "bins": (0.56, 0.30)}
"""Middles of the bins, metres from the arm's foot when the base has not turned."""
HALF = (0.20, 0.25)
"""Half of a bin's sizes: away from the robot and across."""
WALL, RIM = 0.01, 0.10
"""Half the thickness of a wall, and its height above the bin's floor."""
TARGETS: Mapping[str, tuple[float, float]] = {
    "milk_bin": (-0.1, -0.125),
    "bread_bin": (0.1, -0.125),
    "cereal_bin": (-0.1, 0.125),
    "can_bin": (0.1, 0.125),
}
"""Middles of the four small bins, from that of all: which thing goes where is robosuite's."""

_ROOM = """<mujoco model="bins">
<compiler angle="radian" autolimits="true"/>
<statistic center=".5 0 .7" extent="6"/>
<option timestep="0.002" integrator="implicitfast" cone="elliptic" impratio="20"/>
<visual>
  <headlight ambient=".38 .38 .40" diffuse=".22 .22 .22" specular="0 0 0"/>
  <quality shadowsize="4096" offsamples="4"/><map znear="0.007" zfar="4" shadowclip="1.4"/>
  <global offwidth="1280" offheight="960"/>
</visual>
<asset>
  <texture type="skybox" builtin="gradient" rgb1=".93 .94 .96" rgb2=".70 .76 .84"
    width="128" height="128"/>
  <texture name="tiles" type="2d" builtin="checker" rgb1=".52 .53 .55" rgb2=".47 .485 .505"
    markrgb=".42 .43 .45" mark="edge" width="300" height="300"/>
  <material name="tiles" texture="tiles" texrepeat="5 5" texuniform="false"/>
  <texture name="light" type="cube" file="{textures}/light-wood.png"/>
  <texture name="dark" type="cube" file="{textures}/dark-wood.png"/>
  <material name="light" texture="light" texrepeat="3 3"/>
  <material name="dark" texture="dark" texrepeat="3 3"/>
</asset>
<worldbody>
  <light pos="-.6 1.6 3.0" dir=".35 -.5 -1" diffuse=".55 .54 .50" specular=".25 .25 .25"
    directional="true"/>
  <light pos="1.5 -2 3" dir="-.3 .5 -1" diffuse=".22 .23 .26" specular=".1 .1 .1"
    directional="true" castshadow="false"/>
  <geom name="floor" type="plane" size="8 8 .1" material="tiles" group="1" friction="1 .02 .003"/>
  <body name="table" pos="0 0 {table}">{bins}</body>
  <camera name="room" pos="2.15 -1.45 1.75" xyaxes=".60 .80 0 -.33 .25 .91" fovy="38"/>
</worldbody></mujoco>"""


def _box(x: float, y: float, z: float, a: float, b: float, c: float, material: str) -> str:
    return (
        f'<geom type="box" pos="{x} {y} {z}" size="{a} {b} {c}" material="{material}" group="1" '
        'friction="1 .005 .0001"/>'
    )


def _bin(name: str, material: str, *, parted: bool) -> str:
    (x, y), (a, b) = AT[name], HALF
    walls = [(x, y - b, a), (x, y + b, a), *([(x, y, a)] if parted else [])]
    across = [(x - a, y, b), (x + a, y, b), *([(x, y, b)] if parted else [])]
    return (
        _box(x, y, -0.02, a, b, 0.02, material)
        + "".join(_box(u, v, RIM / 2, long, WALL, RIM / 2, material) for u, v, long in walls)
        + "".join(
            f'<geom type="cylinder" pos="{x + i * 0.15} {y + j * 0.2} -.37" size=".012 .33" '
            'rgba=".22 .23 .25 1" group="1" contype="0" conaffinity="0"/>'
            for i in (-1, 1)
            for j in (-1, 1)
        )
        + "".join(_box(u, v, RIM / 2, WALL, long, RIM / 2, material) for u, v, long in across)
    )


def _thing(name: str) -> Any:
    """A thing of robosuite's as a spec with one body, which can be seen and touched."""
    file = robosuite_models() / "objects" / f"{name}.xml"
    tree = ET.parse(file)
    for asset in tree.iter():
        path = asset.get("file")
        if path is not None:
            asset.set("file", str((file.parent / path).resolve()))
    for geom in tree.iter("geom"):
        geom.set("group", "1")
    return load_mujoco().MjSpec.from_string(ET.tostring(tree.getroot(), encoding="unicode"))


def build(spots: Mapping[str, Spot]) -> Any:
    """The compiled model.

    Args:
        spots: Where the things stand.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    textures = robosuite_models() / "textures"
    bins = _bin(SOURCE, "light", parted=False) + _bin("bins", "dark", parted=True)
    room = load_mujoco().MjSpec.from_string(_ROOM.format(textures=textures, table=TABLE, bins=bins))
    for name, height in THINGS.items():
        spot = spots[name]
        frame = room.worldbody.add_frame(
            pos=[spot.x, spot.y, TABLE + height + 0.003], euler=[0, 0, spot.yaw]
        )
        spec = _thing(name)
        body = spec.body("object")
        body.name = name
        body.add_freejoint()
        frame.attach_body(body, "", "")
    return with_robot(room)
