"""The live kitchen as a world: a true state that skills change, drawn as the robot sees it."""

from collections.abc import Mapping, Sequence
from io import BytesIO
from threading import Event
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import PluginError, UnknownNameError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Atom
from tpvqa.plugins import PlainArguments
from tpvqa.worlds.capabilities import Simulated
from tpvqa.worlds.outcome import Outcome
from tpvqa.worlds.protocol import Execution, Report
from tpvqa.worlds.simulation import SimulatedTruth, Simulation
from tpvqa_household.kitchen.household import Household
from tpvqa_household.kitchen.layout import Split
from tpvqa_household.kitchen.rotation import matrix, quaternion
from tpvqa_household.kitchen.scene import VIEWS, KitchenScene
from tpvqa_household.kitchen.spots import Pose
from tpvqa_household.kitchen.truth import Shown

QUALITY = 92
"""Of the JPEG pictures."""
KITCHENS = 10**10
"""The first kitchen; those before it are for training and for the shipped pictures."""
MOVING = 1.0
"""Seconds that a skill takes by the world's clock."""


class KitchenWorld(Simulated, PlainArguments):
    """A random kitchen that is drawn as the robot sees it and in which dropped things fall.

    The kitchen is a function of the simulation's seed and episode. Things stay where they are
    from look to look until the true state moves them.

    Args:
        simulation: The true state and its faults.
        split: "train" for meshes, grippers and layouts like those that the embedded network was
            trained on, in kitchens that it never saw; "held_out" for others.
        size: Height and width of the pictures, pixels.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        WorldError: There is no graphics library to draw with, or the task is not the household.
    """

    def __init__(self, simulation: Simulation, *, split: Split = "train", size: int = 224):
        Household.read(simulation.state)
        self.simulation = simulation
        self.truth = SimulatedTruth(simulation, self._visible)
        self.last_outcome: Outcome | None = None
        kitchen = KITCHENS + simulation.seed * 10_000 + simulation.episode
        self.scene = KitchenScene(seed=kitchen, split=split, size=size)
        self._look = 0
        self._time = 0.0
        self._fallen: dict[str, Pose] = {}
        self._shown: Mapping[Atom, Shown] = {}

    @classmethod
    def from_spec(cls, arguments: str, *, simulation: Simulation) -> "KitchenWorld":
        """The world that a specification names: `kitchen` or `kitchen:held_out`.

        Raises:
            PluginError: The word after the colon is neither known nor held_out.
        """
        splits: dict[str, Split] = {"": "train", "known": "train", "held_out": "held_out"}
        if arguments not in splits:
            raise PluginError(
                f"The world 'kitchen' knows the words known and held_out, not {arguments!r}. "
                "Write kitchen, kitchen:known or kitchen:held_out."
            )
        return cls(simulation, split=splits[arguments])

    def views(self) -> Sequence[str]:
        """From before the robot, leaning to either side, and from a corner of the room."""
        return VIEWS

    def observe(self, view: str | None = None) -> Observation:
        """Look; every call is a new look with another pose of head and hands.

        Raises:
            UnknownNameError: There is no such view.
        """
        view = VIEWS[0] if view is None else view
        if view not in VIEWS:
            raise UnknownNameError("view", view, VIEWS)
        look, self._look = self._look, self._look + 1
        self._arrange(look, view)
        pixels = self.scene.render()
        self._shown = self.scene.shown()
        frame = Frame(id=view, view=view, data=_jpeg(pixels), source="kitchen")
        return Observation(
            time=self._time,
            frames={view: frame},
            detail={"kitchen": self.scene.seed, "split": self.scene.split},
            facts=self.simulation.sensed(),
        )

    def senses(self) -> frozenset[str]:
        """The predicates that the world file says are sensed."""
        return self.simulation.senses()

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Run a skill. What it does, and what goes wrong, is the simulation's to decide.

        A skill that is cancelled or late before it has begun changes nothing; once it has begun
        its outcome stands, and what fell comes to rest.
        """
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0, "cancelled before it began")
        if deadline is not None and deadline < MOVING:
            return Execution(Report.LATE, 0.0, f"a skill takes {MOVING:g} s")
        attempt = self.simulation.attempts[action.pddl()]
        before = Household.read(self.simulation.state)
        self.last_outcome = self.simulation.execute(action)
        after = Household.read(self.simulation.state)
        for item, place in after.where.items():
            if place == "floor" and before.where.get(item) != "floor":
                self._fallen[item] = self.scene.drop(
                    item, at=self.scene.robot, key=(action.pddl(), attempt)
                )
        for item in list(self._fallen):
            if after.where.get(item) != "floor":
                del self._fallen[item]
        self._time += MOVING
        return self.last_outcome.execution(MOVING)

    def snapshot(self) -> Mapping[str, Any]:
        """The true state, the number of looks, where the robot stands, and how what fell lies."""
        return {
            "look": self._look,
            "time": self._time,
            "robot": self.scene.robot.tolist(),
            "fallen": {
                item: [*pose.position.tolist(), *quaternion(pose.axes).tolist()]
                for item, pose in self._fallen.items()
            },
            "simulation": self.simulation.snapshot(),
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        self._look, self._time = snapshot["look"], snapshot["time"]
        self.scene.model.cam_pos[:] = snapshot["robot"]
        self._fallen = {
            item: Pose(np.array(numbers[:3]), matrix(numbers[3:]))
            for item, numbers in snapshot["fallen"].items()
        }
        self.simulation.restore(snapshot["simulation"])
        self._shown = {}

    def close(self) -> None:
        """Free the canvas. Can be called twice."""
        self.scene.close()

    def _arrange(self, look: int, view: str) -> None:
        self.scene.arrange(
            self.simulation.state,
            look=look,
            view=view,
            placement="live",
            fixed=self._fallen,
            steady=True,
        )

    def _visible(self, atom: Atom) -> bool:
        found = self._shown.get(atom)
        return found is not None and found.visible


def _jpeg(pixels: NDArray[np.uint8]) -> bytes:
    from PIL import Image

    out = BytesIO()
    Image.fromarray(pixels).save(out, "jpeg", quality=QUALITY)
    return out.getvalue()
