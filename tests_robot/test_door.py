"""Robosuite's door by the toys' robot: gripped, turned and pulled by contact."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa import Atom, Task, TpvqaError, load_task
from tpvqa.errors import PluginError
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa_robots.door.lever import HIGH, LENGTH, THICK, TO_PANEL, seen_lever
from tpvqa_robots.door.world import DoorWorld
from tpvqa_robots.mishaps import Mishaps

HOLDING, TURNED = Atom("holding", ("handle",)), Atom("turned", ("handle",))
OPEN = Atom("open", ("door",))


@pytest.fixture(scope="module")
def door() -> Task:
    files = find_task("open_door")
    assert files.default_world == "door"
    return load_task(files.domain, files.problem)


def test_a_door_is_opened_and_its_latch_holds_it_until_the_handle_is_turned(door: Task) -> None:
    world = DoorWorld(door, seed=1)
    grasp, turn, let_go = (
        door.action(name, ("handle",)) for name in ("grasp_handle", "turn_handle", "let_go")
    )
    pull = door.action("pull_open", ("door", "handle"))
    early = world.execute(turn)
    assert (early.report, early.message) == (Report.FAILED, "handle is not in the hand")
    assert world.execute(grasp).report is Report.DONE
    assert world.truth.holds(HOLDING)
    held = world.execute(pull)
    assert (held.report, held.message) == (Report.FAILED, "door does not give way")
    assert (world.truth.holds(HOLDING), world.truth.holds(OPEN)) == (True, False)
    kept = world.snapshot()
    for action, then in ((turn, TURNED), (pull, OPEN), (let_go, Atom("hand_empty"))):
        done = world.execute(action)
        assert (done.report, world.truth.holds(then)) == (Report.DONE, True), done.message
    assert world.truth.holds(OPEN)
    assert not world.truth.holds(TURNED)  # the spring turned it back
    welds = [int(kind) for kind in world.robot.machine.model.eq_type if int(kind) != 2]
    assert welds == []  # joints are coupled, nothing is attached
    world.restore(kept)
    assert (world.truth.holds(HOLDING), world.truth.holds(OPEN)) == (True, False)
    assert world.snapshot() == kept
    world.close()


def test_a_grasp_beside_the_handle_takes_nothing(door: Task) -> None:
    world = DoorWorld(door, mishaps=Mishaps(bad=1.0), seed=2)
    done = world.execute(door.action("grasp_handle", ("handle",)))
    assert done.report is Report.DONE  # the skill does not know; the fingers do
    assert [fact.probability > 0.5 for fact in done.facts] == [True]
    assert not world.truth.holds(HOLDING)
    world.close()


@settings(max_examples=20, deadline=None)
@given(
    yaw=st.floats(-0.3, 0.3),
    turned=st.floats(0.0, 1.4),
    x=st.floats(0.4, 0.6),
    y=st.floats(-0.1, 0.1),
)
def test_a_handle_is_seen_where_it_is_and_as_it_is_turned(
    yaw: float, turned: float, x: float, y: float
) -> None:
    """Points of the bar's front and upper side, and of the door behind it, with 1 mm of noise."""
    drawn, yaw = np.random.default_rng(1), yaw - np.pi / 2
    along = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    inwards = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    way = np.cos(turned) * along + np.sin(turned) * up
    above = np.cos(turned) * up - np.sin(turned) * along
    spindle = np.array([x, y, 0.97])

    def spread(count: int, *sides: tuple[np.ndarray, float, float]) -> np.ndarray:
        found = np.zeros((count, 3))
        for side, low, high in sides:
            found += drawn.uniform(low, high, (count, 1)) * side
        return found

    front = spread(1500, (way, 0, LENGTH), (above, -HIGH / 2, HIGH / 2)) - THICK / 2 * inwards
    upper = spread(700, (way, 0, LENGTH), (inwards, -THICK / 2, THICK / 2)) + HIGH / 2 * above
    bar = spindle + np.concatenate([front, upper])
    panel = spindle + (TO_PANEL - 0.02) * inwards
    panel = panel + spread(4000, (along, -0.05, 0.3), (up, -0.25, 0.25))
    bar, panel = (points + drawn.normal(0, 0.001, points.shape) for points in (bar, panel))
    seen = seen_lever(bar, panel)
    assert seen is not None
    lever, angle = seen
    assert (lever.x, lever.y, lever.z) == pytest.approx(spindle, abs=0.008)
    assert lever.yaw == pytest.approx(yaw, abs=0.02)
    assert angle == pytest.approx(turned, abs=0.06)
    assert seen_lever(bar[:10], panel) is None


def test_what_it_does_not_know_is_refused(task: Task, door: Task) -> None:
    with pytest.raises(TpvqaError, match="'door' cannot tell when"):
        DoorWorld(task)
    with pytest.raises(PluginError, match=r"'door' does not understand 'appendix'.*door:slip"):
        DoorWorld.from_spec("appendix", task=door, seed=0, episode=0)
