"""What goes wrong around a robot, each injected: nothing moves on, and it is said why."""

import json
import re
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests_robot.conftest import Act
from tests_robot.ros2.conftest import Open, Start, wait_for
from tests_robot.ros2.lag import Lag
from tests_robot.ros2.test_world import done, run
from tpvqa.pddl import Atom
from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2 import wire
from tpvqa_robots.ros2.feeling import Joints
from tpvqa_robots.ros2.lease import EXPIRES, Lease
from tpvqa_robots.ros2.link import Link, latched, said
from tpvqa_robots.ros2.setup import SensedRule
from tpvqa_robots.ros2.world import Ros2World

SHORT = ("wait: 8", "wait: 3")
FIND, PICK = "find blue_container table", "pick_up blue_container"


def in_thread(
    world: Ros2World, action: Any, **more: Any
) -> tuple[threading.Thread, list[Execution]]:
    came: list[Execution] = []
    thread = threading.Thread(target=lambda: came.append(world.execute(action, **more)))
    thread.start()
    return thread, came


def last(state: Path) -> list[Any]:
    """What the stand-in did last: action, what of it, when."""
    entry: list[Any] = json.loads(state.read_text())["done"][-1]
    return entry


def until_begun(state: Path) -> None:
    wait_for(lambda: state.exists() and bool(done(state)))


@pytest.mark.parametrize(
    ("fault", "why"), [("blind", "no picture"), ("frozen", "frozen"), ("unplugged", "last picture")]
)
def test_a_camera_that_is_gone_or_frozen_ends_the_trial(
    fault: str, why: str, start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    setup_file.write_text(setup_file.read_text().replace("wait: 8", "wait: 4"))
    start(fault)
    trial = run(setup_file, tmp_path / "episode")
    text, _ = trial.communicate(timeout=60)
    assert trial.returncode == 1, text
    ended = json.loads((tmp_path / "episode" / "episode.jsonl").read_text().splitlines()[-1])
    assert (ended["kind"], ended["because"]) == ("ended", "world refused")
    assert why in ended["message"]
    assert len(done(state)) == (0 if fault == "blind" else 2)  # begun and ended, once


def test_a_picture_of_another_camera_is_no_observation(start: Start, open_world: Open) -> None:
    start()
    seen = open_world(SHORT, ("frame_id: overhead", "frame_id: wrist")).observe()
    assert not seen.frames
    assert "is of frame 'overhead', not 'wrist'" in seen.detail["no picture"]


def test_what_was_waited_for_is_not_taken_from_a_skills_time(
    start: Start, open_world: Open, act: Act
) -> None:
    world = open_world()
    thread, came = in_thread(world, act(FIND), deadline=2.0)
    time.sleep(3)  # no server yet
    start(seconds=1.0)
    thread.join(60)
    assert came[0].report is Report.DONE, came[0].message


def test_what_slips_later_is_felt_though_the_skill_said_it_held(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start()
    world = open_world()
    assert world.execute(act(FIND)).report is Report.DONE
    assert world.execute(act(PICK)).facts[0].probability < 0.1
    held = json.loads(state.read_text())
    other = state.with_suffix(".slipped")
    other.write_text(json.dumps(held | {"facts": [*held["facts"], "(hand_empty)"]}))
    other.replace(state)
    time.sleep(0.5)
    assert {fact.atom.pddl(): fact.probability for fact in world.observe().facts} == {
        "(hand_empty)": 0.98
    }


def test_a_button_that_stays_down_is_known_to_who_comes_later(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    from std_msgs.msg import Bool

    button = Link("button")
    try:
        button.start()
        button.speaker(Bool, "/tpvqa/stop", latched()).publish(Bool(data=True))
        start()
        world = open_world()
        wait_for(lambda: bool(world.halted()))
        client = next(iter(world._clients.values()))
        wait_for(lambda: client.stopped == "emergency stop")  # the server, too
        refused = world.execute(act(FIND))
        assert refused.report is Report.UNAVAILABLE
        assert "emergency stop" in refused.message
        assert not state.exists() or not done(state)
    finally:
        button.close()


def test_joints_of_two_drivers_are_one_robot() -> None:
    """Arm and gripper are told by messages of their own, on one topic."""
    from sensor_msgs.msg import JointState

    heard: list[Any] = []
    link = SimpleNamespace(listen=lambda kind, topic, hear, quality: heard.append(hear))
    rule = SensedRule(Atom("hand_empty"), "gripper", 0.001, below=True, sure=0.98)
    joints = Joints(link, "/joint_states", (rule,), lambda: None)  # type: ignore[arg-type]

    def tell(name: str, position: float, second: int) -> None:
        message = JointState(name=[name], position=[position])
        message.header.stamp.sec = second
        heard[0](message)

    tell("gripper", 0.0, 10)
    tell("shoulder", 0.3, 11)
    assert [fact.probability for fact in joints.facts(11.0, 9.0, 2.0)] == [0.98]
    assert joints.facts(11.0, 10.5, 2.0) == ()  # the gripper was felt before the action ended
    assert joints.said(11.0) == "joints 0.0 s ago: shoulder 0.300; joints 1.0 s ago: gripper 0.000"


def test_pictures_that_are_old_are_no_observation(start: Start, open_world: Open, act: Act) -> None:
    server = start()
    world = open_world(SHORT)
    assert world.observe().frames
    server.kill()
    time.sleep(1.2)
    seen = world.observe()
    assert not seen.frames
    assert "s old" in seen.detail["no picture"]
    refused = world.execute(act(FIND))
    assert refused.report is Report.UNAVAILABLE
    assert "was not heard" in refused.message


def test_a_server_that_goes_in_the_middle_is_told_of(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    server = start("endless")
    world = open_world(SHORT)
    thread, came = in_thread(world, act(FIND))
    until_begun(state)
    server.kill()
    thread.join(30)
    assert came[0].report is Report.FAILED
    assert "went away in the middle" in came[0].message
    again = world.execute(act(FIND))
    assert again.report is Report.UNAVAILABLE
    assert len(done(state)) == 1


def test_a_skill_that_breaks_is_reported_and_the_server_goes_on(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start("breaks")
    world = open_world()
    assert world.observe().frames
    broke = world.execute(act(FIND))
    assert broke.report is Report.FAILED
    assert "the gripper does not answer" in broke.message
    assert world.execute(act(FIND)).report is Report.DONE


@pytest.mark.parametrize("deaf", [False, True])
def test_a_skill_that_never_returns_is_stopped(
    deaf: bool, start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start("endless", *(("deaf",) if deaf else ()))
    world = open_world(SHORT)
    world.observe()
    with Lag() as lag:
        late = world.execute(act(FIND), deadline=0.5)
    assert late.report is Report.LATE, late.message
    assert late.seconds < lag.allows(1.5)
    if deaf:
        again = world.execute(act(FIND))
        assert again.report is Report.UNAVAILABLE
        assert "is still at" in again.message
        assert len(done(state)) == 1
    else:
        wait_for(lambda: last(state)[1] == "stood")


def test_cancel_in_the_middle_stops_the_arm(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start("endless")
    world, cancel = open_world(), threading.Event()
    thread, came = in_thread(world, act(FIND), cancel=cancel)
    until_begun(state)
    with Lag() as lag:
        began = time.time()
        cancel.set()
        thread.join(30)
    assert came[0].report is Report.CANCELLED
    stood = last(state)
    assert stood[1] == "stood"
    assert stood[2] - began < lag.allows(0.2)


def test_an_emergency_stop_ends_it_within_a_fifth_of_a_second(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    from std_msgs.msg import Bool

    start("endless")
    world = open_world()
    button = Link("button")
    try:
        speaker = button.speaker(Bool, "/tpvqa/stop", said())
        button.start()
        thread, came = in_thread(world, act(FIND))
        until_begun(state)
        wait_for(lambda: speaker.get_subscription_count() == 2)
        assert world.halted() == ""
        with Lag() as lag:
            pressed, began = time.time(), time.monotonic()
            speaker.publish(Bool(data=True))
            thread.join(30)
            took = time.monotonic() - began
            wait_for(lambda: last(state)[1] == "stood")
        assert took < lag.allows(0.2)
        assert last(state)[2] - pressed < lag.allows(0.2)
        assert came[0].report is Report.UNAVAILABLE
        for part in ("emergency stop", "(find blue_container table)", "gripper 0.000", "it feels"):
            assert part in came[0].message
        (shoulder,) = re.findall(r"shoulder ([\d.]+)", came[0].message)
        assert float(shoulder) > pressed - lag.allows(0.4)  # joints are told in a motion, too
        again = world.execute(act(FIND))
        assert again.report is Report.UNAVAILABLE
        assert "emergency stop" in again.message
        assert "emergency stop" in world.halted()  # so looks and questions end, too
    finally:
        button.close()


def test_a_trial_that_is_stopped_ends_and_says_why(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    from std_msgs.msg import Bool

    start("endless")
    button = Link("button")
    try:
        speaker = button.speaker(Bool, "/tpvqa/stop", said())
        button.start()
        trial = run(setup_file, tmp_path / "episode")
        until_begun(state)
        speaker.publish(Bool(data=True))
        text, _ = trial.communicate(timeout=60)
        assert trial.returncode == 1, text
        stopped = json.loads((tmp_path / "episode" / "episode.jsonl").read_text().splitlines()[-1])
        assert stopped["because"] == "world refused"
        for part in ("emergency stop", "(find blue_container table)", "joints"):
            assert part in stopped["message"]
        assert len(done(state)) == 2  # begun and stood, once
    finally:
        button.close()


def test_a_second_controller_is_refused_until_the_first_lets_go(
    start: Start, open_world: Open, act: Act
) -> None:
    start()
    first = open_world(SHORT)
    assert first.execute(act(FIND)).report is Report.DONE
    second = open_world()
    for _ in range(5):  # on a busy machine a newcomer may take some seconds to hear the server
        refused = second.execute(act(FIND))
        assert refused.report is Report.UNAVAILABLE
        if "was not heard" not in refused.message:
            break
    assert "another controller" in refused.message
    first.close()
    assert second.execute(act(PICK)).report is Report.DONE


def test_what_leaves_the_workspace_is_refused(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start()
    world = open_world(("places: {table: [0.5, 0, 0.8]", "places: {table: [0.5, 0, 1.8]"))
    refused = world.execute(act(FIND))
    assert refused.report is Report.UNAVAILABLE
    assert "would leave the workspace: table" in refused.message
    assert not state.exists() or not done(state)


@pytest.mark.parametrize("monitor", ["tpvqa", "belief"])
def test_a_plan_that_would_leave_the_workspace_is_refused_before_its_first_action(
    monitor: str, start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    """The last of its places alone lies outside: nothing is picked up first."""
    setup_file.write_text(
        setup_file.read_text().replace("goal_area: [0.4, 0.3,", "goal_area: [4, 3,")
    )
    start()
    trial = run(setup_file, tmp_path / "episode", "--monitor", monitor)
    text, _ = trial.communicate(timeout=60)
    assert trial.returncode == 1, text
    ended = json.loads((tmp_path / "episode" / "episode.jsonl").read_text().splitlines()[-1])
    assert "would leave the workspace: goal_area is at 4, 3, 0.8 m" in ended["message"]
    assert not state.exists() or not done(state)


def test_the_server_itself_starts_nothing_on_an_old_picture(start: Start, state: Path) -> None:
    """Whoever commands it: what was seen before the last action, or before it started, is old."""
    from std_msgs.msg import String

    start()
    heard: list[wire.Said] = []
    link = Link("stranger")
    try:
        link.listen(
            String, "/tpvqa/status", lambda m: heard.append(wire.read(m.data) or {}), said()
        )
        speaker = link.speaker(String, "/tpvqa/command", said())
        link.start()
        wait_for(lambda: bool(heard) and speaker.get_subscription_count() > 0)

        def answers(name: str) -> Iterator[wire.Said]:
            said = (each for each in list(heard) if each["say"] in ("refused", "result"))
            return (each for each in said if each.get("id") == name)

        def do(name: str, seen: float, **more: Any) -> wire.Said:
            message = {"from": "me", "id": name, "action": f"({FIND})", "deadline": 5.0, **more}
            speaker.publish(String(data=wire.write("do", seen=seen, **message)))
            wait_for(lambda: any(answers(name)))
            return next(answers(name))

        early = time.time() - 100
        assert "look again" in do("a", early)["message"]
        assert do("b", time.time())["report"] == "done"
        ended = next(each["ended"] for each in heard if each["say"] == "result")
        assert "look again" in do("c", ended)["message"]
        assert "no action" in do("d", time.time(), action="(fly away)")["message"]
        assert len(done(state)) == 2
    finally:
        link.close()


def test_a_loop_that_is_killed_leaves_no_arm_in_motion(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    start("endless")
    stands_when_killed(setup_file, state, tmp_path / "episode")


def stands_when_killed(setup_file: Path, state: Path, episode: Path) -> None:
    """A robot that is at an action stands soon after its loop was killed."""
    trial = run(setup_file, episode)
    until_begun(state)
    trial.kill()
    trial.communicate()
    with Lag() as lag:
        killed = time.time()
        wait_for(lambda: last(state)[1] == "stood")
    assert last(state)[2] - killed < lag.allows(EXPIRES + 1)


@given(st.lists(st.tuples(st.sampled_from("abc"), st.floats(0, 3)), max_size=30))
def test_never_two_controllers_hold_a_robot(beats: list[tuple[str, float]]) -> None:
    lease, now = Lease(), 0.0
    held: dict[str, float] = {}
    for who, pause in beats:
        now += pause
        if lease.beat(who, now):
            for other, at in held.items():
                assert other == who or now - at > EXPIRES
            held = {who: now}


@given(st.text() | st.recursive(st.none() | st.floats() | st.text(), st.lists).map(json.dumps))
def test_what_is_not_understood_is_no_message(text: str) -> None:
    heard = wire.read(text)
    assert heard is None or isinstance(heard["say"], str)


@given(
    st.dictionaries(
        st.sampled_from(["report", "seconds", "ended", "message", "facts"]),
        st.none()
        | st.booleans()
        | st.text()
        | st.floats()
        | st.just([["(a)", 2]])
        | st.lists(st.tuples(st.text() | st.sampled_from([",", "(,)", "\x1f"]), st.floats(0, 1))),
    )
)
def test_a_malformed_result_is_no_result(given: dict[str, Any]) -> None:
    good = {"report": "done", "seconds": 1.0, "ended": 2.0, "message": "", "facts": []}
    result = wire.result_of(json.loads(json.dumps({**good, **given})))
    if result is not None:
        assert isinstance(result.report, Report)
        assert all(0 <= fact.probability <= 1 for fact in result.facts)
    assert wire.result_of(good) is not None
