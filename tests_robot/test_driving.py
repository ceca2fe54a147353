"""Where the base drives, and that the arm reaches there what it could not before."""

import json
from math import atan2, cos, hypot, sin
from threading import Event

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests_robot.conftest import Act
from tpvqa import Atom, Task
from tpvqa.errors import PluginError
from tpvqa.worlds import Report
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.skills.driving import AHEAD, ALONG, AXIS, Stance, in_reach, stance_before
from tpvqa_robots.toys.machine import TICK
from tpvqa_robots.world import ToysWorld

stances = st.builds(Stance, st.floats(0, AHEAD), st.floats(-ALONG, ALONG), st.floats(-1.5, 1.5))


def seen_from(stance: Stance, x: float, y: float) -> tuple[float, float]:
    """Where the arm's foot sees a place of the room."""
    dx, dy = x - stance.ahead - AXIS, y - stance.aside
    c, s = cos(stance.yaw), sin(stance.yaw)
    return c * dx + s * dy + AXIS, c * dy - s * dx


@given(here=stances, x=st.floats(0.5, 0.88), y=st.floats(-0.8, 0.8))
def test_what_lies_on_the_table_is_straight_ahead_and_in_reach_then(
    here: Stance, x: float, y: float
) -> None:
    there = stance_before(*seen_from(here, x, y), here)
    ahead, aside = seen_from(there, x, y)
    assert abs(atan2(aside, ahead - AXIS)) < 1e-6
    assert in_reach(ahead, aside)
    assert 0 <= there.ahead <= AHEAD
    assert abs(there.aside) <= ALONG


def test_a_toy_at_the_tables_far_side_is_driven_to_and_collected(task: Task, act: Act) -> None:
    world = ToysWorld(task, mishaps=Mishaps(far=1.0), seed=1)
    try:
        machine = world.robot.machine
        found = world.execute(act("find toy_eggplant table"))
        assert hypot(*machine.place) > 0.3
        assert f"after {hypot(*machine.place):.1f}" in found.message
        kept = json.loads(json.dumps(world.snapshot()))
        here = machine.place
        for said in (
            "pick_up toy_eggplant",
            "find blue_container toy_eggplant",
            "place toy_eggplant blue_container",
        ):
            assert world.execute(act(said)).report is Report.DONE
        assert world.truth.holds(Atom("on", ("toy_eggplant", "blue_container")))
        world.restore(kept)
        assert machine.place == pytest.approx(here)
        assert machine.joints()["joint_mobile_side"] == pytest.approx(here[1])
    finally:
        world.close()


def test_a_base_that_only_turns_does_not_reach_it(task: Task, act: Act) -> None:
    from tpvqa_robots.toys.scene import FAR, SPOTS, build

    class Standing(ToysWorld):
        def room(self, seed: int, episode: int) -> object:
            return build({**SPOTS, "toy_eggplant": FAR})

    world = Standing(task, mishaps=Mishaps(), seed=1)
    try:
        assert world.execute(act("find toy_eggplant table")).report is Report.DONE
        done = world.execute(act("pick_up toy_eggplant"))
        assert (done.report, "out of reach" in done.message) == (Report.FAILED, True)
    finally:
        world.close()


def test_only_the_toys_have_something_far_away() -> None:
    assert Mishaps.read("far=0.5:slip=0.1") == Mishaps(slip=0.1, far=0.5)
    assert Mishaps.read("noise=0:calibration=3") == Mishaps(noise=0.0, calibration=3.0)
    with pytest.raises(PluginError, match="'far=1'"):
        Mishaps.read("far=1", "bins")
    with pytest.raises(PluginError, match="far from 0 to 1, not '2'"):
        Mishaps.read("far=2")
    with pytest.raises(PluginError, match="told 'far' twice"):
        Mishaps.read("far=1:far=0")
    with pytest.raises(PluginError, match="'appendix', which stands alone"):
        Mishaps.read("appendix:far=1")


@pytest.mark.parametrize("ticks", [15, 40, 70])
def test_cancelled_while_it_drives_the_base_stands_within_a_fifth_of_a_second(
    task: Task, act: Act, never: Event, ticks: int
) -> None:
    world = ToysWorld(task, mishaps=Mishaps(far=1.0), seed=1)
    try:
        machine, speeds, count = world.robot.machine, list[float](), 0
        places = list[tuple[float, float]]()

        def watch() -> None:
            nonlocal count
            if never.is_set():
                speeds.append(machine.speed)
                places.append(machine.place)
            elif max(abs(machine.place[0]), abs(machine.place[1])) > 0.01:
                count += 1
                if count == ticks:
                    never.set()

        machine.on_tick = watch
        done = world.execute(act("find toy_eggplant table"), cancel=never)
        assert done.report is Report.CANCELLED
        assert len(speeds) == round(0.2 / TICK)
        assert speeds[-1] < 0.02
        assert hypot(*(a - b for a, b in zip(places[-1], places[0], strict=True))) < 0.03
        machine.tick()
        for _ in range(25):
            machine.tick()
        assert machine.place == pytest.approx(places[-1], abs=0.002)  # nor is it driven back
    finally:
        world.close()
