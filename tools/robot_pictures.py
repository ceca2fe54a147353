"""Pictures of docs/robots.md, of door and scanned toys: `python tools/robot_pictures.py FOLDER`."""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from tpvqa import load_task
from tpvqa.tasks import find_task
from tpvqa_robots.door.world import DoorWorld
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.physical import PhysicalWorld
from tpvqa_robots.toys.mujoco import load_mujoco
from tpvqa_robots.toys.scans import SCANS
from tpvqa_robots.toys.scene import SPOTS, build
from tpvqa_robots.toys.things import Spot
from tpvqa_robots.world import ToysWorld

SHOWN: dict[str, tuple[float, float]] = {
    "toy_teddy": (0.56, -0.13),
    "toy_rubik": (0.66, 0.24),
    "toy_biplane": (0.62, -0.01),
    "toy_train": (0.58, 0.13),
    "toy_wood": (0.72, 0.09),
}


def drawn(model, data, lookat, distance, azimuth, elevation, size=(480, 480)):
    """What somebody sees who stands there."""
    mj = load_mujoco()
    camera, option = mj.MjvCamera(), mj.MjvOption()
    option.geomgroup[:] = [0, 1, 0, 0, 0, 0]
    option.sitegroup[:] = 0
    camera.lookat[:], camera.distance = lookat, distance
    camera.azimuth, camera.elevation = azimuth, elevation
    with mj.Renderer(model, *size) as canvas:
        canvas.update_scene(data, camera, option)
        return canvas.render().copy()


def of_world(world: PhysicalWorld, *where):
    """The same of a world, whose own canvas is closed meanwhile: two garble each other."""
    machine = world.robot.machine
    return drawn(machine.model, machine.data, *where)


def door() -> np.ndarray:
    """The door: gripped, turned, pulled open, let go."""
    files = find_task("open_door")
    task = load_task(files.domain, files.problem)
    world = DoorWorld(task, seed=1)
    acts = [
        ("grasp_handle", ("handle",)),
        ("turn_handle", ("handle",)),
        ("pull_open", ("door", "handle")),
        ("let_go", ("handle",)),
    ]
    kept = []
    for name, words in acts:
        world.execute(task.action(name, words))
        kept.append(world.snapshot())
    world.close()
    machine = world.robot.machine
    found = []
    for snapshot in kept:
        world.restore(snapshot)
        found.append(drawn(machine.model, machine.data, (0.55, 0.0, 1.04), 1.15, -52, -18))
    return np.concatenate(found, 1)


def toys() -> np.ndarray:
    """The five toys from near, and one in the hand."""
    spots = {name: Spot(*at, 0.5) for name, at in SHOWN.items()}
    spots |= {name: SPOTS[name] for name in ("blue_container", "cyan_container")}
    model = build(spots)
    data = load_mujoco().MjData(model)
    load_mujoco().mj_forward(model, data)
    names = [model.body(body).name for body in model.geom_bodyid]
    hidden = [geom for geom, name in enumerate(names) if name.startswith("arm")]
    model.geom_group[hidden] = 3
    table = drawn(model, data, (0.62, 0.05, 0.72), 0.75, -150, -32, (480, 960))
    files = find_task("collect_teddy")
    task = load_task(files.domain, files.problem)
    world = ToysWorld(task, mishaps=Mishaps(), seed=1)
    world.execute(task.action("find", ("toy_teddy", "table")))
    world.execute(task.action("pick_up", ("toy_teddy",)))
    held = world.robot.machine
    world.close()
    x, y, z = held.data.body("toy_teddy").xpos
    return np.concatenate([table, drawn(held.model, held.data, (x, y, z + 0.05), 0.6, 100, -12)], 1)


def main(folder: Path) -> None:
    """Make them."""
    assert set(SHOWN) == set(SCANS)
    for name, make in (("door", door), ("scanned-toys", toys)):
        Image.fromarray(make()).save(folder / f"{name}.jpg", quality=88)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
