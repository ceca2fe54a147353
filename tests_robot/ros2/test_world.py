"""The world `ros2` over DDS, with the skill server in a process of its own."""

import json
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests_robot.conftest import Act
from tests_robot.ros2.conftest import Open, Start, wait_for
from tests_robot.ros2.standin import StandIn
from tpvqa import Atom, Task
from tpvqa.errors import ConfigError
from tpvqa.observation import LateDepth, Observation
from tpvqa.worlds import Report
from tpvqa.worlds.capabilities import truth_of
from tpvqa_robots.ros2.link import Link, said, seen
from tpvqa_robots.ros2.server import SkillServer
from tpvqa_robots.ros2.setup import load_setup


def done(state: Path) -> list[list[str]]:
    return [entry[:2] for entry in json.loads(state.read_text())["done"]]


def run(setup_file: Path, folder: Path, *more: str) -> "subprocess.Popen[str]":
    command = [str(Path(sys.executable).parent / "tpvqa"), "run", "collect_toys", "--world"]
    return subprocess.Popen(
        [*command, f"ros2:{setup_file}", "--vlm", "oracle", "--out", str(folder), *more],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        env=os.environ.copy(),
    )


def test_pictures_depth_joints_and_facts_arrive(start: Start, open_world: Open, act: Act) -> None:
    start()
    world = open_world()
    seen = world.observe()
    frame = seen.frames["overhead"]
    assert frame.pixels.shape == (24, 32, 3)
    assert frame.depth is not None
    assert np.allclose(frame.depth.metres, 1.25)
    assert frame.intrinsics is not None
    assert frame.intrinsics.fx == 30.0
    done = world.execute(act("find blue_container table"))
    assert done.report is Report.DONE, done.message
    done = world.execute(act("pick_up blue_container"))
    assert {fact.atom: fact.probability for fact in done.facts} == {Atom("hand_empty"): 0.02}
    later = world.observe()
    assert later.time > seen.time
    assert {fact.atom for fact in later.facts} == {Atom("hand_empty")}


def test_what_nobody_hears_is_not_drawn(task: Task, state: Path) -> None:
    """Of two cameras one is heard, and of that one the picture alone."""
    from sensor_msgs.msg import CompressedImage

    drawn: list[str] = []

    class Watched(StandIn):
        def look(self, view: str) -> Observation:
            drawn.append(view)
            frame = super().look(view).frames[view]
            return Observation(frames={view: replace(frame, depth=LateDepth(self.measure))})

        def measure(self) -> bytes:
            drawn.append("depth")
            return b""

    server = SkillServer(Watched(task, state, set(), 0.05), task, ("overhead", "wrist"), rate=20.0)
    serving, eye = threading.Thread(target=server.run), Link("eye")
    try:
        heard: list[Any] = []
        eye.watch(CompressedImage, "/tpvqa/overhead/image", heard.append)
        eye.start()
        serving.start()
        wait_for(lambda: len(heard) >= 3)
    finally:
        server.close()
        serving.join(30)
        eye.close()
    assert set(drawn) == {"overhead"}


@pytest.mark.parametrize("quality", [said, seen])
def test_a_camera_is_heard_however_it_sends(quality: Callable[[], Any]) -> None:
    """A large picture, in many pieces, by best effort as by reliable sending."""
    from sensor_msgs.msg import Image

    loop, camera = Link("loop"), Link("camera")
    try:
        heard: list[bytes] = []
        loop.watch(Image, "/picture", lambda message: heard.append(bytes(message.data)))
        large = Image(data=bytes(range(256)) * 400)
        speaker = camera.speaker(Image, "/picture", quality())
        camera.every(0.1, lambda: speaker.publish(large))
        loop.start()
        camera.start()
        wait_for(lambda: bool(heard))
        assert heard[-1] == bytes(large.data)
    finally:
        loop.close()
        camera.close()


def test_a_trial_goes_on_after_its_server_was_killed(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    """Killed in the middle of a skill and started again: a look comes before anything else."""
    server = start(seconds=0.8)
    trial = run(setup_file, tmp_path / "episode")
    wait_for(lambda: state.exists() and len(done(state)) >= 3)
    server.send_signal(signal.SIGKILL)
    server.wait()
    start(seconds=0.1)
    said, _ = trial.communicate(timeout=60)
    assert trial.returncode == 0, said
    lines = (tmp_path / "episode" / "episode.jsonl").read_text().splitlines()
    kinds = [(e := json.loads(line))["kind"] + (e.get("report") or "") for line in lines]
    broken = kinds.index("actedfailed")
    following = [kind for kind in kinds[broken + 1 :] if kind in ("observed", "acting")]
    assert following[0] == "observed"
    facts = set(json.loads(state.read_text())["facts"])
    assert (
        "(on toy_eggplant cyan_container)" in facts or "(on toy_eggplant blue_container)" in facts
    )


def test_ctrl_c_stops_the_arm_and_ends_the_log(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    server = start("endless")
    trial = run(setup_file, tmp_path / "episode")
    wait_for(lambda: state.exists() and bool(done(state)))
    trial.send_signal(signal.SIGINT)
    said, _ = trial.communicate(timeout=60)
    assert "Traceback" not in said
    assert trial.returncode != 0
    wait_for(lambda: done(state)[-1][1] == "stood")
    server.send_signal(signal.SIGINT)
    assert server.wait(30) == 0


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("find:", "fined:", "no action 'fined'"),
        ("age: 1.0", "age: soon", "expected a number"),
        ("image: /tpvqa", "image: tpvqa", "leading slash"),
        ("(hand_empty)", "(hand_full)", "hand_full"),
        ("low: [-1, -1, 0]", "low: [-1, 0]", "three numbers"),
    ],
)
def test_a_broken_setup_is_refused_with_its_line(
    old: str, new: str, said: str, setup_file: Path, task: Task
) -> None:
    setup_file.write_text(setup_file.read_text().replace(old, new))
    with pytest.raises(ConfigError, match=r"robot\.yaml:\d+") as refused:
        load_setup(setup_file, task)
    assert said in str(refused.value)


def test_a_trial_without_its_setup_ends_in_one_message(tmp_path: Path) -> None:
    trial = run(tmp_path / "robot.yaml", tmp_path / "episode")
    text, _ = trial.communicate(timeout=60)
    assert trial.returncode == 2
    assert "robot.yaml" in "".join(text.split())
    assert "Traceback" not in text


def test_the_file_for_a_real_arm_is_read(task: Task) -> None:
    setup = load_setup(Path("examples/ur5e/robot.yaml"), task)
    assert set(setup.skills) == {"find", "pick_up", "place"}
    assert (setup.truth, setup.told) == (None, ("hand_empty",))
    assert setup.workspace is not None
    assert setup.workspace.left_by(("toy_eggplant", "floor"))
    assert not setup.workspace.left_by(("toy_eggplant", "goal_area"))


def test_a_trial_without_a_skill_server_does_not_begin(setup_file: Path, tmp_path: Path) -> None:
    setup_file.write_text(setup_file.read_text().replace("wait: 8", "wait: 1"))
    trial = run(setup_file, tmp_path / "episode")
    text, _ = trial.communicate(timeout=60)
    assert trial.returncode == 2
    assert "is the skill server running" in " ".join(text.split())
    assert "Traceback" not in text


def test_the_simulated_arm_acts_over_dds(open_world: Open, act: Act) -> None:
    command = [str(Path(sys.executable).parent / "tpvqa"), "skill-server", "collect_toys"]
    server = subprocess.Popen([*command, "--rate", "2"], stdout=subprocess.PIPE)
    try:
        assert server.stdout is not None
        assert b"offered" in server.stdout.readline()
        world = open_world(
            ("deadline: 10", "deadline: 120"),
            ("age: 1.0", "age: 10"),
            ("wait: 8", "wait: 60"),
            ("gone: 1.5", "gone: 20"),
        )
        found = world.execute(act("find blue_container table"))
        assert found.report is Report.DONE, found.message
        frame = world.observe().frames["overhead"]
        truth = truth_of(world)
        assert truth is not None
        assert truth.holds(Atom("found", ("blue_container",)))
        assert frame.depth is not None
        assert 0.3 < float(np.nanmedian(frame.depth.metres)) < 3.0
        world.close()
        server.send_signal(signal.SIGINT)
        assert server.wait(60) == 0
    finally:
        server.kill()
        server.wait()
