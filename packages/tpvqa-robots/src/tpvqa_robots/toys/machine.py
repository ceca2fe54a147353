"""The robot's motors: torques that follow a reference, a base that turns, two fingers, a clock."""

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.scene import ARM_JOINTS, FINGER_JOINTS, WHEELS, YAW_JOINT

Vector = NDArray[np.float64]

TICK = 0.02
"""Seconds between two looks at the clock: whatever waits notices a stop after as many."""
STIFFNESS, DAMPING = 1000.0, 63.0
"""Of the arm's joints once their inertia is taken out, 1/s² and 1/s."""
TURNING, TURN_GAIN = 0.8, 6.0
"""The base's greatest speed, rad/s, and its speed for an error of one radian."""
DRIVING, DRIVE_GAIN = 0.3, 3.0
"""The same of its wheels along each of its ways, m/s, and for an error of one metre."""
STANDING = 0.002
"""m/s below which wheels that brake are taken to stand, and are held there."""
SHUT = 0.8
"""What the finger joints are told so as to close, radians."""
OPEN_WIDTH = 0.085
EMPTY = 0.001
"""What the fingers' joints say at most when they closed on nothing, metres: three of the steps in
which a Robotiq tells its opening. On a wall of 5 mm these fingers, which give, say 2 mm."""


@dataclass(frozen=True, slots=True)
class Slip:
    """The fingers give way for some time; what they hold falls if nothing else holds it.

    Attributes:
        start: When it begins, by the machine's clock, seconds.
        seconds: How long it lasts.
    """

    start: float
    seconds: float = 0.4

    def at(self, time: float) -> bool:
        """Whether it lasts now."""
        return self.start <= time < self.start + self.seconds


@dataclass(frozen=True, slots=True)
class Wheel:
    """One way in which the base drives: where its numbers stand in the model.

    Attributes:
        joint: In `qpos`.
        dof: In `qvel`.
        motor: In `ctrl`.
    """

    joint: int
    dof: int
    motor: int


def wheels_of(model: Any) -> tuple[Wheel, ...]:
    """The ways in which a model's base drives, ahead and to its left; none where it only turns."""
    there = {model.joint(i).name for i in range(model.njnt)}
    return tuple(
        Wheel(int(joint.qposadr[0]), int(joint.dofadr[0]), model.actuator(f"actuator_{name}").id)
        for name in WHEELS
        if f"joint_{name}" in there
        for joint in [model.joint(f"joint_{name}")]
    )


class Machine:
    """A simulated robot as its drives see it. Nothing here knows where things are.

    Args:
        model: The compiled scene.
        on_tick: Told after every `TICK`: for a film.

    Attributes:
        lock: Held while time passes; whoever looks from another thread takes it.
    """

    def __init__(self, model: Any, on_tick: Callable[[], None] | None = None):
        self._mj = mj = load_mujoco()
        self.model, self.data = model, mj.MjData(model)
        self.on_tick = on_tick
        self.lock = threading.RLock()
        self.slips: list[Slip] = []
        joints = [model.joint(name) for name in ARM_JOINTS]
        self.qpos = np.array([joint.qposadr[0] for joint in joints])
        self.dofs = np.array([joint.dofadr[0] for joint in joints])
        self._motors = np.array([model.actuator(f"arm_torq_j{i}").id for i in range(1, 7)])
        self._limits = model.actuator_ctrlrange[self._motors, 1]
        self._fingers = [model.actuator(f"arm_hand_finger_{i}").id for i in (1, 2)]
        self.closing = 0.0
        self._finger_qpos = [model.joint(name).qposadr[0] for name in FINGER_JOINTS]
        self._yaw_qpos = model.joint(YAW_JOINT).qposadr[0]
        self._turner = model.actuator("actuator_mobile_yaw").id
        self._wheels = wheels_of(model)
        self._inertia = np.zeros((model.nv, model.nv))
        self._of_arm = np.ravel_multi_index(np.ix_(self.dofs, self.dofs), self._inertia.shape)
        self._step, self._steps = model.opt.timestep, round(TICK / model.opt.timestep)
        self.yaw_target = 0.0
        self.place_target: tuple[float, float] | None = None
        self.reference = np.zeros(6)
        self.velocity = np.zeros(6)

    def begin(self, arm: Vector) -> None:
        """Stand with the arm so at time 0, and let things come to rest."""
        self.data.qpos[self.qpos] = arm
        self.hold()
        self._mj.mj_forward(self.model, self.data)

    @property
    def time(self) -> float:
        """Seconds of simulated time."""
        return float(self.data.time)

    @property
    def arm(self) -> Vector:
        """The arm's joints, radians."""
        return np.array(self.data.qpos[self.qpos])

    @property
    def speed(self) -> float:
        """Of the fastest joint, rad/s, or of the base's wheels, m/s."""
        moving = [*self.dofs, self.model.joint(YAW_JOINT).dofadr[0]]
        moving += [wheel.dof for wheel in self._wheels]
        return float(np.abs(self.data.qvel[moving]).max())

    @property
    def yaw(self) -> float:
        """How far the base has turned, radians."""
        return float(self.data.qpos[self._yaw_qpos])

    @property
    def drives(self) -> bool:
        """Whether the base drives, too."""
        return bool(self._wheels)

    @property
    def place(self) -> tuple[float, float]:
        """How far the base has driven ahead and to its left, metres, as if it had not turned."""
        if not self._wheels:
            return 0.0, 0.0
        ahead, aside = (float(self.data.qpos[wheel.joint]) for wheel in self._wheels)
        return ahead, aside

    @property
    def _rolling(self) -> float:
        return max((abs(float(self.data.qvel[wheel.dof])) for wheel in self._wheels), default=0.0)

    @property
    def width(self) -> float:
        """What the finger joints say of the gripper's opening, metres; below 0 they overlap."""
        closed = float(np.mean(self.data.qpos[self._finger_qpos]))
        return OPEN_WIDTH * (1 - closed / SHUT)

    def joints(self) -> Mapping[str, float]:
        """All joints that the robot reports."""
        found = dict(zip(ARM_JOINTS, map(float, self.arm), strict=True))
        if self.drives:
            found |= zip((f"joint_{wheel}" for wheel in WHEELS), self.place, strict=True)
        return found | {YAW_JOINT: self.yaw, "gripper": self.width}

    def hold(self) -> None:
        """Stand still where the arm and the base are; wheels brake, and stand where they end."""
        self.reference, self.velocity = self.arm, np.zeros(6)
        self.yaw_target, self.place_target = self.yaw, None

    def fingers(self, *, shut: bool) -> None:
        """Tell the fingers to close or to open; it takes them about half a second."""
        self.closing = SHUT if shut else 0.0

    def refresh(self) -> None:
        """Bring places, contacts and forces up to the state: a step leaves those of before it."""
        self._mj.mj_fwdPosition(self.model, self.data)
        self._mj.mj_fwdVelocity(self.model, self.data)

    def tick(self) -> None:
        """Let one `TICK` pass."""
        with self.lock:
            for _ in range(self._steps):
                self._drive()
                self._mj.mj_step(self.model, self.data)
            if self.place_target is None and self._rolling < STANDING:
                self.place_target = self.place
            self.refresh()
        if self.on_tick is not None:
            self.on_tick()

    def _drive(self) -> None:
        # Called at every step of physics, which takes 90 µs: so nothing is looked up anew here.
        data, arm = self.data, self.dofs
        self.reference = self.reference + self.velocity * self._step
        self._mj.mj_fullM(self.model, self._inertia, data.qM)
        error = self.reference - data.qpos[self.qpos]
        wanted = STIFFNESS * error + DAMPING * (self.velocity - data.qvel[arm])
        torque = self._inertia.take(self._of_arm) @ wanted
        torque += data.qfrc_bias[arm] - data.qfrc_passive[arm]
        np.minimum(np.maximum(torque, -self._limits, out=torque), self._limits, out=torque)
        ctrl = data.ctrl
        ctrl[self._motors] = torque
        turn = TURN_GAIN * (self.yaw_target - self.yaw)
        ctrl[self._turner] = min(max(turn, -TURNING), TURNING)
        for way, wheel in enumerate(self._wheels):
            target = self.place_target
            drive = 0.0 if target is None else DRIVE_GAIN * (target[way] - data.qpos[wheel.joint])
            ctrl[wheel.motor] = min(max(drive, -DRIVING), DRIVING)
        slips = bool(self.slips) and any(slip.at(self.time) for slip in self.slips)
        ctrl[self._fingers] = 0.0 if slips else self.closing
