"""Whether a grasp holds, by physics: the hand comes down, closes, lifts and shakes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from tpvqa_robots.grasps.grasp import Grasp
from tpvqa_robots.grasps.training.bench import SLIDES, Bench
from tpvqa_robots.toys.machine import EMPTY, OPEN_WIDTH, SHUT
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.toys.scene import FINGER_JOINTS
from tpvqa_robots.truth import touched_by_both

BESIDE, TURNED = 0.003, 0.02
"""How far a hand is from where it was to be, metres along each axis and radians: as the robot
errs, most of it by where its camera is taken to be."""
CLEAR, HIGH = 0.015, 0.14
"""Metres over the things from which the hand comes down, and by which it lifts."""
STILL = 0.10
"""Metres that a thing must have come up in the end."""
STEPS = 10
"""Of physics between two commands."""


@dataclass(frozen=True, slots=True)
class Tried:
    """What came of a grasp.

    Attributes:
        held: Whether a thing was between both fingers in the end, and high enough.
        width: Between the fingers then, as their joints tell it, metres: some 6 mm too little.
    """

    held: bool
    width: float


class Trials:
    """Tries grasps on one bench, each from the same beginning.

    Args:
        bench: The table with its things.
        rng: Of the errors of each try.
    """

    def __init__(self, bench: Bench, rng: Generator):
        self._bench, self._rng = bench, rng
        mj, model = bench.mj, bench.model
        self._start = np.empty(mj.mj_stateSize(model, mj.mjtState.mjSTATE_INTEGRATION))
        mj.mj_getState(model, bench.data, self._start, mj.mjtState.mjSTATE_INTEGRATION)
        self._carriage = model.body("carriage").id
        self._motors = [model.actuator(name).id for name in SLIDES]
        self._lift = model.joint("lift").qposadr[0]
        self._fingers = [model.actuator(f"arm_hand_finger_{i}").id for i in (1, 2)]
        self._angles = [model.joint(name).qposadr[0] for name in FINGER_JOINTS]
        self._heights = {name: float(bench.data.body(name).xpos[2]) for name in bench.names}
        self._home = model.body_pos[self._carriage].copy(), model.body_quat[self._carriage].copy()

    def attempt(self, grasp: Grasp, top: float) -> Tried:
        """Try one grasp.

        Args:
            grasp: It; metres from the table's middle, z above the floor.
            top: Of the highest thing, metres above the table.
        """
        bench, rng = self._bench, self._rng
        mj, model, data = bench.mj, bench.model, bench.data
        mj.mj_setState(model, data, self._start, mj.mjtState.mjSTATE_INTEGRATION)
        off = rng.normal(0, BESIDE, 3)
        angle = grasp.angle + rng.normal(0, TURNED)
        z = max(grasp.z + 0.6 * off[2], TABLE + 0.017)
        model.body_pos[self._carriage] = grasp.x + off[0], grasp.y + off[1], z
        half = angle / 2
        model.body_quat[self._carriage] = 0, np.cos(half), np.sin(half), 0
        above = max(0.02, TABLE + top + CLEAR - z)
        data.qpos[self._lift] = above
        self._move(above, 0.0, seconds=0.1 + above / 0.5)
        self._move(0.0, 0.0, seconds=0.4, shut=True)
        self._move(0.0, HIGH, seconds=0.3, shut=True)
        if not any(touched_by_both(model, data, name) for name in bench.names):
            return Tried(False, 0.0)
        for sway in (0.03, -0.03, 0.0):
            data.ctrl[self._motors[:2]] = sway, -sway
            self._move(HIGH, HIGH, seconds=0.1, shut=True)
        held = [
            name
            for name in bench.names
            if touched_by_both(model, data, name)
            and data.body(name).xpos[2] > self._heights[name] + STILL
        ]
        closed = float(np.mean(data.qpos[self._angles]))
        width = OPEN_WIDTH * (1 - closed / SHUT)
        return Tried(bool(held) and width > EMPTY, max(0.0, width))

    def all_of(self, grasps: Sequence[Grasp], top: float) -> list[Tried]:
        """Try one after another."""
        found = [self.attempt(grasp, top) for grasp in grasps]
        bench = self._bench
        bench.model.body_pos[self._carriage], bench.model.body_quat[self._carriage] = self._home
        return found

    def _move(self, start: float, end: float, *, seconds: float, shut: bool = False) -> None:
        bench = self._bench
        data, step = bench.data, bench.model.opt.timestep
        data.ctrl[self._fingers] = SHUT if shut else 0.0
        count = max(1, round(seconds / step / STEPS))
        for number in range(1, count + 1):
            part = number / count
            data.ctrl[self._motors[2]] = start + (end - start) * part * part * (3 - 2 * part)
            bench.mj.mj_step(bench.model, data, nstep=STEPS)
