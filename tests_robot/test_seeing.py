"""What the robot makes of its pictures, against where things truly are."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa import Task
from tpvqa.errors import UnknownNameError
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.skills.kinematics import Grip, Kinematics, OutOfReachError
from tpvqa_robots.skills.seeing import see
from tpvqa_robots.toys.cameras import OVERHEAD, Errors
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.world import ToysWorld


def box(width: float, length: float, height: float, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Points of a box on a table, as a camera straight above sees them; which are the box's."""
    x, y = (axis.ravel() for axis in np.meshgrid(*[np.arange(-0.15, 0.15, 0.002)] * 2))
    c, s = np.cos(angle), np.sin(angle)
    inside = (np.abs(c * x + s * y) <= width / 2) & (np.abs(c * y - s * x) <= length / 2)
    return np.stack([x, y, np.where(inside, height, 0.0)], -1), inside


@settings(max_examples=15, deadline=None)
@given(width=st.floats(0.02, 0.065), angle=st.floats(0, np.pi), height=st.floats(0.03, 0.1))
def test_a_box_is_grasped_across(width: float, angle: float, height: float) -> None:
    points, of_box = box(width, 0.12, height, angle)
    best = antipodal(points, of_box, centre=(0.0, 0.0), table=0.0)[0]
    off = (best.angle - angle + np.pi / 2) % np.pi - np.pi / 2
    assert abs(off) < 0.3
    assert best.width == pytest.approx(width, abs=0.012)
    assert np.hypot(best.x, best.y) < 0.02


def test_a_box_wider_than_the_gripper_has_no_grasp() -> None:
    points, of_box = box(0.1, 0.12, 0.05, 0.3)
    assert antipodal(points, of_box, centre=(0.0, 0.0), table=0.0) == []


def test_a_box_between_two_others_has_no_grasp_across_them() -> None:
    points, of_box = box(0.04, 0.12, 0.05, 0.0)
    beside = (np.abs(points[:, 0]) > 0.03) & (np.abs(points[:, 0]) < 0.09)
    points[beside, 2] = 0.05
    for grasp in antipodal(points, of_box, centre=(0.0, 0.0), table=0.0):
        assert abs(np.cos(grasp.angle)) < 0.7


def test_things_are_seen_where_they_are(task: Task) -> None:
    world = ToysWorld(task, mishaps=Mishaps(noise=0.0), seed=5)
    data = world.robot.machine.data
    shot = world.robot.cameras.shot(data, OVERHEAD, 0)
    for name in ("blue_container", "cyan_container", "toy_eggplant"):
        seen = see(shot, name, table=TABLE)
        assert seen is not None
        assert np.hypot(*(np.array([seen.x, seen.y]) - data.body(name).xpos[:2])) < 0.015
    frame = world.observe().frames[OVERHEAD]
    assert frame.depth is not None
    assert np.nanmedian(np.abs(frame.depth.metres - shot.depth)) < 0.001
    with pytest.raises(UnknownNameError):
        world.observe("front")
    world.close()


@pytest.fixture(scope="module")
def kinematics(task: Task) -> tuple[Kinematics, np.ndarray]:
    world = ToysWorld(task, seed=1)
    machine = world.robot.machine
    arm = machine.arm
    world.close()
    return Kinematics(machine.model, machine.qpos, machine.dofs), arm


@settings(max_examples=25, deadline=None)
@given(
    x=st.floats(0.45, 0.7),
    y=st.floats(-0.3, 0.3),
    z=st.floats(0.73, 1.0),
    angle=st.floats(0.0, np.pi),
)
def test_the_gripper_comes_where_it_is_sent_in_a_straight_line(
    kinematics: tuple[Kinematics, np.ndarray], x: float, y: float, z: float, angle: float
) -> None:
    plans, start = kinematics
    arms = plans.line(Grip(x, y, z, angle), start)
    ends = plans.grip(arms[0]), plans.grip(arms[-1])
    assert (ends[1].x, ends[1].y, ends[1].z) == pytest.approx((x, y, z), abs=0.002)
    assert abs(np.exp(1j * ends[1].angle) - np.exp(1j * angle)) < 0.011
    a, b = (np.array([grip.x, grip.y, grip.z]) for grip in ends)
    for arm in arms:
        grip = plans.grip(arm)
        beside = np.cross(b - a, np.array([grip.x, grip.y, grip.z]) - a)
        assert np.linalg.norm(beside) / max(float(np.linalg.norm(b - a)), 0.05) < 0.005


@pytest.mark.parametrize("grip", [Grip(1.1, 0, 0.8, 1.5), Grip(0.7, 0, 0.6, 1.5)])
def test_beyond_the_arm_and_within_the_table_is_out_of_reach(
    kinematics: tuple[Kinematics, np.ndarray], grip: Grip
) -> None:
    plans, start = kinematics
    with pytest.raises(OutOfReachError):
        plans.line(grip, start)


def test_joints_go_evenly_and_through_nothing(kinematics: tuple[Kinematics, np.ndarray]) -> None:
    plans, start = kinematics
    there = plans.line(Grip(0.6, 0.2, 0.9, 1.0), start)[-1]
    arms = plans.joint_by_joint(start, there)
    assert np.allclose(arms[0], start)
    assert np.allclose(arms[-1], there)
    steps = np.diff(arms, axis=0)
    assert np.allclose(steps, steps[0])
    assert np.abs(steps).max() <= 0.1 + 1e-9
    within = plans.solve(Grip(0.7, 0, 0.6, 1.5), start)
    with pytest.raises(OutOfReachError, match="would touch"):
        plans.joint_by_joint(start, within)


def test_noise_and_calibration_are_told_apart() -> None:
    one, noisy, aside = Errors(), Errors().times(2.0), Errors().times(1.0, 3.0)
    assert (noisy.depth, noisy.turn) == (2 * one.depth, 2 * one.turn)
    assert (aside.depth, aside.shift, aside.turn) == (one.depth, 3 * one.shift, 3 * one.turn)
