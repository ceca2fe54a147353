"""The toys' robot before the bins: it turns to a bin by itself, and a recogniser tells things."""

import numpy as np

from tpvqa_robots.bins.scene import RIM, SOURCE, TARGETS
from tpvqa_robots.bins.truth import middle_of
from tpvqa_robots.skills.driving import AXIS
from tpvqa_robots.skills.motions import Guard, Told
from tpvqa_robots.skills.recognising import RecognisingRobot
from tpvqa_robots.skills.simulated import SkillError
from tpvqa_robots.toys.room import TABLE

BINS = (SOURCE, *TARGETS)


class BinsRobot(RecognisingRobot):
    """It knows where the bins are; where things are it sees. Colours do not tell them apart."""

    def _pick_up(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        thing, where = args
        feedback(f"turning to {where}")
        self._turn_to(where, guard)
        return super()._pick_up((thing,), guard, feedback)

    def _place(self, args: tuple[str, ...], guard: Guard, feedback: Told) -> str:
        feedback(f"turning to {args[1]}")
        self._turn_to(args[1], guard)
        return super()._place(args, guard, feedback)

    def _turn_to(self, where: str, guard: Guard) -> None:
        if where not in BINS:
            raise SkillError(f"where {where} is, is not known")
        self._retreat(guard)
        x, y = middle_of(where)
        self._motions.turn(float(np.arctan2(y, x - AXIS)), guard)

    def _target(self, where: str) -> tuple[float, float, float]:
        x, y = middle_of(where)
        c, s = np.cos(self.machine.yaw), np.sin(self.machine.yaw)
        ahead = x - AXIS
        return float(c * ahead + s * y + AXIS), float(c * y - s * ahead), TABLE + RIM / 4
