"""Robosuite's door as a world."""

from typing import Any

from tpvqa.chance import chance
from tpvqa.pddl import Action, State, Task
from tpvqa_robots.door.robot import DoorRobot
from tpvqa_robots.door.scene import USUALLY, build
from tpvqa_robots.door.truth import KNOWN, true_state
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.physical import PhysicalWorld, Pixels
from tpvqa_robots.toys.cameras import Cameras
from tpvqa_robots.toys.machine import Machine
from tpvqa_robots.toys.things import Spot
from tpvqa_robots.truth import atoms_of, see_known

MOVED, TURNED = 0.01, 0.125
"""How far the door stands from where it usually does, metres and radians at most: robosuite's."""
SLIPS_AFTER = 0.6
"""Seconds after a motion begins at which the fingers give way, where they do."""


class DoorWorld(PhysicalWorld):
    """A door with a handle and a latch, closed, before the toys' robot.

    Args:
        task: One with the predicates of `open_door`.
        mishaps: What is made to go wrong.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
        WorldError: There is no graphics library, or the task is about something else.
    """

    name = "door"

    def __init__(
        self, task: Task, *, mishaps: Mishaps | None = None, seed: int = 0, episode: int = 0
    ):
        see_known(task, KNOWN, world=self.name, example="open_door")
        super().__init__(
            task, atoms_of(task, KNOWN), mishaps=mishaps or Mishaps(), seed=seed, episode=episode
        )

    @classmethod
    def from_spec(cls, arguments: str, *, task: Task, seed: int, episode: int) -> "DoorWorld":
        """The world of `door` or `door:slip=0.2:bad=0.1:noise=1`.

        Raises:
            PluginError: The words are not understood.
        """
        mishaps = Mishaps.read(arguments, cls.name) if arguments else None
        return cls(task, mishaps=mishaps, seed=seed, episode=episode)

    def room(self, seed: int, episode: int) -> Any:
        """The door, near where it usually stands."""
        drawn = chance(seed, episode, "spots")
        x, y = (v + drawn.uniform(-MOVED, MOVED) for v in USUALLY)
        return build(Spot(x, y, drawn.uniform(-TURNED, TURNED)))

    def robot_of(self, machine: Machine, cameras: Cameras) -> DoorRobot:
        """The robot, which knows the handle's measures."""
        return DoorRobot(machine, cameras, bad_grasp=self.drawn.is_bad)

    def true(self, machine: Machine, pixels: Pixels) -> State:
        """See `door.truth`."""
        return true_state(machine.model, machine.data, self._atoms)

    def beginning(self, action: Action) -> None:
        """The fingers may slip off while they turn or pull."""
        moves = action.name in ("turn_handle", "pull_open")
        if moves and self.robot.held is not None and self.drawn.slips():
            self.slip_after(SLIPS_AFTER)
