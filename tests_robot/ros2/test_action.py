"""Skills as a ROS 2 action: with our own skill server, and with somebody else's in plain rclpy."""

import json
import signal
import threading
import time
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from tests_robot.conftest import Act
from tests_robot.ros2.conftest import BY_ACTION, PLAIN, Open, Start, change, wait_for
from tests_robot.ros2.lag import Lag
from tests_robot.ros2.test_safety import (
    FIND,
    PICK,
    SHORT,
    in_thread,
    last,
    stands_when_killed,
)
from tests_robot.ros2.test_world import done, run
from tpvqa import Atom
from tpvqa.worlds import Execution, Report
from tpvqa_robots.ros2 import typed
from tpvqa_robots.ros2.action_client import ActionClient
from tpvqa_robots.ros2.lease import EXPIRES
from tpvqa_robots.ros2.link import Link, said
from tpvqa_robots.ros2.peers import LISTENS, Peers

pytest.importorskip("tpvqa_interfaces")


def test_a_loop_is_one_controller_whichever_way_it_commands(
    start: Start, open_world: Open, act: Act
) -> None:
    start()
    world = open_world(("place: {server: /tpvqa,", "place: {action: /tpvqa/execute_skill,"))
    for words in (FIND, "place blue_container goal_area", PICK):
        came = world.execute(act(words))
        assert came.report is Report.DONE, came.message


def test_skills_are_done_cancelled_and_refused_by_action(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start(seconds=0.3)
    first = open_world(BY_ACTION, SHORT)
    assert first.execute(act(FIND)).report is Report.DONE
    cancel = threading.Event()
    thread, came = in_thread(first, act(PICK), cancel=cancel)
    wait_for(lambda: len(done(state)) == 3)
    with Lag() as lag:
        began = time.time()
        cancel.set()
        thread.join(30)
    assert came[0].report is Report.CANCELLED
    assert last(state)[1] == "stood"
    assert last(state)[2] - began < lag.allows(0.2)
    picked = first.execute(act(PICK))
    assert picked.report is Report.DONE, picked.message
    assert {fact.atom: fact.probability for fact in picked.facts} == {Atom("hand_empty"): 0.02}

    second = open_world()
    for _ in range(5):
        refused = second.execute(act("place blue_container goal_area"))
        assert refused.report is Report.UNAVAILABLE
        if "was not heard" not in refused.message:
            break
    assert "another controller" in refused.message
    first.close()
    assert second.execute(act("place blue_container goal_area")).report is Report.DONE


def test_an_action_is_stopped_when_it_is_late_and_by_the_button(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    from std_msgs.msg import Bool

    start("endless")
    world = open_world(BY_ACTION)
    button = Link("button")
    try:
        speaker = button.speaker(Bool, "/tpvqa/stop", said())
        button.start()
        world.observe()
        with Lag() as lag:
            late = world.execute(act(FIND), deadline=1.0)
        assert late.report is Report.LATE, late.message
        assert late.seconds < lag.allows(2.0)
        wait_for(lambda: last(state)[1] == "stood")

        thread, came = in_thread(world, act(FIND))
        wait_for(lambda: len(done(state)) == 3)
        wait_for(lambda: speaker.get_subscription_count() == 2)
        with Lag() as lag:
            pressed = time.time()
            speaker.publish(Bool(data=True))
            thread.join(30)
            wait_for(lambda: last(state)[1] == "stood")
        assert last(state)[2] - pressed < lag.allows(0.2)
        assert came[0].report is Report.UNAVAILABLE
        assert "emergency stop" in came[0].message
    finally:
        button.close()


def test_a_server_that_is_still_at_an_action_takes_no_other(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    start("endless", "deaf")
    world = open_world(BY_ACTION, SHORT)
    world.observe()
    assert world.execute(act(FIND), deadline=0.5).report is Report.LATE
    again = world.execute(act(FIND))
    assert again.report is Report.UNAVAILABLE
    assert "is still at" in again.message
    assert len(done(state)) == 1


def test_a_loop_that_is_killed_leaves_no_action_running(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    start("endless")
    change(setup_file, BY_ACTION)
    stands_when_killed(setup_file, state, tmp_path / "episode")


def test_the_action_says_why_it_begins_nothing(start: Start, state: Path) -> None:
    """Whoever sends goals: an old picture, no controller, no such action."""
    from rclpy.action import ActionClient
    from tpvqa_interfaces.action import ExecuteSkill

    start()
    link = Link("stranger")
    try:
        asking = ActionClient(link.node, ExecuteSkill, "/tpvqa/execute_skill")
        link.start()
        wait_for(asking.server_is_ready)

        def do(seen: float, **more: Any) -> Any:
            said = {"action": f"({FIND})", "deadline": 5.0, "controller": "me", **more}
            goal = ExecuteSkill.Goal(**said)
            typed.stamped(goal.seen, seen)
            came: list[Any] = []
            sent = asking.send_goal_async(goal)
            sent.add_done_callback(
                lambda taken: (
                    taken.result()
                    .get_result_async()
                    .add_done_callback(lambda got: came.append(got.result().result))
                )
            )
            wait_for(lambda: bool(came))
            return came[0]

        assert "look again" in do(time.time() - 100).message
        assert "which controller" in do(time.time(), controller="").message
        assert "no action" in do(time.time(), action="(fly away)").message
        assert do(time.time(), deadline=float("nan")).report == ExecuteSkill.Result.UNAVAILABLE
        assert not state.exists() or not done(state)
        well = do(time.time())
        assert well.report == ExecuteSkill.Result.DONE
        assert "look again" in do(typed.seconds_of(well.ended) or 0.0).message
        assert len(done(state)) == 2
    finally:
        link.close()


def test_somebody_elses_server_is_driven_through_a_trial_and_a_restart(
    start: Start, setup_file: Path, state: Path, tmp_path: Path
) -> None:
    """In plain rclpy, killed in the middle of a skill and started again: a look comes first."""
    setup_file.write_text(PLAIN)
    server = start(seconds=0.5, which="plain")
    trial = run(setup_file, tmp_path / "episode")
    wait_for(lambda: state.exists() and len(done(state)) >= 3)
    server.send_signal(signal.SIGKILL)
    server.wait()
    start(seconds=0.05, which="plain")
    said, _ = trial.communicate(timeout=120)
    assert trial.returncode == 0, said
    lines = (tmp_path / "episode" / "episode.jsonl").read_text().splitlines()
    kinds = [(e := json.loads(line))["kind"] + (e.get("report") or "") for line in lines]
    broken = next(n for n, kind in enumerate(kinds) if kind in ("actedfailed", "actedlate"))
    following = [kind for kind in kinds[broken + 1 :] if kind in ("observed", "acting")]
    assert following[0] == "observed"
    assert any("(on toy_eggplant" in fact for fact in json.loads(state.read_text())["facts"])


def test_somebody_elses_server_is_cancelled_and_what_it_leaves_open_is_no_report(
    start: Start, setup_file: Path, open_world: Open, act: Act, state: Path
) -> None:
    setup_file.write_text(PLAIN)
    start("unset", seconds=0.5, which="plain")
    world, cancel = open_world(), threading.Event()
    unsaid = world.execute(act(FIND))
    assert unsaid.report is Report.FAILED
    assert "not understood" in unsaid.message
    thread, came = in_thread(world, act(FIND), cancel=cancel)
    wait_for(lambda: len(done(state)) == 3)
    cancel.set()
    thread.join(30)
    assert came[0].report is Report.FAILED  # stopped, and again without a report
    assert last(state)[1] == "stood"


def test_a_loop_that_loses_the_robot_stops_what_it_began(
    start: Start, setup_file: Path, open_world: Open, act: Act, state: Path
) -> None:
    """Two came to hold somebody else's server, as after a cut of the network: one gives way."""
    from tpvqa_interfaces.msg import Controller

    setup_file.write_text(PLAIN)
    start("endless", which="plain")
    world, other = open_world(), Link("other_loop")
    try:
        speaker = other.speaker(Controller, f"/arm/do/{typed.CONTROLLER}", said())
        other.start()
        thread, came = in_thread(world, act(FIND))
        wait_for(lambda: state.exists() and len(done(state)) == 1)
        wait_for(lambda: speaker.get_subscription_count() == 1)
        speaker.publish(Controller(id="a loop before it", holds=True))
        thread.join(30)
        assert came[0].report is Report.FAILED
        assert "held by another controller, a loop before it, in the middle" in came[0].message
        wait_for(lambda: last(state)[1] == "stood")
    finally:
        other.close()


def test_a_server_that_says_how_it_stands_is_waited_for(start: Start, open_world: Open) -> None:
    """Who has its robot is what it says, and never for a moment what loops say of each other."""
    start()
    for way in ((BY_ACTION,), *[()] * 4):
        (client,) = open_world(*way)._clients.values()
        assert isinstance(client, ActionClient)
        wait_for(partial(getattr, client, "there"))
        assert client._standing is not None


def test_who_comes_to_know_of_another_late_has_not_listened_yet() -> None:
    """As long as nobody is heard it waits; from a discovery on a second passes before it takes."""
    late = Peers("a", 0.0)
    late.found({"a"}, False, 0.0)
    assert late.holder(5.0) == "a"  # no server: nobody else is kept from it
    late.holds = False
    late.found({"a"}, True, 6.0)
    late.found({"a", "b"}, True, 6.5)
    assert late.holder(7.0) is None
    late.hear("b", 7.2, holds=True)
    assert late.holder(7.6) == "b"
    late.hear("b", 7.8, holds=False, release=True)
    assert late.holder(9.0) == "a"


LOOPS = st.lists(st.tuples(st.sampled_from("abc"), st.floats(0.05, 0.4)), max_size=60)


@given(LOOPS)
def test_of_loops_that_hear_each_other_one_has_the_robot(beats: list[tuple[str, float]]) -> None:
    now, loops = 0.0, {name: Peers(name, 0.0) for name in "abc"}
    beaten = dict.fromkeys("abc", 0.0)
    for who, pause in beats:
        now += pause
        held = loops[who].holder(now) == who
        for other in loops.values():
            other.hear(who, now, holds=held)
        beaten[who] = now
        alive = [each for each, at in beaten.items() if now - at <= EXPIRES]
        if now > LISTENS and len(alive) == 3 and held:
            assert [name for name in alive if loops[name].holder(now) == name] == [who]


@given(st.integers(0, 255), st.floats(), st.floats(), st.text(max_size=9))
@example(1, 0.0, 0.0, "\x1f")
@example(1, 0.0, 0.0, "(= (battery r)")
def test_a_malformed_result_of_an_action_is_no_result(
    report: int, seconds: float, probability: float, fact: str
) -> None:
    from tpvqa_interfaces.action import ExecuteSkill
    from tpvqa_interfaces.msg import Fact

    facts = [Fact(fact=fact.encode("ascii", "ignore").decode(), probability=probability)]
    result = typed.result_of(
        ExecuteSkill.Result(report=report, seconds=seconds, facts=facts), came=5.0
    )
    if result is not None:
        assert isinstance(result.report, Report)
        assert all(0 <= each.probability <= 1 for each in result.facts)
        assert result.ended == 5.0
    well = typed.result_message(ExecuteSkill.Result(), Execution(Report.DONE, 1.0, ""), 2.5)
    assert (typed.result_of(well, came=5.0) or result) is not None
