"""Robosuite's bins as a world."""

from collections.abc import Mapping
from itertools import combinations
from typing import Any

import numpy as np

from tpvqa.chance import chance
from tpvqa.pddl import Action, State, Task
from tpvqa_robots.bins.robot import BinsRobot
from tpvqa_robots.bins.scene import AT, HALF, SOURCE, THINGS, build
from tpvqa_robots.bins.truth import KNOWN, true_state
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.methods import Method, said
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.physical import PhysicalWorld, Pixels
from tpvqa_robots.toys.cameras import Cameras
from tpvqa_robots.toys.machine import Machine
from tpvqa_robots.toys.things import Spot
from tpvqa_robots.truth import atoms_of, see_known

APART = 0.12
"""Between the middles of two things at first, at least, metres."""
FROM_WALL = 0.10
"""Between a thing's middle and a wall of the bin at first, at least: the hand is 15 cm wide."""


class BinsWorld(PhysicalWorld):
    """A big bin with milk, bread, cereal and a can, and four small ones, before the toys' robot.

    Args:
        task: One with the predicates of `sort_groceries`.
        mishaps: What is made to go wrong.
        grasps: How the robot finds grasps.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
        WorldError: There is no graphics library, or the task is about something else.
    """

    name = "bins"

    def __init__(
        self,
        task: Task,
        *,
        mishaps: Mishaps | None = None,
        grasps: Method = antipodal,
        seed: int = 0,
        episode: int = 0,
    ):
        see_known(task, KNOWN, world=self.name, example="sort_groceries")
        super().__init__(
            task,
            atoms_of(task, KNOWN),
            mishaps=mishaps or Mishaps(),
            grasps=grasps,
            seed=seed,
            episode=episode,
        )

    @classmethod
    def from_spec(cls, arguments: str, *, task: Task, seed: int, episode: int) -> "BinsWorld":
        """The world of `bins` or `bins:slip=0.2:bad=0.1:noise=1:grasps=ggcnn`.

        Raises:
            PluginError: The words are not understood.
        """
        grasps, words = said(arguments, cls.name)
        mishaps = Mishaps.read(words, cls.name) if words else None
        return cls(task, mishaps=mishaps, grasps=grasps, seed=seed, episode=episode)

    def room(self, seed: int, episode: int) -> Any:
        """The bins, with things anywhere in the big one."""
        return build(spots(seed, episode))

    def robot_of(self, machine: Machine, cameras: Cameras) -> BinsRobot:
        """The robot, which knows where the bins are."""
        return BinsRobot(
            machine,
            cameras,
            things=THINGS,
            bad_grasp=self.drawn.is_bad,
            grasps=self.grasps,
        )

    def true(self, machine: Machine, pixels: Pixels) -> State:
        """See `bins.truth`."""
        return true_state(machine.model, machine.data, self._atoms)

    def beginning(self, action: Action) -> None:
        """What is in the hand may slip on its way."""
        if action.name == "place" and self.robot.held is not None and self.drawn.slips():
            self.slip_after(0.5)


def spots(seed: int, episode: int) -> Mapping[str, Spot]:
    """Where the things stand at first: anywhere in the big bin, apart from each other."""
    drawn, (x, y) = chance(seed, episode, "spots"), AT[SOURCE]
    far = HALF[0] - FROM_WALL, HALF[1] - FROM_WALL
    while True:
        at = [
            (x + drawn.uniform(-far[0], far[0]), y + drawn.uniform(-far[1], far[1])) for _ in THINGS
        ]
        if all(np.hypot(a - c, b - d) >= APART for (a, b), (c, d) in combinations(at, 2)):
            turned = [drawn.uniform(-np.pi, np.pi) for _ in THINGS]
            return {n: Spot(*xy, yaw) for n, xy, yaw in zip(THINGS, at, turned, strict=True)}
