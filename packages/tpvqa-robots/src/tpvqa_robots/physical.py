"""A world in which physics lets a robot's skills succeed or fail, and its own eyes see it."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import cached_property, partial
from threading import Event
from typing import Any

import numpy as np

from tpvqa.errors import WorldError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.plugins import PlainArguments
from tpvqa.worlds.capabilities import Noiseless
from tpvqa.worlds.outcome import Failure, Outcome
from tpvqa.worlds.protocol import Execution, Report
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.methods import Method
from tpvqa_robots.mishaps import Drawn, Mishaps
from tpvqa_robots.skills.simulated import SimulatedRobot
from tpvqa_robots.toys.cameras import CAMERAS, OVERHEAD, Cameras, Errors
from tpvqa_robots.toys.machine import Machine, Slip
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.truth import PhysicalTruth

Pixels = Callable[[], Mapping[str, int]]
DEADLINE = 60.0
"""Seconds of simulated time that a skill has where nobody says."""


class PhysicalWorld(Noiseless, PlainArguments, ABC):
    """A robot in a room of MuJoCo's. What stands in the room is said by who derives from this.

    Where things stand, the cameras' errors and the mishaps are functions of seed and episode.

    Args:
        task: What the trial is about.
        atoms: The facts of which is told whether they hold.
        mishaps: What is made to go wrong.
        grasps: How the robot finds grasps.
        seed: With `episode`, see `tpvqa.chance`.
        episode: The same.
        on_tick: Told after every 20 ms of simulated time: for a film.

    Raises:
        MissingExtraError: MuJoCo or robosuite is not installed.
        WorldError: There is no graphics library.
    """

    name = ""

    def __init__(
        self,
        task: Task,
        atoms: frozenset[Atom],
        *,
        mishaps: Mishaps,
        grasps: Method = antipodal,
        seed: int = 0,
        episode: int = 0,
        on_tick: Callable[[], None] | None = None,
    ):
        self._task, self._atoms, self._mishaps = task, atoms, mishaps
        self.grasps = grasps
        self.drawn = Drawn(self._mishaps, seed, episode)
        self._seed, self._episode, self._on_tick = seed, episode, on_tick
        self._before: State | None = None
        self._known: tuple[float, State] | None = None
        self.last_outcome: Outcome | None = None
        self.truth = PhysicalTruth(
            task, self._state, lambda: self._state() if self._before is None else self._before
        )
        self._closed = False

    @abstractmethod
    def room(self, seed: int, episode: int) -> Any:
        """The compiled model of the room with the robot in it."""

    @abstractmethod
    def robot_of(self, machine: Machine, cameras: Cameras) -> SimulatedRobot:
        """The robot with what it knows of this room."""

    @abstractmethod
    def true(self, machine: Machine, pixels: Pixels) -> State:
        """Those of the world's atoms that hold, by contacts and poses.

        Args:
            machine: The robot in its room.
            pixels: Tells how many pixels of the robot's camera show each body; that takes a while.
        """

    def beginning(self, action: Action) -> None:
        """Told before every action: here mishaps are set off."""

    def slip_after(self, seconds: float) -> None:
        """Have the fingers give way, so long after now."""
        machine = self.robot.machine
        machine.slips.append(Slip(machine.time + seconds))

    def check(self) -> None:
        """See whether MuJoCo, robosuite and a graphics library are there."""
        _ = self.robot

    @cached_property
    def robot(self) -> SimulatedRobot:
        """The robot, standing before its table; made when it is first needed."""
        if self._closed:
            raise WorldError(f"The world {self.name!r} is closed.")
        model = self.room(self._seed, self._episode)
        machine = Machine(model, self._on_tick)
        if self._mishaps.slip_at:
            machine.slips.append(Slip(self._mishaps.slip_at))
        errors = Errors().times(self._mishaps.noise, self._mishaps.calibration)
        cameras = Cameras(model, errors, seed=self._seed, episode=self._episode)
        robot = self.robot_of(machine, cameras)
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
        self.beginning(action)
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
            "place": machine.place_target,
            "reference": machine.reference.tolist(),
            "slips": [[slip.start, slip.seconds] for slip in machine.slips],
            "closing": machine.closing,
            "turns": self.drawn.turns,
            "grasps": dict(self.drawn.grasps),
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
        place = snapshot.get("place")
        machine.place_target = None if place is None else (place[0], place[1])
        machine.reference, machine.velocity = np.array(snapshot["reference"]), np.zeros(6)
        machine.closing = snapshot["closing"]
        machine.slips = [Slip(start, seconds) for start, seconds in snapshot["slips"]]
        self.drawn.turns, self.drawn.grasps = snapshot["turns"], dict(snapshot["grasps"])
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
            pixels = partial(cameras.pixels_of, machine.data, OVERHEAD)
            self._known = machine.time, self.true(machine, pixels)
        return self._known[1]


def _did(task: Task, after: State, action: Action) -> bool:
    """Whether what an action adds holds: what it was to end, as `found`, may go on."""
    return task.apply(after, action) - after == frozenset()
