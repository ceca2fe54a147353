"""The bins of robosuite's pick-and-place with its four things, before the toys' robot."""

from collections.abc import Mapping
from typing import Any

from tpvqa_robots.toys.mujoco import robosuite_models
from tpvqa_robots.toys.room import TABLE, furnished
from tpvqa_robots.toys.scene import part_of_robosuite, with_robot
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

_ASSETS = """
  <texture name="light" type="cube" file="{textures}/light-wood.png"/>
  <texture name="dark" type="cube" file="{textures}/dark-wood.png"/>
  <material name="light" texture="light" texrepeat="3 3"/>
  <material name="dark" texture="dark" texrepeat="3 3"/>
"""


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
    spec = part_of_robosuite(robosuite_models() / "objects" / f"{name}.xml")
    for geom in spec.geoms:
        geom.group = 1
    return spec


def build(spots: Mapping[str, Spot]) -> Any:
    """The compiled model.

    Args:
        spots: Where the things stand.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
    """
    assets = _ASSETS.format(textures=robosuite_models() / "textures")
    bins = _bin(SOURCE, "light", parted=False) + _bin("bins", "dark", parted=True)
    room = furnished("bins", assets=assets, table=bins)
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
