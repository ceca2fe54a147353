"""The toys' robot before a door: it grips the handle from above, turns it up and pulls."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from tpvqa_robots.door.lever import Lever, seen_lever, way
from tpvqa_robots.door.scene import BAR, DOOR, HANDLE, PANEL
from tpvqa_robots.skills.kinematics import APART, OutOfReachError
from tpvqa_robots.skills.motions import Guard, Told
from tpvqa_robots.skills.simulated import (
    ABOVE,
    CARRY,
    Held,
    SimulatedRobot,
    SkillError,
)
from tpvqa_robots.toys.cameras import OVERHEAD, Cameras
from tpvqa_robots.toys.machine import Machine

TURN, PULL = 1.5, 0.37
"""Radians by which the handle is turned up and the door pulled."""
FAR = 1.38
"""Radians at which the handle is turned far enough."""
AGAIN, MOST = 4, 2.2
"""How often the hand goes farther where it stays behind, and what it aims at at most, radians."""
SLOWLY = 0.15
"""Of the hand with the handle, m/s."""
PARTS = 4
"""Of a pull: after each is felt whether the door gives way."""
LAG = 0.1
"""Radians by which the door may stay behind."""
CLEAR = 0.06
"""Metres by which the hand goes up from the handle before it goes back."""
BACK = 0.30
"""Metres ahead of the foot to which the hand goes back before it comes down."""


class DoorRobot(SimulatedRobot):
    """It knows how long the handle is and where the hinge is to it; where the handle is it sees.

    A recogniser without errors stands in for one: which pixels show the handle is taken from the
    simulation; how far away they are from the camera.

    Args:
        machine: Its drives.
        cameras: Its eyes.
        bad_grasp: Tells whether a grasp is to go wrong: it is then made 8 cm beside.
    """

    def __init__(
        self,
        machine: Machine,
        cameras: Cameras,
        *,
        bad_grasp: Callable[[str], bool] = lambda thing: False,
    ):
        super().__init__(machine, cameras, bad_grasp=bad_grasp)
        self.lever: Lever | None = None
        self.aimed = (0.0, 0.0)
        self.shut_yaw: float | None = None
        self.skills = {
            "grasp_handle": self._grasp_handle,
            "turn_handle": self._turn_handle,
            "pull_open": self._pull_open,
            "let_go": self._let_go,
        }

    def snapshot(self) -> Mapping[str, Any]:
        """What the robot remembers, as JSON."""
        lever = None if self.lever is None else self.lever.numbers()
        more = {"lever": lever, "aimed": list(self.aimed), "shut_yaw": self.shut_yaw}
        return {**super().snapshot(), **more}

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        super().restore(snapshot)
        lever = snapshot["lever"]
        self.lever = None if lever is None else Lever(*lever)
        self.aimed = (snapshot["aimed"][0], snapshot["aimed"][1])
        self.shut_yaw = snapshot["shut_yaw"]

    def _grasp_handle(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        if args != (HANDLE,):
            raise SkillError(f"what {args[0]} looks like is not known")
        if self.closed_on_something:
            raise SkillError("something is in the hand already")
        self._retreat(guard)
        shot = self._shot()
        bar, panel = (self.cameras.mask_of(self.machine.data, OVERHEAD, n) for n in (BAR, PANEL))
        seen = seen_lever(shot.points[bar], shot.points[panel])
        if seen is None:
            raise SkillError(f"{HANDLE} is not in sight")
        lever, turned = seen
        if self.shut_yaw is None:
            self.shut_yaw = lever.yaw  # it begins before a door that is shut
        feedback(f"grasping {HANDLE}")
        aimed = lever.grip(turned)
        if self._bad_grasp(HANDLE):
            x, y = 0.08 * lever.along
            aimed = aimed.at(x=aimed.x + float(x), y=aimed.y + float(y))
        self._go(aimed.at(z=aimed.z + ABOVE), guard)
        self._go(aimed, guard)
        self._motions.fingers(guard, shut=True)
        self.shut = True
        if self.closed_on_something:
            self.held, self.lever, self.aimed = Held(HANDLE, (0.0, 0.0), 0.0), lever, (turned, 0.0)
        else:
            self._retreat(guard)
        return self._felt()

    def _turn_handle(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        lever = self._holding(args[0])
        feedback(f"turning {HANDLE}")
        aim, pulled = TURN, self.aimed[1]
        for _ in range(AGAIN):
            self._bring(lever, (aim, pulled), guard)
            turned, _ = lever.angles(self._motions.grip, pulled)
            if turned >= FAR or aim >= MOST or not self.closed_on_something:
                break
            aim = min(MOST, aim + TURN - turned)
        return self._felt()

    def _pull_open(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        if args[0] != DOOR:
            raise SkillError(f"how {args[0]} opens is not known")
        lever = self._holding(args[1])
        feedback(f"pulling {DOOR}")
        turned, start = self.aimed
        end = PULL - (lever.yaw - (lever.yaw if self.shut_yaw is None else self.shut_yaw))
        for pulled in np.linspace(start, max(start, end), PARTS + 1)[1:]:
            self._bring(lever, (turned, float(pulled)), guard)
            _, came = lever.angles(self._motions.grip, float(pulled))
            if pulled - came > LAG:
                self.machine.hold()
                raise SkillError(f"{DOOR} does not give way")
        return self._felt()

    def _let_go(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        feedback(f"letting go of {args[0]}")
        self._motions.fingers(guard, shut=False)
        self.shut, self.held, self.lever = False, None, None
        self._retreat(guard)
        return f"{args[0]} was let go"

    def _holding(self, thing: str) -> Lever:
        if not self.closed_on_something or self.lever is None or thing != HANDLE:
            raise SkillError(f"{thing} is not in the hand")
        return self.lever

    def _felt(self) -> str:
        return f"the fingers are {1000 * self.machine.width:.0f} mm apart"

    def _bring(self, lever: Lever, angles: tuple[float, float], guard: Guard) -> None:
        """Bring the handle and the door to these angles, radians; they may stay behind."""
        arms = [self.machine.reference]
        try:
            for grip in way(lever, self.aimed, angles):
                arms += self._kinematics.line(grip, arms[-1])[1:]
        except OutOfReachError as error:
            raise SkillError(f"out of reach: {error}") from error
        self._motions.follow(arms, guard, at_least=len(arms) * APART / SLOWLY)
        self.aimed = angles

    def _retreat(self, guard: Guard) -> None:
        """Up, back, and to where the arm carries; where it holds the handle it stays."""
        if self.closed_on_something:
            return
        if self.shut:
            self._motions.fingers(guard, shut=False)
            self.shut, self.held, self.lever = False, None, None
        here = self._motions.grip
        try:
            if np.hypot(here.x - CARRY.x, here.y - CARRY.y) > 0.02:
                high = max(here.z + CLEAR, CARRY.z)
                self._motions.line(here.at(z=high), guard)
                self._motions.line(CARRY.at(x=BACK, z=high), guard)
                self._motions.line(CARRY.at(x=BACK), guard)
            self._motions.line(CARRY, guard)
        except OutOfReachError:
            self._go_back(guard)
