"""How often each thing is grasped and carried off, by both ways of finding grasps.

`python tools/grasp_table.py ROWS --tries 50 THING …`, from the folder of a clone; without names all
of the catalogue and of the toys' table. Every try puts the thing somewhere else before the robot,
as it lies after a fall, by a seed; the robot looks, and picks it up. Both ways meet the same
tables. A row is written for each 50 tries of a thing, way and noise, those of all things before the
next 50; a try depends on its number alone, and what is in the file already is not tried again.
`--show` prints the table.
"""

import argparse
import json
from functools import cache
from itertools import product
from pathlib import Path
from threading import Event

import numpy as np

from tpvqa import Atom, load_task
from tpvqa.chance import chance, chance_array
from tpvqa.tasks import find_task
from tpvqa_robots.grasps.methods import METHODS
from tpvqa_robots.grasps.training.bench import Bench
from tpvqa_robots.grasps.training.catalogue import HELD_OUT, TAUGHT, named
from tpvqa_robots.grasps.training.solids import Thing, add
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.skills.motions import Guard
from tpvqa_robots.skills.seeing import seen_as
from tpvqa_robots.skills.simulated import SimulatedRobot, SkillError
from tpvqa_robots.toys.cameras import OVERHEAD, Cameras, Errors
from tpvqa_robots.toys.machine import Machine
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.room import TABLE, furnished
from tpvqa_robots.toys.scene import with_robot
from tpvqa_robots.toys.things import MOVABLE
from tpvqa_robots.truth import touched_by_both
from tpvqa_robots.world import ToysWorld

SEED = 900
BLOCK = 50
"""Tries in a row."""
NAME = "thing"
_TABLE = """
  <geom name="table" type="box" pos=".78 0 -.02" size=".31 .85 .02" group="1"
    friction="1 .02 .003" condim="4"/>
"""


class OneThing(SimulatedRobot):
    """The robot before a table with one thing. A recogniser without errors tells its pixels."""

    def _seen(self, shot, thing):
        mask = self.cameras.mask_of(self.machine.data, OVERHEAD, thing)
        return seen_as(shot, mask, table=TABLE)


def where(name: str, number: int) -> tuple[float, float, float]:
    """Where a try puts its thing: x, y, and how it is turned."""
    drawn = chance(SEED, number, "pose", name)
    yaw = drawn.uniform(-np.pi, np.pi)
    return drawn.uniform(0.54, 0.68), drawn.uniform(-0.06, 0.14), yaw


def of_a_thing(name: str, method: str, numbers: range, noise: float) -> dict[str, object]:
    """Make these tries of one thing of the catalogue."""
    thing = of_catalogue(name)
    room = furnished("one thing", assets="", table=_TABLE)
    add(load_mujoco(), room, thing, NAME, (0.6, 0.0, TABLE + 0.05), (1, 0, 0, 0))
    model = with_robot(room)
    model.vis.quality.shadowsize = 0  # half the time; only colours, which are not looked at, change
    machine = Machine(model)
    errors = Errors().times(noise)
    at = model.jnt_qposadr[model.body(NAME).jntadr[0]]
    cameras = Cameras(model, errors, seed=SEED, episode=0)
    robot = OneThing(machine, cameras, grasps=METHODS[method])
    robot.begin()
    arm, data = machine.arm, machine.data
    held, why = 0, {}
    for number in numbers:
        x, y, yaw = where(name, number)
        z, quat = lying(name, number)
        load_mujoco().mj_resetData(model, data)
        turned = np.empty(4)
        load_mujoco().mju_mulQuat(turned, np.array([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]), quat)
        data.qpos[at : at + 7] = x, y, z, *turned
        machine.closing = 0.0
        machine.velocity[:] = 0
        cameras.draw(SEED, number)
        robot.restore({"held": None, "shut": False, "shots": number})
        machine.begin(arm)
        for _ in range(15):
            machine.tick()
        said = "lost or missed"
        try:
            robot._pick_up((NAME,), Guard(60.0, Event()), lambda words: None)
        except SkillError as error:
            said = str(error).partition(":")[0]
        if touched_by_both(model, data, NAME) and robot.closed_on_something:
            held += 1
        else:
            why[said] = why.get(said, 0) + 1
    cameras.close()
    taught = "never seen" if name in HELD_OUT else "taught it"
    return _row(name, taught, method, noise, numbers, held, why)


@cache
def of_catalogue(name: str) -> Thing:
    """A thing of the catalogue, of one size."""
    return named(name, chance_array(SEED, 0, "thing", name))


@cache
def lying(name: str, number: int) -> tuple[float, np.ndarray]:
    """How a thing lies after the fall of a try: its height above the floor, and a quaternion."""
    thing = of_catalogue(name)
    for again in range(20):
        bench = Bench([thing], chance_array(SEED, number, "fall", thing.name, again))
        if bench.settled:
            break
    pose = bench.data.qpos[bench.model.jnt_qposadr[bench.model.body("thing_0").jntadr[0]] :][:7]
    return float(pose[2]) + 0.002, pose[3:7].copy()


def of_a_toy(name: str, method: str, numbers: range, noise: float) -> dict[str, object]:
    """Make these tries of one thing of the toys' table."""
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    world = ToysWorld(task, mishaps=Mishaps(noise=noise), grasps=METHODS[method], seed=SEED)
    robot, machine, held = world.robot, world.robot.machine, 0
    clean, why = world.snapshot(), {}
    joint = machine.model.body(name).jntadr[0]
    at = machine.model.jnt_qposadr[joint]
    for number in numbers:
        world.restore(clean)
        x, y, yaw = where(name, number)
        turned = [np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]
        machine.data.qpos[at : at + 7] = x, y, TABLE + 0.002, *turned
        for _ in range(20):
            machine.tick()
        action = task.action("pick_up", (name,))
        done = robot.perform(action, deadline=60, cancelled=Event(), feedback=lambda said: None)
        world._known = None
        if world.truth.holds(Atom("in_hand", (name,))):
            held += 1
        else:
            said = done.message.partition(":")[0] if done.report != "done" else "lost or missed"
            why[said] = why.get(said, 0) + 1
    world.close()
    return _row(name, "never seen", method, noise, numbers, held, why)


def _row(name, taught, method, noise, numbers, held, why) -> dict[str, object]:
    return {
        "thing": name,
        "network": taught,
        "grasps": method,
        "noise": noise,
        "seed": SEED,
        "first": numbers.start,
        "tries": len(numbers),
        "held": held,
        "why not": why,
    }


def main() -> None:
    """The command."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("rows", type=Path)
    words.add_argument("things", nargs="*", default=[*MOVABLE, *TAUGHT, *HELD_OUT])
    words.add_argument("--tries", type=int, default=50)
    words.add_argument("--noise", type=float, default=1.0)
    words.add_argument("--grasps", nargs="*", default=list(METHODS))
    words.add_argument("--show", action="store_true")
    said = words.parse_args()
    if said.show:
        show(said.rows)
        return
    blocks = [range(i, min(i + BLOCK, said.tries)) for i in range(0, said.tries, BLOCK)]
    for numbers, thing, method in product(blocks, said.things, said.grasps):
        if (thing, method, said.noise, numbers.start) in _known(said.rows):
            continue
        tried = of_a_toy if thing in MOVABLE else of_a_thing
        row = tried(thing, method, numbers, said.noise)
        with said.rows.open("a") as rows:
            print(json.dumps(row), file=rows, flush=True)
        print(json.dumps(row), flush=True)


def show(file: Path) -> None:
    """Print the rows as a table, with intervals of Wilson's."""
    rows = list(map(json.loads, file.read_text().splitlines()))
    print("| thing | network | errors | " + " | ".join(METHODS) + " |\n|---|---|---|---|---|")
    keys = dict.fromkeys((row["thing"], row["network"], row["noise"]) for row in rows)
    for key in sorted(keys, key=lambda key: key[1], reverse=True):
        own = [row for row in rows if (row["thing"], row["network"], row["noise"]) == key]
        print(f"| {key[0]} | {key[1]} | {key[2]:g} | {' | '.join(_cells(own))} |")
    for taught in ("taught it", "never seen"):
        own = [row for row in rows if row["network"] == taught and row["noise"] == 1]
        both = {m: {row["thing"] for row in own if row["grasps"] == m} for m in METHODS}
        own = [row for row in own if all(row["thing"] in things for things in both.values())]
        print(f"| all | {taught} | 1 | {' | '.join(_cells(own))} |")


def wilson(held: int, tries: int) -> tuple[float, float]:
    """The 95% score interval of a rate (Wilson 1927); that of `tpvqa.bench` needs scipy."""
    z, rate = 1.959964, held / tries
    middle = rate + z * z / 2 / tries
    half = z * np.sqrt(rate * (1 - rate) / tries + (z / 2 / tries) ** 2)
    return tuple(float(v) / (1 + z * z / tries) for v in (max(0.0, middle - half), middle + half))


def _cells(rows: list[dict]) -> list[str]:
    cells = []
    for method in METHODS:
        own = [row for row in rows if row["grasps"] == method]
        held, tries = sum(row["held"] for row in own), sum(row["tries"] for row in own)
        if not tries:
            cells.append("–")
            continue
        low, high = wilson(held, tries)
        cells.append(f"{held} of {tries} ({low:.2f} to {high:.2f})")
    return cells


def _known(file: Path) -> set[tuple[object, ...]]:
    if not file.exists():
        return set()
    rows = map(json.loads, file.read_text().splitlines())
    return {(row["thing"], row["grasps"], row["noise"], row.get("first", 0)) for row in rows}


if __name__ == "__main__":
    main()
