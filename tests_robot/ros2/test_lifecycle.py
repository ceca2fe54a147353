"""Managed nodes, and the clock of a simulator: both by what other nodes do to them."""

import time
from pathlib import Path

from tests_robot.conftest import Act
from tests_robot.ros2.conftest import Open, Start, transition, wait_for
from tests_robot.ros2.test_safety import FIND, PICK, SHORT, in_thread, last
from tests_robot.ros2.test_world import done
from tpvqa.worlds import Report
from tpvqa_robots.ros2.link import Link, said

NODE = "tpvqa_skill_server"


def test_a_skill_server_goes_through_its_stages(
    start: Start, open_world: Open, act: Act, state: Path
) -> None:
    from lifecycle_msgs.msg import Transition

    server = start("endless", more=["--managed"])
    manager = Link("manager")
    try:
        manager.start()
        world = open_world(SHORT)
        assert transition(manager, NODE, Transition.TRANSITION_CONFIGURE)
        for _ in range(5):
            refused = world.execute(act(FIND))
            assert refused.report is Report.UNAVAILABLE
            if "not heard" not in refused.message:
                break
        assert "not active" in refused.message
        assert not state.exists() or not done(state)

        assert not transition(manager, NODE, Transition.TRANSITION_CLEANUP + 100)
        assert transition(manager, NODE, Transition.TRANSITION_ACTIVATE)
        wait_for(lambda: bool(world.observe().frames))
        for _ in range(100):  # it may not be heard yet that it is active
            thread, came = in_thread(world, act(FIND))
            wait_for(lambda: bool(done(state)) or bool(came))  # noqa: B023
            if not came:
                break
            time.sleep(0.1)
        assert done(state), came
        assert transition(manager, NODE, Transition.TRANSITION_DEACTIVATE)
        thread.join(30)
        wait_for(lambda: last(state)[1] == "stood")
        assert came[0].report in (Report.UNAVAILABLE, Report.CANCELLED)
        again = world.execute(act(FIND))
        assert again.report is Report.UNAVAILABLE
        assert "not active" in again.message

        assert transition(manager, NODE, Transition.TRANSITION_CLEANUP)
        wait_for(lambda: manager.node.count_publishers("/tpvqa/status") == 0)
        assert transition(manager, NODE, Transition.TRANSITION_CONFIGURE)
        assert transition(manager, NODE, Transition.TRANSITION_ACTIVATE)
        wait_for(lambda: manager.node.count_publishers("/tpvqa/status") == 1)
        assert transition(manager, NODE, Transition.TRANSITION_ACTIVE_SHUTDOWN)
        assert server.wait(30) == 0
    finally:
        manager.close()


def test_stamps_are_of_the_simulators_clock_where_that_is_said(
    start: Start, open_world: Open, act: Act
) -> None:
    """A clock that goes ten times as slowly: beats go on, and pictures are judged by it."""
    from rosgraph_msgs.msg import Clock

    simulator = Link("simulator")
    began = time.monotonic()

    def tell() -> None:
        message = Clock()
        seconds = 1000 + (time.monotonic() - began) / 10
        message.clock.sec = int(seconds)
        message.clock.nanosec = int(seconds % 1 * 1e9)
        speaker.publish(message)

    try:
        speaker = simulator.speaker(Clock, "/clock", said(1))
        simulator.every(0.02, tell)
        simulator.start()
        start(more=["--sim-time"])
        world = open_world(("joints:", "sim_time: true\njoints:"))
        found = world.execute(act(FIND))
        assert found.report is Report.DONE, found.message
        stamp = world.observe().detail["stamp"]
        assert 1000 < stamp < 1100
        picked = world.execute(act(PICK))
        assert picked.report is Report.DONE, picked.message
    finally:
        simulator.close()
