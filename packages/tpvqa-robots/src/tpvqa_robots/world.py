"""The toys' table as a world: physics lets skills succeed or fail, and the robot's eyes see it."""

from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property
from threading import Event
from typing import Any

import numpy as np

from tpvqa.chance import chance
from tpvqa.errors import WorldError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, State, Task
from tpvqa.plugins import PlainArguments
from tpvqa.worlds.capabilities import Noiseless
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.protocol import Execution, Report
from tpvqa_robots.mishaps import Drawn, Mishaps
from tpvqa_robots.skills.simulated import SimulatedRobot
from tpvqa_robots.toys.cameras import CAMERAS, OVERHEAD, Cameras, Errors
from tpvqa_robots.toys.machine import Machine, Slip
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.scene import SPOTS, build
from tpvqa_robots.toys.things import Spot
from tpvqa_robots.toys.truth import CONTAINERS, ToysTruth, atoms_of, see_known, true_state

DEADLINE = 60.0
"""Seconds of simulated time that a skill has where nobody says."""
SLIPS_AFTER = 0.25
"""Seconds after a turn begins at which the fingers give way, where they do."""
MOVED, TURNED = 0.02, 0.4
"""How far things stand from where they usually do, metres and radians at most."""


class ToysWorld(Noiseless, PlainArguments):
    """A table with toys, two containers and a goal area, before a robot on a base that turns.

    Where things stand, the cameras' errors and the mishaps are functions of seed and episode.

    Args:
        task: One with the predicates of `collect_toys`.
        mishaps: What is made to go wrong.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.
        on_tick: Told after every 20 ms of simulated time: for a film.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
        WorldError: There is no graphics library, or the task is about something else.
    """

    def __init__(
        self,
        task: Task,
        *,
        mishaps: Mishaps | None = None,
        seed: int = 0,
        episode: int = 0,
        on_tick: Callable[["ToysWorld"], None] | None = None,
    ):
        see_known(task)
        self._task, self._atoms = task, atoms_of(task)
        self._mishaps = Mishaps(appendix=True) if mishaps is None else mishaps
        self._drawn = Drawn(self._mishaps, seed, episode)
        self._seed, self._episode, self._on_tick = seed, episode, on_tick
        self._before: State | None = None
        self._known: tuple[float, State] | None = None
        self.last_outcome: Outcome | None = None
        self.truth = ToysTruth(
            task, self._state, lambda: self._state() if self._before is None else self._before
        )
        self._closed = False

    @classmethod
    def from_spec(cls, arguments: str, *, task: Task, seed: int, episode: int) -> "ToysWorld":
        """The world of `toys`, `toys:appendix` or `toys:slip=0.2:bad=0.1:noise=1`.

        Raises:
            PluginError: The words are not understood.
        """
        return cls(task, mishaps=Mishaps.read(arguments), seed=seed, episode=episode)

    def check(self) -> None:
        """See whether MuJoCo, robosuite and a graphics library are there."""
        _ = self.robot

    @cached_property
    def robot(self) -> SimulatedRobot:
        """The robot, standing before its table; made when it is first needed."""
        if self._closed:
            raise WorldError("The world 'toys' is closed.")
        model = build(_spots(self._seed, self._episode))
        errors = Errors().times(self._mishaps.noise)
        on_tick = self._on_tick
        machine = Machine(model, None if on_tick is None else lambda: on_tick(self))
        cameras = Cameras(model, errors, seed=self._seed, episode=self._episode)
        robot = SimulatedRobot(machine, cameras, bad_grasp=self._drawn.is_bad)
        robot.begin()
        return robot

    def views(self) -> Sequence[str]:
        """The camera above the robot, and that at its wrist."""
        return tuple(CAMERAS)

    def observe(self, view: str | None = None) -> Observation:
        """Look with one of the robot's cameras.

        Raises:
            UnknownNameError: It has no such camera.
        """
        return self.robot.look(OVERHEAD if view is None else view)

    def senses(self) -> Collection[str]:
        """The gripper tells whether the hand is empty."""
        return ("hand_empty",)

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Event | None = None
    ) -> Execution:
        """Run the robot's skill of that name; seconds are of simulated time."""
        if cancel is not None and cancel.is_set():
            return Execution(Report.CANCELLED, 0.0, "cancelled before it began")
        robot, before = self.robot, self._state()
        self._before = before
        held = robot.held if action.name == "find" else None
        if held is not None and held.thing in CONTAINERS and self._drawn.slips():
            robot.machine.slips.append(Slip(robot.machine.time + SLIPS_AFTER))
        done = robot.perform(
            action,
            deadline=DEADLINE if deadline is None else deadline,
            cancelled=Event() if cancel is None else cancel,
            feedback=lambda said: None,
        )
        self._known = None
        after, failure = self._state(), None
        if not _did(self._task, after, action):
            able = self._task.applicable(before, action)
            failure = Failure.CHANCE if able else Failure.PRECONDITION
        self.last_outcome = Outcome(
            failure=failure,
            undone=None,
            undoing="",
            before=before,
            after=after,
            reported=done.report is not Report.DONE,
            sensed=tuple(done.facts),
        )
        return done

    def snapshot(self) -> Mapping[str, Any]:
        """The whole state of physics and of the robot, as numbers."""
        mj, machine = load_mujoco(), self.robot.machine
        numbers = np.empty(mj.mj_stateSize(machine.model, mj.mjtState.mjSTATE_INTEGRATION))
        mj.mj_getState(machine.model, machine.data, numbers, mj.mjtState.mjSTATE_INTEGRATION)
        return {
            "physics": numbers.tolist(),
            "yaw": machine.yaw_target,
            "reference": machine.reference.tolist(),
            "slips": [[slip.start, slip.seconds] for slip in machine.slips],
            "closing": machine.closing,
            "turns": self._drawn.turns,
            "grasps": dict(self._drawn.grasps),
            "robot": dict(self.robot.snapshot()),
            "before": None if self._before is None else sorted(a.pddl() for a in self._before),
        }

    def restore(self, snapshot: Mapping[str, Any]) -> None:
        """Put back what `snapshot` gave."""
        mj, machine = load_mujoco(), self.robot.machine
        numbers = np.array(snapshot["physics"])
        mj.mj_setState(machine.model, machine.data, numbers, mj.mjtState.mjSTATE_INTEGRATION)
        machine.refresh()
        machine.yaw_target = snapshot["yaw"]
        machine.reference, machine.velocity = np.array(snapshot["reference"]), np.zeros(6)
        machine.closing = snapshot["closing"]
        machine.slips = [Slip(start, seconds) for start, seconds in snapshot["slips"]]
        self._drawn.turns, self._drawn.grasps = snapshot["turns"], dict(snapshot["grasps"])
        self.robot.restore(snapshot["robot"])
        named = {atom.pddl(): atom for atom in self._atoms}
        before = snapshot["before"]
        self._before = None if before is None else frozenset(named[text] for text in before)
        self._known = None

    def close(self) -> None:
        """Free the canvas. Can be called twice."""
        if "robot" in self.__dict__:
            self.robot.cameras.close()
        self._closed = True

    def _state(self) -> State:
        machine, cameras = self.robot.machine, self.robot.cameras
        if self._known is None or self._known[0] != machine.time:
            pixels = cameras.pixels_of(machine.data, OVERHEAD)
            found = true_state(machine.model, machine.data, pixels, self._atoms)
            self._known = machine.time, found
        return self._known[1]


def _did(task: Task, after: State, action: Action) -> bool:
    """Whether what an action adds holds: what it was to end, as `found`, may go on."""
    return task.apply(after, action) - after == frozenset()


def _spots(seed: int, episode: int) -> Mapping[str, Spot]:
    drawn = chance(seed, episode, "spots")
    found = {}
    for name, spot in SPOTS.items():
        x, y = (v + drawn.uniform(-MOVED, MOVED) for v in (spot.x, spot.y))
        found[name] = Spot(x, y, spot.yaw + drawn.uniform(-TURNED, TURNED))
    return found
