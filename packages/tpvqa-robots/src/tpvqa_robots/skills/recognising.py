"""A robot that tells things by what they are, where colours do not tell them apart."""

from collections.abc import Callable, Collection

from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.methods import Method
from tpvqa_robots.skills.seeing import Seen, seen_as
from tpvqa_robots.skills.simulated import SimulatedRobot
from tpvqa_robots.toys.cameras import OVERHEAD, Cameras, Shot
from tpvqa_robots.toys.machine import Machine
from tpvqa_robots.toys.room import TABLE


class RecognisingRobot(SimulatedRobot):
    """The simulated robot with a recogniser.

    **One without errors stands in for it**: which pixels show a thing is taken from the simulation;
    how far away they are, and so where it is, from the camera with its errors.

    Args:
        machine: Its drives.
        cameras: Its eyes.
        things: What it can recognise: bodies and geoms of the room.
        bad_grasp: Tells whether a grasp of a thing is to go wrong: it is then made 8 cm beside.
        grasps: How grasps are found.
    """

    def __init__(
        self,
        machine: Machine,
        cameras: Cameras,
        *,
        things: Collection[str],
        bad_grasp: Callable[[str], bool] = lambda thing: False,
        grasps: Method = antipodal,
    ):
        super().__init__(machine, cameras, bad_grasp=bad_grasp, grasps=grasps)
        self._things = frozenset(things)

    def _knows(self, thing: str) -> bool:
        return thing in self._things

    def _seen(self, shot: Shot, thing: str) -> Seen | None:
        if not self._knows(thing):
            return None
        mask = self.cameras.mask_of(self.machine.data, OVERHEAD, thing)
        return seen_as(shot, mask, table=TABLE)
