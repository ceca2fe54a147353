"""Where the arm's joints have to be for the gripper to be somewhere: damped least squares.

Buss 2004, Introduction to Inverse Kinematics with Jacobian Transpose, Pseudoinverse and Damped
Least Squares Methods; on MuJoCo's own Jacobians. The gripper always points down.
"""

from collections.abc import Callable
from dataclasses import astuple, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.skills.driving import Stance
from tpvqa_robots.toys.machine import wheels_of
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.scene import YAW_JOINT

Vector = NDArray[np.float64]

NEAR, TURNED = 0.002, 0.01
"""How far off a solution may be, metres and radians."""
STEPS, MEMORY = 80, 0.03
APART = 0.02
"""Between two points of a straight line that are looked at, metres."""
BUMP = 0.002
"""How deep a part may be in the table or in its own base, metres: meshes are convex hulls."""


BEGUN = Stance(0.0, 0.0, 0.0)


class OutOfReachError(Exception):
    """The gripper cannot get there, or not on a straight line."""


@dataclass(frozen=True, slots=True)
class Grip:
    """A place of the gripper that points down, seen from the arm's foot.

    Attributes:
        x: Metres ahead of the foot.
        y: Metres to its left.
        z: Metres above the floor, of the point between the fingertips.
        angle: Of the direction in which the fingers close, radians from x.
    """

    x: float
    y: float
    z: float
    angle: float

    def at(self, **changes: float) -> "Grip":
        """The same place, but for what is named."""
        return replace(self, **changes)


class Kinematics:
    """Plans on a copy of the robot's joints; it does not look at where things truly are.

    Args:
        model: The compiled scene.
        joints: Addresses of the arm's joints in `qpos`.
        dofs: The same in `qvel`.
        stance: Tells where the base stands: what stands around it is elsewhere then.
    """

    def __init__(
        self,
        model: Any,
        joints: NDArray[np.int64],
        dofs: NDArray[np.int64],
        *,
        stance: Callable[[], Stance] = lambda: BEGUN,
    ):
        self._mj = mj = load_mujoco()
        self._model, self._data = model, mj.MjData(model)
        self._joints, self._dofs = joints, dofs
        self._stance = stance
        self._base = [*(w.joint for w in wheels_of(model)), model.joint(YAW_JOINT).qposadr[0]]
        self._site = model.site("arm_hand_grip_site").id
        self._foot = model.body("support").id
        self._range = model.jnt_range[[model.dof_jntid[dof] for dof in dofs]]
        self._moving = _bodies_under(model, "arm_shoulder_link")
        self._fixed = {model.body("table").id, 0} | (
            _bodies_under(model, "base") - self._moving - {model.body("arm_fixed_base_link").id}
        )

    def grip(self, arm: Vector) -> Grip:
        """Where the gripper is with the arm so."""
        self._place(arm)
        at, turned = self._data.site_xpos[self._site], self._data.site_xmat[self._site]
        foot = self._data.xmat[self._foot].reshape(3, 3)
        x, y, _ = foot.T @ (at - self._data.xpos[self._foot])
        closing = foot.T @ turned.reshape(3, 3)[:, 0]
        return Grip(float(x), float(y), float(at[2]), float(np.arctan2(closing[1], closing[0])))

    def solve(self, wanted: Grip, start: Vector) -> Vector:
        """The joints that bring the gripper there, near others.

        Raises:
            OutOfReachError: There are none within the joints' ranges.
        """
        arm = np.array(start)
        c, s = np.cos(wanted.angle), np.sin(wanted.angle)
        aim = np.array([[c, s, 0], [s, -c, 0], [0, 0, -1]])
        across, turning = np.zeros((3, self._model.nv)), np.zeros((3, self._model.nv))
        for _ in range(STEPS):
            self._place(arm)
            at = self._data.site_xpos[self._site]
            turned = self._data.site_xmat[self._site].reshape(3, 3)
            off = np.array([wanted.x, wanted.y, wanted.z]) - at
            twist = sum(np.cross(turned[:, i], aim[:, i]) for i in range(3)) / 2
            if np.linalg.norm(off) < NEAR / 4 and np.linalg.norm(twist) < TURNED / 4:
                break
            self._mj.mj_jacSite(self._model, self._data, across, turning, self._site)
            jacobian = np.vstack([across, turning])[:, self._dofs]
            damped = jacobian @ jacobian.T + MEMORY**2 * np.eye(6) * 0.1
            step = jacobian.T @ np.linalg.solve(damped, np.concatenate([off, twist]))
            arm = arm + step * min(1.0, 0.3 / max(float(np.abs(step).max()), 1e-9))
        inside = (arm >= self._range[:, 0]) & (arm <= self._range[:, 1])
        if np.linalg.norm(off) > NEAR or np.linalg.norm(twist) > TURNED or not inside.all():
            raise OutOfReachError(f"({wanted.x:.2f}, {wanted.y:.2f}, {wanted.z:.2f}) m")
        return arm

    def line(self, wanted: Grip, start: Vector) -> list[Vector]:
        """The joints along a straight line of the gripper, which turns evenly meanwhile.

        Raises:
            OutOfReachError: A point of it cannot be reached, or the arm would jump, or touch the
                table or its own base.
        """
        here = self.grip(start)
        turn = (wanted.angle - here.angle + np.pi) % (2 * np.pi) - np.pi
        ends = np.array([here.x, here.y, here.z]), np.array([wanted.x, wanted.y, wanted.z])
        count = max(2, int(np.ceil(np.linalg.norm(ends[1] - ends[0]) / APART + abs(turn) / 0.1)))
        arms = [np.array(start)]
        for part in np.linspace(0, 1, count + 1)[1:]:
            x, y, z = ends[0] + part * (ends[1] - ends[0])
            arm = self.solve(Grip(x, y, z, here.angle + part * turn), arms[-1])
            if np.abs(arm - arms[-1]).max() > 0.6:
                raise OutOfReachError("the arm would have to fold over")
            self._see_free(arm)
            arms.append(arm)
        return arms

    def joint_by_joint(self, start: Vector, end: Vector) -> list[Vector]:
        """The joints from one posture to another, all of them evenly.

        Raises:
            OutOfReachError: On the way the arm would touch the table or its own base.
        """
        count = max(2, int(np.ceil(np.abs(end - start).max() / 0.1)))
        arms = [start + part * (end - start) for part in np.linspace(0, 1, count + 1)]
        for arm in arms[1:]:
            self._see_free(arm)
        return arms

    def _place(self, arm: Vector) -> None:
        # All is seen from the arm's foot, as where the base has not turned.
        self._data.qpos[self._joints] = arm
        self._mj.mj_kinematics(self._model, self._data)
        self._mj.mj_comPos(self._model, self._data)

    def _see_free(self, arm: Vector) -> None:
        stance = astuple(self._stance())
        self._data.qpos[self._base] = stance[-len(self._base) :]
        self._place(arm)
        self._data.qpos[self._base] = 0.0
        self._mj.mj_collision(self._model, self._data)
        for contact in self._data.contact[: self._data.ncon]:
            bodies = {int(self._model.geom_bodyid[geom]) for geom in contact.geom}
            if contact.dist < -BUMP and bodies & self._moving and bodies & self._fixed:
                names = " and ".join(sorted(self._model.body(body).name for body in bodies))
                raise OutOfReachError(f"{names} would touch")


def _bodies_under(model: Any, name: str) -> set[int]:
    found = {model.body(name).id}
    for body in range(model.nbody):
        if int(model.body_parentid[body]) in found:
            found.add(body)
    return found
