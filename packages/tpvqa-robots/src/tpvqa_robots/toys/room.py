"""What every room has around its table: light, sky, floor, and a camera that sees it whole."""

from typing import Any

from tpvqa_robots.toys.mujoco import load_mujoco

TABLE = 0.70
"""Height of the table's top, metres."""

_ROOM = """<mujoco model="{name}">
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
  {assets}
</asset>
<worldbody>
  <light pos="-.6 1.6 3.0" dir=".35 -.5 -1" diffuse=".55 .54 .50" specular=".25 .25 .25"
    directional="true"/>
  <light pos="1.5 -2 3" dir="-.3 .5 -1" diffuse=".22 .23 .26" specular=".1 .1 .1"
    directional="true" castshadow="false"/>
  <geom name="floor" type="plane" size="8 8 .1" material="tiles" group="1" friction="1 .02 .003"/>
  <body name="table" pos="0 0 {height}">{table}</body>
  {things}
  <camera name="room" pos="2.15 -1.45 1.75" xyaxes=".60 .80 0 -.33 .25 .91" fovy="38"/>
</worldbody></mujoco>"""


def furnished(name: str, *, assets: str, table: str, things: str = "") -> Any:
    """A room as a spec.

    Args:
        name: Of the model.
        assets: Textures and materials, in MJCF.
        table: What the table is made of and carries, its top at height 0; the body is `table`.
        things: Other bodies, in the room's coordinates.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """
    room = _ROOM.format(name=name, assets=assets, height=TABLE, table=table, things=things)
    return load_mujoco().MjSpec.from_string(room)
