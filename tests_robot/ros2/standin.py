"""A kinematic stand-in of a robot, as a skill server in a process of its own.

Things are where the last skill put them; nothing is simulated but time. Faults are switched on by
words on the command line.
"""

import argparse
import json
import signal
import threading
import time
from collections.abc import Callable, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tpvqa import Atom, load_task
from tpvqa.observation import Depth, Frame, Intrinsics, Observation, SensedFact
from tpvqa.pddl import Action, State, Task
from tpvqa.tasks import find_task
from tpvqa.worlds import Execution, Report

HAND_EMPTY = Atom("hand_empty")


class StandIn:
    """A robot that is wherever its skills say, and keeps that in a file as the world does."""

    def __init__(self, task: Task, file: Path, faults: set[str], seconds: float):
        self.task, self.file, self.faults, self.seconds = task, file, faults, seconds
        self.skills: Mapping[str, Any] = {"find": 1, "pick_up": 1, "place": 1}
        self.moving = 0.0
        self._rng = np.random.default_rng()
        self._frozen: Observation | None = None
        if not file.exists():
            self._write(task.init, [])

    def _read(self) -> tuple[State, list[Any]]:
        said = json.loads(self.file.read_text())
        return frozenset(Atom.parse(text) for text in said["facts"]), said["done"]

    def _write(self, state: State, done: list[Any]) -> None:
        text = json.dumps({"facts": sorted(atom.pddl() for atom in state), "done": done})
        half = self.file.with_suffix(".half")
        half.write_text(text)
        half.replace(self.file)

    def true(self) -> State:
        return self._read()[0]

    def perform(
        self,
        action: Action,
        *,
        deadline: float,
        cancelled: threading.Event,
        feedback: Callable[[str], None],
    ) -> Execution:
        began = time.monotonic()
        state, done = self._read()
        self._write(state, [*done, [action.pddl(), "begins", time.time()]])
        feedback("moves")
        if "breaks" in self.faults:
            self.faults.discard("breaks")
            raise OSError("the gripper does not answer")
        endless = "endless" in self.faults
        while endless or time.monotonic() - began < self.seconds:
            self.moving = time.time()
            if cancelled.is_set() and "deaf" not in self.faults:
                state, done = self._read()
                self._write(state, [*done, [action.pddl(), "stood", time.time()]])
                return Execution(Report.CANCELLED, time.monotonic() - began, "stopped")
            time.sleep(0.01)
        state, done = self._read()
        if self.task.applicable(state, action):
            state = self.task.apply(state, action)
        self._write(state, [*done, [action.pddl(), "ended", time.time()]])
        sure = 0.98 if HAND_EMPTY in state else 0.02
        facts = (SensedFact(HAND_EMPTY, sure),)
        return Execution(Report.DONE, time.monotonic() - began, "", facts)

    def look(self, view: str) -> Observation:
        if "frozen" in self.faults and self._frozen is not None:
            return self._frozen
        if "unplugged" in self.faults and self._read()[1]:
            raise OSError("the camera is unplugged")
        file = BytesIO()
        noise = self._rng.integers(0, 255, (24, 32, 3), dtype=np.uint8)
        Image.fromarray(noise).save(file, "png")
        frame = Frame(
            view,
            view,
            file.getvalue(),
            "image/png",
            intrinsics=Intrinsics(30.0, 30.0, 15.5, 11.5, 32, 24),
            depth=Depth.from_metres(np.full((24, 32), 1.25)),
        )
        self._frozen = Observation(frames={view: frame})
        return self._frozen

    def stop(self) -> None:
        """It stands as soon as `perform` sees that it is cancelled."""

    def state(self) -> Mapping[str, float]:
        return {"shoulder": self.moving, "gripper": 0.0 if HAND_EMPTY in self.true() else 0.02}


def main() -> None:
    from tpvqa_robots.ros2.server import SkillServer

    parser = argparse.ArgumentParser()
    parser.add_argument("file", type=Path)
    parser.add_argument("--fault", action="append", default=[])
    parser.add_argument("--seconds", type=float, default=0.05)
    parser.add_argument("--managed", action="store_true")
    parser.add_argument("--sim-time", action="store_true")
    said = parser.parse_args()
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    faults = set(said.fault)
    robot = StandIn(task, said.file, faults, said.seconds)
    views = () if "blind" in faults else ("overhead",)
    more = {"managed": said.managed, "sim_time": said.sim_time}
    server = SkillServer(robot, task, views, rate=20.0, truth=robot.true, **more)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: server.close())
    print("ready", flush=True)
    server.run()


if __name__ == "__main__":
    main()
