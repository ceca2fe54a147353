"""How often each thing is grasped and carried off: `python tools/grasp_table.py 50`.

Every try puts the thing somewhere else before the robot, by a seed, looks, and picks it up.
"""

import json
import sys
from threading import Event

import numpy as np

from tpvqa import Atom, load_task
from tpvqa.chance import chance
from tpvqa.tasks import find_task
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.toys.things import MOVABLE
from tpvqa_robots.world import ToysWorld


def tries(name: str, count: int, *, noise: float = 1.0) -> dict[str, object]:
    """Try one thing so often; how often it was in the hand in the end, and why not."""
    files = find_task("collect_toys")
    task = load_task(files.domain, files.problem)
    world = ToysWorld(task, mishaps=Mishaps(noise=noise), seed=900)
    robot, machine, held = world.robot, world.robot.machine, 0
    clean, why = world.snapshot(), {}
    joint = machine.model.body(name).jntadr[0]
    at = machine.model.jnt_qposadr[joint]
    for number in range(count):
        world.restore(clean)
        drawn = chance(900, number, "pose", name)
        yaw = drawn.uniform(-np.pi, np.pi)
        x, y = drawn.uniform(0.54, 0.68), drawn.uniform(-0.06, 0.14)
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
    return {"thing": name, "noise": noise, "tries": count, "held": held, "why not": why}


if __name__ == "__main__":
    for noise in (1.0, 3.0):
        for thing in MOVABLE:
            print(json.dumps(tries(thing, int(sys.argv[1]), noise=noise)), flush=True)
