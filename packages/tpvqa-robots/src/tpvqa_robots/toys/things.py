"""What lies on the table, as MJCF: boxes, balls and capsules that are seen as they collide."""

from collections.abc import Mapping
from dataclasses import dataclass

WALL, LENGTH, WIDTH, HEIGHT = 0.012, 0.18, 0.15, 0.065
"""Of a container, metres: its walls' thickness and its outer sizes."""
GOAL_SIZE = (0.26, 0.30)
"""Of the goal area, metres: away from the robot and across."""
TOUCH = 'friction="1.2 0.02 0.003" condim="6" solref="0.01 1" group="1"'

COLOURS: Mapping[str, str] = {
    "blue_container": "0.08 0.22 0.85 1",
    "cyan_container": "0.10 0.78 0.80 1",
}
MOVABLE = ("blue_container", "cyan_container", "toy_eggplant")


@dataclass(frozen=True, slots=True)
class Spot:
    """Where a thing stands on the table: metres from the arm's foot, radians."""

    x: float
    y: float
    yaw: float = 0.0


def container(name: str) -> str:
    """An open box of five plates, about its lower centre."""
    t, x, y, h = WALL / 2, LENGTH / 2, WIDTH / 2, HEIGHT / 2
    plates = (
        (x, y, t, 0, 0, t),
        (x, t, h, 0, y - t, h),
        (x, t, h, 0, t - y, h),
        (t, y, h, x - t, 0, h),
        (t, y, h, t - x, 0, h),
    )
    return "".join(
        f'<geom name="{name}_{i}" type="box" size="{a:.4f} {b:.4f} {c:.4f}" '
        f'pos="{px:.4f} {py:.4f} {pz:.4f}" material="{name}" mass="0.024" {TOUCH}/>'
        for i, (a, b, c, px, py, pz) in enumerate(plates)
    )


def eggplant(name: str) -> str:
    """Purple, thicker at one end, with a green cap; it lies on its side."""
    return f"""
      <geom name="{name}_0" type="capsule" fromto="-.026 0 .024 .018 0 .024" size=".020"
        material="eggplant" mass="0.03" {TOUCH}/>
      <geom name="{name}_1" type="ellipsoid" pos=".020 0 .024" size=".032 .024 .024"
        material="eggplant" mass="0.03" {TOUCH}/>
      <geom name="{name}_2" type="ellipsoid" pos="-.044 0 .024" size=".008 .015 .015"
        material="cap" mass="0.003" {TOUCH}/>
      <geom name="{name}_3" type="capsule" fromto="-.05 0 .024 -.060 0 .027" size=".004"
        material="cap" mass="0.001" {TOUCH}/>"""


def bystanders() -> str:
    """Toys that no task is about: a ball, a cube, and a train of two blocks."""
    return f"""
    <body name="toy_ball" pos=".80 .20 .75"><freejoint/>
      <geom type="sphere" size=".032" material="yellow" mass=".03" {TOUCH}/></body>
    <body name="toy_cube" pos=".86 -.62 .73" euler="0 0 .5"><freejoint/>
      <geom type="box" size=".025 .025 .025" material="orange" mass=".04" {TOUCH}/></body>
    <body name="toy_blocks" pos=".93 .60 .725" euler="0 0 1.1"><freejoint/>
      <geom type="box" size=".06 .022 .02" material="green" mass=".05" {TOUCH}/>
      <geom type="box" size=".022 .022 .02" pos="-.035 0 .04" material="yellow" mass=".02" {TOUCH}/>
      <geom type="cylinder" size=".009 .014" pos=".03 0 .034" material="wood" mass=".01" {TOUCH}/>
    </body>"""
