"""What the robot's skills do to the table, and how they end."""

from threading import Event, Thread
from time import sleep

import numpy as np
import pytest

from tests_robot.conftest import Act
from tpvqa import Atom, Task
from tpvqa.worlds import Report
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.skills.protocol import Robot
from tpvqa_robots.toys.machine import TICK
from tpvqa_robots.toys.things import MOVABLE
from tpvqa_robots.world import ToysWorld

STANDING = 0.02
"""rad/s at which the fastest joint counts as standing."""


def atom(said: str) -> Atom:
    name, *arguments = said.split()
    return Atom(name, tuple(arguments))


def touching(world: ToysWorld) -> set[tuple[str, str]]:
    """What of arm, hand and things touches what of them and of the table, but for what stands."""
    machine, found = world.robot.machine, set[tuple[str, str]]()
    for contact in machine.data.contact[: machine.data.ncon]:
        names = [
            machine.model.body(int(machine.model.geom_bodyid[geom])).name for geom in contact.geom
        ]
        parts = sorted("hand" if name.startswith("arm_") else name for name in names)
        if set(parts) <= {"hand", "table", *MOVABLE} and len(set(parts)) == 2:
            found.add((parts[0], parts[1]))
    return {pair for pair in found if "table" not in pair or "hand" in pair}


def test_a_container_is_found_picked_placed_and_filled_by_contact_alone(
    world: ToysWorld, act: Act
) -> None:
    machine, truth = world.robot.machine, world.truth
    assert isinstance(world.robot, Robot)
    leaps: list[float] = []
    last = {name: machine.data.body(name).xpos.copy() for name in MOVABLE}

    touched: set[tuple[str, str]] = set()

    def watch() -> None:
        touched.update(touching(world))
        for name in MOVABLE:
            here = machine.data.body(name).xpos.copy()
            leaps.append(float(np.linalg.norm(here - last[name])))
            last[name] = here

    machine.on_tick = watch
    for said, then in (
        ("find blue_container table", "found blue_container"),
        ("pick_up blue_container", "in_hand blue_container"),
        ("find goal_area blue_container", "in_hand blue_container"),
        ("place blue_container goal_area", "on blue_container goal_area"),
        ("find toy_eggplant goal_area", "found toy_eggplant"),
        ("pick_up toy_eggplant", "in_hand toy_eggplant"),
        ("find blue_container toy_eggplant", "found blue_container"),
        ("place toy_eggplant blue_container", "on toy_eggplant blue_container"),
    ):
        touched.clear()
        done = world.execute(act(said))
        assert (done.report, truth.holds(atom(then))) == (Report.DONE, True), (said, done.message)
        _, thing, where = (*said.split(), "")[:3]
        held = where if said.startswith("find") else thing
        # nothing is pushed: the hand touches what it holds, which touches what it is put into
        assert touched <= {tuple(sorted(pair)) for pair in (("hand", held), (held, where))}, said
        told = {fact.atom: fact.probability > 0.5 for fact in done.facts}
        assert told == {atom("hand_empty"): truth.holds(atom("hand_empty"))}
    assert max(leaps) < 2.0 * TICK  # nothing moves faster than 2 m/s: nothing is teleported
    welds = [int(kind) for kind in machine.model.eq_type if int(kind) != 2]
    assert welds == []  # joints are coupled, nothing is attached


def test_what_slips_falls_to_the_floor_and_the_gripper_feels_it(task: Task, act: Act) -> None:
    world = ToysWorld(task, mishaps=Mishaps(slip=1.0), seed=2)
    try:
        world.execute(act("find blue_container table"))
        world.execute(act("pick_up blue_container"))
        assert world.truth.holds(atom("in_hand blue_container"))
        done = world.execute(act("find goal_area blue_container"))
        assert world.truth.holds(atom("on blue_container floor"))
        assert done.facts[0].probability > 0.5
        refused = world.execute(act("place blue_container goal_area"))
        assert (refused.report, "not in the hand" in refused.message) == (Report.FAILED, True)
        assert world.execute(act("find blue_container goal_area")).report is Report.FAILED
    finally:
        world.close()


def test_the_fingers_give_way_when_an_experiment_says_so(task: Task, act: Act) -> None:
    whole = ToysWorld(task, mishaps=Mishaps(), seed=2)
    for said in ("find blue_container table", "pick_up blue_container"):
        whole.execute(act(said))
    held, when = whole.truth.holds(atom("in_hand blue_container")), whole.robot.machine.time
    whole.close()
    assert held
    world = ToysWorld.from_spec(f"slip_at={when - 0.5:.2f}", task=task, seed=2, episode=0)
    try:
        for said in ("find blue_container table", "pick_up blue_container"):
            world.execute(act(said))
        assert not world.truth.holds(atom("in_hand blue_container"))
    finally:
        world.close()


def test_a_bad_grasp_closes_on_nothing(task: Task, act: Act) -> None:
    world = ToysWorld(task, mishaps=Mishaps(bad=1.0), seed=1)
    try:
        world.execute(act("find toy_eggplant table"))
        done = world.execute(act("pick_up toy_eggplant"))
        assert not world.truth.holds(atom("in_hand toy_eggplant"))
        assert done.facts[0].probability > 0.5
        assert world.last_outcome is not None
        assert not world.last_outcome.succeeded
    finally:
        world.close()


@pytest.mark.parametrize("ticks", [5, 60, 120])
def test_a_cancelled_skill_leaves_the_arm_standing_within_a_fifth_of_a_second(
    world: ToysWorld, act: Act, never: Event, ticks: int
) -> None:
    machine, count, before = world.robot.machine, 0, 0.0
    speeds: list[float] = []

    def watch() -> None:
        nonlocal count, before
        count += 1
        if never.is_set():
            speeds.append(machine.speed)
        elif count == ticks:
            before = machine.speed
            never.set()

    machine.on_tick = watch
    start = machine.time
    done = world.execute(act("pick_up cyan_container"), cancel=never)
    assert done.report is Report.CANCELLED
    assert machine.time - start <= ticks * TICK + 0.2 + 1e-6
    assert len(speeds) == round(0.2 / TICK)
    assert before > STANDING  # it was in motion
    assert speeds[-1] < STANDING


@pytest.mark.parametrize("cancelled", [False, True])
def test_what_failed_may_be_stopped_while_the_arm_goes_back(
    task: Task, act: Act, never: Event, cancelled: bool
) -> None:
    world = ToysWorld(task, mishaps=Mishaps(slip=1.0), seed=2)
    try:
        for said in (
            "find blue_container table",
            "pick_up blue_container",
            "find goal_area blue_container",
        ):
            world.execute(act(said))
        count = 0

        def watch() -> None:
            nonlocal count
            count += 1
            if cancelled and count == 10:
                never.set()

        world.robot.machine.on_tick = watch
        late = world.execute(act("place blue_container goal_area"), deadline=0.5, cancel=never)
        assert late.report is (Report.CANCELLED if cancelled else Report.LATE)
        assert world.robot.machine.speed < STANDING
    finally:
        world.close()


def test_another_thread_looks_meanwhile_and_stops_it(
    world: ToysWorld, act: Act, never: Event
) -> None:
    robot, moving, done = world.robot, Event(), []

    def perform() -> None:
        done.append(
            robot.perform(
                act("pick_up cyan_container"),
                deadline=60,
                cancelled=never,
                feedback=lambda said: moving.set() if said.startswith("grasping") else None,
            )
        )

    thread = Thread(target=perform)
    thread.start()
    assert moving.wait(60)
    looks = [robot.look("overhead")]
    while robot.machine.time < looks[0].time + 3 * TICK:
        sleep(0.005)
    looks.append(robot.look("overhead"))
    robot.stop()
    thread.join(10)
    assert looks[0].time < looks[1].time  # it went on while it was looked at
    assert looks[1].frames["overhead"].pixels.std() > 10
    assert done[0].report is Report.CANCELLED
    assert robot.machine.speed < STANDING
    assert set(robot.state()) >= {"gripper", "arm_elbow_joint"}


def test_a_skill_ends_at_its_deadline(world: ToysWorld, act: Act) -> None:
    done = world.execute(act("pick_up cyan_container"), deadline=1.0)
    assert done.report is Report.LATE
    assert done.seconds == pytest.approx(1.2, abs=0.03)
    assert world.robot.machine.speed < STANDING


def test_what_is_out_of_reach_is_said_and_the_arm_stays(world: ToysWorld, act: Act) -> None:
    machine = world.robot.machine
    joint = machine.model.body("cyan_container").jntadr[0]
    at = machine.model.jnt_qposadr[joint]
    machine.data.qpos[at : at + 2] = 0.98, 0.0  # the table's far edge
    machine.tick()
    before = machine.arm
    done = world.execute(act("pick_up cyan_container"))
    assert (done.report, "out of reach" in done.message) == (Report.FAILED, True), done.message
    assert np.abs(machine.arm - before).max() < 0.01


def test_what_is_not_there_is_not_found(world: ToysWorld, act: Act) -> None:
    done = world.execute(act("find floor table"))
    assert (done.report, done.message) == (Report.FAILED, "what floor looks like is not known")


def test_a_table_that_is_put_back_goes_on_alike(task: Task, act: Act) -> None:
    one, other = (ToysWorld(task, mishaps=Mishaps(), seed=3) for _ in range(2))
    try:
        one.execute(act("find blue_container table"))
        kept = one.snapshot()
        one.execute(act("pick_up blue_container"))
        other.restore(kept)
        other.execute(act("pick_up blue_container"))
        assert other.snapshot() == one.snapshot()
    finally:
        one.close()
        other.close()


def test_seeds_tell_tables_apart(task: Task) -> None:
    pictures = []
    for seed in (1, 1, 2):
        world = ToysWorld(task, mishaps=Mishaps(), seed=seed)
        pictures.append(next(iter(world.observe().frames.values())).data)
        world.close()
    assert pictures[0] == pictures[1]
    assert pictures[0] != pictures[2]
