"""A table with things, a hand that floats above it, and the robot's camera: no arm.

Thousands of grasps can be tried here for one that the whole robot makes.
"""

from collections.abc import Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tpvqa_robots.grasps.training.solids import Thing, add
from tpvqa_robots.toys.cameras import HEIGHT, WIDTH
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.room import TABLE, furnished
from tpvqa_robots.toys.scene import gripper

FOVY = 50.0
"""Of the robot's camera above, degrees."""
EYE = (-0.187, 0.0, 1.04)
"""Where that camera is over the middle of the part of the table that the arm reaches, metres; a
test holds it against the robot's own."""
LEAN = 0.177
"""Sine of how far it looks ahead."""
STIFF, MASS = 1000.0, 5.0
"""The arm behind the hand: 1/s², as `toys.machine` has it, and kg."""
SLIDES = ("sway_x", "sway_y", "lift")

_TABLE = """
  <geom name="table" type="box" pos="0 0 -.02" size=".6 .6 .02" group="1" friction="1 .02 .003"
    condim="4"/>
"""
_CARRIAGE = """<mujoco><worldbody><body name="carriage" gravcomp="1">
  <joint name="sway_x" type="slide" axis="1 0 0" armature="{mass}" damping="0"/>
  <joint name="sway_y" type="slide" axis="0 1 0" armature="{mass}" damping="0"/>
  <joint name="lift" type="slide" axis="0 0 -1" armature="{mass}" damping="0"/>
  <geom type="sphere" size=".01" pos="0 0 -.2" mass=".1" contype="0" conaffinity="0" group="3"/>
</body></worldbody><actuator>{motors}</actuator></mujoco>"""


class Bench:
    """The table as a model and its state.

    Args:
        things: What lies on it.
        rng: How they lie: they fall from a little above, the first in the middle.
        apart: Metres between the first and the others.

    Attributes:
        settled: Whether all of them lie still.
    """

    def __init__(self, things: Sequence[Thing], rng: Generator, *, apart: float = 0.1):
        self.mj = mj = load_mujoco()
        room = furnished("bench", assets="", table=_TABLE)
        for number, thing in enumerate(things):
            way = rng.uniform(0, 2 * np.pi)
            far = 0.0 if number == 0 else apart + rng.uniform(0, 0.04)
            off = rng.uniform(-0.05, 0.05, 2)
            at = (far * np.cos(way) + off[0], far * np.sin(way) + off[1], TABLE + 0.09)
            add(mj, room, thing, f"thing_{number}", at, _quat(thing, rng))
        motors = "".join(
            f'<position name="{name}" joint="{name}" kp="{STIFF * MASS}" dampratio="1"/>'
            for name in SLIDES
        )
        carriage = mj.MjSpec.from_string(_CARRIAGE.format(mass=MASS, motors=motors))
        hand = gripper()
        for body in hand.bodies:
            body.gravcomp = 1.0
        turned = [np.sqrt(0.5), 0, 0, np.sqrt(0.5)]
        carriage.body("carriage").add_frame(pos=[0, 0, -0.145], quat=turned).attach_body(
            hand.body("robotiq_85_adapter_link"), "arm_hand_", ""
        )
        room.worldbody.add_frame(pos=[0, 0, TABLE + 0.5]).attach_body(
            carriage.body("carriage"), "", ""
        )
        lean = np.sqrt(1 - LEAN**2)
        room.worldbody.add_camera(
            name="overhead",
            pos=[EYE[0], EYE[1], EYE[2] + TABLE],
            quat=_looking(lean),
            fovy=FOVY,
        )
        self.model = room.compile()
        self.model.vis.quality.offsamples = self.model.vis.quality.shadowsize = 0
        self.data = mj.MjData(self.model)
        self.names = [f"thing_{number}" for number in range(len(things))]
        self.settled = self._settle()

    def _settle(self) -> bool:
        """Whether all things come to lie on the table, not far from its middle."""
        self.mj.mj_step(self.model, self.data, nstep=550)
        before = self._places()
        self.mj.mj_step(self.model, self.data, nstep=50)
        places = self._places()
        on_it = np.abs(places[:, :2]).max() < 0.2 and (places[:, 2] > TABLE - 0.01).all()
        return bool(on_it and np.abs(places - before).max() < 0.002)

    def _places(self) -> NDArray[np.float64]:
        return np.array([self.data.body(name).xpos for name in self.names])

    def depth(self) -> NDArray[np.float32]:
        """What the camera measures without errors, metres along its axis: `HEIGHT` × `WIDTH`."""
        option = self.mj.MjvOption()
        option.geomgroup[:] = [0, 1, 0, 0, 0, 0]
        option.sitegroup[:] = 0
        with self.mj.Renderer(self.model, HEIGHT, WIDTH) as canvas:
            canvas.enable_depth_rendering()
            hidden = [g for g in range(self.model.ngeom) if self._of_hand(g)]
            groups = self.model.geom_group[hidden].copy()
            self.model.geom_group[hidden] = 3
            canvas.update_scene(self.data, "overhead", option)
            canvas.scene.flags[self.mj.mjtRndFlag.mjRND_SHADOW] = 0
            depth = np.array(canvas.render(), np.float32)
            self.model.geom_group[hidden] = groups
        return depth

    def _of_hand(self, geom: int) -> bool:
        name = self.model.body(self.model.geom_bodyid[geom]).name
        return bool(name == "carriage" or name.startswith("arm_hand"))


def _quat(thing: Thing, rng: Generator) -> NDArray[np.float64]:
    if thing.upright:
        yaw = rng.uniform(-np.pi, np.pi)
        return np.array([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)])
    quat = rng.normal(size=4)
    return np.array(quat / np.linalg.norm(quat))


def _looking(cosine: float) -> list[float]:
    """Of a camera that looks down and a little ahead, its top towards x."""
    mj = load_mujoco()
    across, up = np.array([0.0, -1, 0]), np.array([cosine, 0, LEAN])
    axes = np.stack([across, up, np.cross(across, up)], -1)
    quat = np.empty(4)
    mj.mju_mat2Quat(quat, axes.ravel())
    return [float(v) for v in quat]
