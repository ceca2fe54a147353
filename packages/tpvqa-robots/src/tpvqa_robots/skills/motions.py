"""Motions of the arm and the base that can be stopped at every tick."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from threading import Event

import numpy as np
from numpy.typing import NDArray

from tpvqa.worlds import Report
from tpvqa_robots.skills.driving import Stance
from tpvqa_robots.skills.kinematics import Grip, Kinematics
from tpvqa_robots.toys.machine import TICK, Machine

Vector = NDArray[np.float64]

JOINT_SPEED, TOOL_SPEED = 1.0, 0.30
"""Mean speeds of the fastest joint, rad/s, and of the gripper, m/s."""
LEAST = 0.3
"""Seconds that the shortest motion takes."""
SETTLE, FINGERS = 0.2, 0.8
"""Seconds that the arm is given to come to rest, and the fingers to close or open."""
ROUGHLY, PATIENCE = 0.01, 10.0
"""Metres or radians by which the base may miss its aim, and seconds that it has to get there."""
STOPPING = 0.2
"""Seconds within which the arm stands when it is told to stop."""


class Stopped(Exception):  # noqa: N818 — no error: what was wished for
    """A skill was told to stop, or its time was over.

    Args:
        report: CANCELLED or LATE.
    """

    def __init__(self, report: Report):
        super().__init__(report.value)
        self.report = report


class NotThereError(Exception):
    """The base does not get where it was sent."""


@dataclass(frozen=True, slots=True)
class Guard:
    """When a skill has to stop.

    Attributes:
        until: By the machine's clock, seconds.
        cancelled: Set from another thread.
    """

    until: float
    cancelled: Event


class Motions:
    """Moves a machine. Every motion ends early with `Stopped`, and then the arm stands still.

    Args:
        machine: The robot's drives.
        kinematics: Where its joints have to be.

    Attributes:
        halted: Set from another thread, it ends whatever motion there is, as a guard does.
    """

    def __init__(self, machine: Machine, kinematics: Kinematics):
        self._machine, self._kinematics = machine, kinematics
        self.halted = Event()

    @property
    def grip(self) -> Grip:
        """Where the gripper is, seen from the arm's foot."""
        return self._kinematics.grip(self._machine.arm)

    def line(self, wanted: Grip, guard: Guard) -> None:
        """Bring the gripper somewhere on a straight line.

        Raises:
            OutOfReachError: It cannot get there so; nothing was moved.
            Stopped: The skill has to stop.
        """
        here, arms = self.grip, self._kinematics.line(wanted, self._machine.reference)
        far = np.linalg.norm([wanted.x - here.x, wanted.y - here.y, wanted.z - here.z])
        self.follow(arms, guard, at_least=float(far) / TOOL_SPEED)

    def follow(self, arms: Sequence[Vector], guard: Guard, *, at_least: float = 0.0) -> None:
        """Have the joints go through these values, starting and ending gently."""
        steps = [float(np.abs(b - a).max()) for a, b in pairwise(arms)]
        passed = np.concatenate([[0.0], np.cumsum(steps)])
        if passed[-1] < 1e-6:
            return
        seconds = max(LEAST, at_least, passed[-1] / JOINT_SPEED) * 1.2
        path, machine = np.array(arms), self._machine
        for tick in range(1, int(np.ceil(seconds / TICK)) + 1):
            part = min(1.0, tick * TICK / seconds)
            way = passed[-1] * part * part * (3 - 2 * part)
            aim = np.array([np.interp(way, passed, path[:, joint]) for joint in range(6)])
            machine.velocity = (aim - machine.reference) / TICK
            self._tick(guard)
        machine.velocity = np.zeros(6)
        self.wait(SETTLE, guard)

    def turn(self, yaw: float, guard: Guard) -> None:
        """Turn the base, and wait until it stands.

        Raises:
            NotThereError: It does not turn so far.
            Stopped: The skill has to stop.
        """
        machine = self._machine
        machine.yaw_target = yaw
        self._until(lambda: abs(machine.yaw - yaw) <= ROUGHLY, "turn so far", guard)
        self.wait(SETTLE, guard)

    def drive(self, stance: Stance, guard: Guard) -> None:
        """Bring the base somewhere, then turn it, and wait until it stands.

        Raises:
            NotThereError: It does not get there.
            Stopped: The skill has to stop.
        """
        machine, there = self._machine, (stance.ahead, stance.aside)
        if machine.drives:
            machine.place_target = there
            self._until(lambda: _off(machine.place, there) <= ROUGHLY, "get there", guard)
        self.turn(stance.yaw, guard)

    def _until(self, reached: Callable[[], bool], what: str, guard: Guard) -> None:
        give_up = self._machine.time + PATIENCE
        while not reached():
            if self._machine.time >= give_up:
                self._machine.hold()
                raise NotThereError(f"the base does not {what} within {PATIENCE:g} s")
            self._tick(guard)

    def fingers(self, guard: Guard, *, shut: bool) -> None:
        """Close or open the fingers, and wait for them."""
        self._machine.fingers(shut=shut)
        self.wait(FINGERS, guard)

    def wait(self, seconds: float, guard: Guard | None = None) -> None:
        """Let time pass."""
        for _ in range(round(seconds / TICK)):
            self._tick(guard)

    def stop(self) -> None:
        """Stand still at once: the joints are held where they are."""
        self._machine.hold()
        self.wait(STOPPING)

    def _tick(self, guard: Guard | None) -> None:
        if guard is not None:
            if guard.cancelled.is_set() or self.halted.is_set():
                raise Stopped(Report.CANCELLED)
            if self._machine.time >= guard.until:
                raise Stopped(Report.LATE)
        self._machine.tick()


def _off(here: tuple[float, float], there: tuple[float, float]) -> float:
    return float(np.hypot(here[0] - there[0], here[1] - there[1]))


Told = Callable[[str], None]
"""Is told in words what a skill is about."""
