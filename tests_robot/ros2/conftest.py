"""Skill servers in processes of their own, in a DDS domain that no other test uses."""

import fcntl
import os
import random
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from tpvqa import Task
from tpvqa_robots.ros2.link import Link
from tpvqa_robots.ros2.setup import load_setup
from tpvqa_robots.ros2.world import Ros2World

SETUP = """\
skills:
  find: {server: /tpvqa, deadline: 10}
  pick_up: {server: /tpvqa, deadline: 10}
  place: {server: /tpvqa, deadline: 10}
cameras:
  overhead: {image: /tpvqa/overhead/image, depth: /tpvqa/overhead/depth,
             info: /tpvqa/overhead/camera_info, frame_id: overhead}
joints: /tpvqa/joints
sensed:
  - {fact: (hand_empty), joint: gripper, below: 0.003, sure: 0.98}
stop: /tpvqa/stop
truth: /tpvqa/truth
limits: {age: 1.0, wait: 8, gone: 1.5, grace: 0.5}
workspace:
  low: [-1, -1, 0]
  high: [1, 1, 1.2]
  places: {table: [0.5, 0, 0.8], goal_area: [0.4, 0.3, 0.8], floor: [0.5, 0, -0.1]}
"""

BY_ACTION = ("server: /tpvqa,", "action: /tpvqa/execute_skill,")
PLAIN = """\
skills:
  find: {action: /arm/do, deadline: 10}
  pick_up: {action: /arm/do, deadline: 10}
  place: {action: /arm/do, deadline: 10}
cameras:
  overhead: {image: /arm/image, frame_id: eye}
joints: /arm/joints
sensed:
  - {fact: (hand_empty), joint: gripper, below: 0.003, sure: 0.98}
truth: /arm/truth
limits: {age: 1.0, wait: 30, gone: 1.5, grace: 0.5}
"""

Start = Callable[..., "subprocess.Popen[bytes]"]
Open = Callable[..., Ros2World]


def wait_for(held: Callable[[], bool], seconds: float = 60.0) -> None:
    """Wait no longer than needed; a busy machine is waited for, what never comes fails."""
    until = time.monotonic() + seconds
    while not held():
        assert time.monotonic() < until, "it did not come"
        time.sleep(0.01)


@pytest.fixture(autouse=True)
def domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A DDS domain that nobody else on this machine has until the test and its processes ended.

    The lock goes with its process. Numbers above 101 have ports that other programs may be given.
    """
    for number in random.sample(range(1, 102), 101):
        with (Path(tempfile.gettempdir()) / f"tpvqa-domain-{number}.lock").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            monkeypatch.setenv("ROS_DOMAIN_ID", str(number))
            monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
            yield number
            return
    pytest.fail("all DDS domains are taken")


def transition(link: Link, node: str, number: int) -> bool:
    """Take a managed node to another stage, by its service; whether it went there."""
    from lifecycle_msgs.srv import ChangeState

    client = link.node.create_client(ChangeState, f"/{node}/change_state")
    wait_for(client.service_is_ready)
    request = ChangeState.Request()
    request.transition.id = number
    changed = client.call_async(request)
    wait_for(changed.done)
    return bool(changed.result().success)


@pytest.fixture
def state(tmp_path: Path) -> Path:
    """Where the stand-in keeps how its world is, and what it did."""
    return tmp_path / "state.json"


@pytest.fixture
def setup_file(tmp_path: Path) -> Path:
    file = tmp_path / "robot.yaml"
    file.write_text(SETUP)
    return file


def change(file: Path, *changes: tuple[str, str]) -> None:
    """Change a setup file."""
    text = file.read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    file.write_text(text)


@pytest.fixture
def start(state: Path) -> Iterator[Start]:
    """Start a skill server: faults, then seconds that a skill takes."""
    running = []

    def begin(
        *faults: str, seconds: float = 0.05, which: str = "standin", more: Sequence[str] = ()
    ) -> "subprocess.Popen[bytes]":
        words = [word for fault in faults for word in ("--fault", fault)]
        words += ["--seconds", str(seconds), *more]
        server = subprocess.Popen(
            [sys.executable, "-m", f"tests_robot.ros2.{which}", str(state), *words],
            stdout=subprocess.PIPE,
            cwd=Path(__file__).parents[2],
            env=os.environ.copy(),
        )
        running.append(server)
        assert server.stdout is not None
        assert server.stdout.readline() == b"ready\n"
        return server

    yield begin
    for server in running:
        server.kill()
        server.wait()


@pytest.fixture
def open_world(task: Task, setup_file: Path) -> Iterator[Open]:
    """The world `ros2` on that server; changes to the setup file are given as pairs."""
    opened = []

    def make(*changes: tuple[str, str]) -> Ros2World:
        change(setup_file, *changes)
        load_setup(setup_file, task)
        opened.append(Ros2World.from_spec(str(setup_file), task=task))
        return opened[-1]

    yield make
    for world in opened:
        world.close()
