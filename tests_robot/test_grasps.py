"""Ways of finding grasps: by name, and what the network says of things that it never saw."""

from pathlib import Path

import numpy as np
import pytest

from tests_robot.test_seeing import box
from tpvqa import Action, Atom, Task
from tpvqa.errors import PluginError
from tpvqa_robots.bins.world import BinsWorld
from tpvqa_robots.grasps.above import PIXEL, SIDE, depth_image, from_above
from tpvqa_robots.grasps.antipodal import antipodal
from tpvqa_robots.grasps.ggcnn import ggcnn, maps_of
from tpvqa_robots.grasps.grasp import Grasp
from tpvqa_robots.grasps.methods import said
from tpvqa_robots.grasps.training.bench import EYE, FOVY, LEAN, Bench
from tpvqa_robots.grasps.training.labels import painted
from tpvqa_robots.grasps.training.sight import points_of, window
from tpvqa_robots.grasps.training.solids import Solid, Thing
from tpvqa_robots.grasps.training.trials import Trials
from tpvqa_robots.mishaps import Mishaps
from tpvqa_robots.toys.room import TABLE
from tpvqa_robots.toys.scene import build
from tpvqa_robots.world import ToysWorld

CUBE = Thing("cube", (Solid("box", (0.025, 0.025, 0.025)),), upright=True)


def off(angle: float, from_: float, every: float = np.pi) -> float:
    """By how much a direction is off another, or one that is so many radians further."""
    return float(abs((angle - from_ + every / 2) % every - every / 2))


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.2])
def test_the_network_finds_where_to_grasp_a_cube_that_it_never_saw(angle: float) -> None:
    points, of_cube = box(0.05, 0.05, 0.05, angle)
    best = ggcnn(points, of_cube, centre=(0.0, 0.0), table=0.0)[0]
    assert np.hypot(best.x, best.y) < 0.02
    assert best.z == pytest.approx(0.026, abs=0.005)
    assert best.width == pytest.approx(0.05, abs=0.02)
    assert best.quality > 0.3


def test_the_network_grasps_a_bar_across() -> None:
    points, of_bar = box(0.035, 0.14, 0.05, 0.6)
    best = ggcnn(points, of_bar, centre=(0.0, 0.0), table=0.0)[0]
    assert off(best.angle, 0.6) < 0.4


def test_its_image_is_square_filled_and_of_mean_nought() -> None:
    points, _ = box(0.05, 0.1, 0.06, 0.3)
    points = np.delete(points, np.arange(0, len(points), 7), axis=0)
    heights = from_above(points, (0.0, 0.0), 0.0)
    image = depth_image(heights)
    assert image.shape == (1, 1, SIDE, SIDE)
    assert image.mean() == pytest.approx(0, abs=1e-3)
    assert np.isfinite(image).all()
    high = float((heights > 0.03).sum()) * PIXEL**2
    assert high == pytest.approx(0.05 * 0.1, rel=0.2)
    assert all(part.shape == (SIDE, SIDE) for part in maps_of(heights))


def test_a_worlds_words_name_the_way(task: Task) -> None:
    world = ToysWorld.from_spec("grasps=ggcnn", task=task, seed=1, episode=0)
    assert (world.grasps, world._mishaps) == (ggcnn, Mishaps(appendix=True))
    world = ToysWorld.from_spec("slip=0.5:grasps=ggcnn", task=task, seed=1, episode=0)
    assert (world.grasps, world._mishaps) == (ggcnn, Mishaps(slip=0.5))
    assert ToysWorld.from_spec("", task=task, seed=1, episode=0).grasps is antipodal
    assert said("grasps=antipodal", "bins") == (antipodal, "")


@pytest.mark.parametrize("words", ["grasps=hand", "grasps=", "slip=0.1:grasps=ggcnn:grasps=ggcnn"])
def test_a_way_that_is_not_there_is_named_in_the_error(task: Task, words: str) -> None:
    for world in (ToysWorld, BinsWorld):
        with pytest.raises(PluginError, match=r"grasps=.*one of antipodal, ggcnn"):
            world.from_spec(words, task=task, seed=1, episode=0)


def test_the_robot_carries_off_what_the_network_grasps(task: Task) -> None:
    world = ToysWorld(task, mishaps=Mishaps(), grasps=ggcnn, seed=1)
    try:
        for name, thing in (("find", ["toy_eggplant", "table"]), ("pick_up", ["toy_eggplant"])):
            action: Action = task.action(name, thing)
            world.execute(action)
        assert world.truth.holds(Atom("in_hand", ("toy_eggplant",)))
    finally:
        world.close()


def test_the_bench_looks_at_its_table_as_the_robot_does() -> None:
    model = build()
    camera = model.camera("overhead")
    assert camera.fovy[0] == FOVY
    assert camera.pos[2] == pytest.approx(EYE[2] + TABLE)
    bench = Bench([CUBE], np.random.default_rng(0))
    own = bench.data.camera("overhead").xmat.reshape(3, 3)
    assert own[0, 1] == pytest.approx(np.sqrt(1 - LEAN**2))
    points = points_of(window(bench.depth()))
    assert points[:, 2].max() - TABLE == pytest.approx(0.05, abs=0.003)
    top = points[points[:, 2] > TABLE + 0.045]
    middle = (top.min(0) + top.max(0)) / 2
    assert middle[:2] == pytest.approx(bench.data.body("thing_0").xpos[:2], abs=0.004)


def test_physics_tells_a_good_grasp_of_a_cube_from_one_beside_it() -> None:
    bench = Bench([CUBE], np.random.default_rng(0))
    assert bench.settled
    x, y, _ = bench.data.body("thing_0").xpos
    turned = bench.data.body("thing_0").xmat.reshape(3, 3)
    angle = float(np.arctan2(turned[1, 0], turned[0, 0]))
    good = Grasp(x, y, TABLE + 0.026, angle, 0.05, 1.0)
    beside = Grasp(x + 0.1, y, TABLE + 0.026, angle, 0.05, 1.0)
    came = Trials(bench, np.random.default_rng(0)).all_of([good, beside, good], 0.05)
    assert [tried.held for tried in came] == [True, False, True]
    assert came[0].width == pytest.approx(0.05, abs=0.01)


def test_what_held_is_painted_and_what_failed_is_not() -> None:
    held, failed = (0.03, 0.0, 0.5, 0.05, 1.0), (-0.05, 0.0, 0.5, 0.0, 0.0)
    quality, cosine, sine, width = painted(np.array([held, failed]))
    row, column = int(0.03 / PIXEL + SIDE / 2), SIDE // 2
    assert quality[row, column] == 1
    assert np.arctan2(sine[row, column], cosine[row, column]) / 2 == pytest.approx(0.5)
    assert width[row, column] == pytest.approx(0.05 / 0.085)
    assert not quality[: SIDE // 2].any()


def test_torch_and_onnx_say_the_same(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch")
    pytest.importorskip("onnx")
    import onnxruntime

    from tpvqa_robots.grasps.training.export import export
    from tpvqa_robots.grasps.training.network import GgCnn

    net = GgCnn()
    torch.save(net.state_dict(), tmp_path / "ggcnn.pt")
    export(tmp_path, tmp_path / "own.onnx")
    seen = np.random.default_rng(0).normal(0, 0.3, (1, 1, SIDE, SIDE)).astype(np.float32)
    session = onnxruntime.InferenceSession(str(tmp_path / "own.onnx"))
    with torch.no_grad():
        wanted = net(torch.from_numpy(seen))
    for one, other in zip(session.run(None, {"depth": seen}), wanted, strict=True):
        assert np.abs(one - other.numpy()).max() < 1e-4


def test_the_floor_beside_the_table_and_the_arm_above_it_change_nothing() -> None:
    points, _ = box(0.05, 0.1, 0.06, 0.3)
    beyond = points[:, 1] < -0.1
    plain, seen = points.copy(), points.copy()
    plain[beyond, 2] = -0.005
    seen[beyond, 2] = -0.7
    arm = np.column_stack([points[::5, :2], np.full(len(points[::5]), 0.4)])
    with_arm = np.concatenate([seen, arm])
    one, other = (from_above(each, (0.0, 0.0), 0.0) for each in (plain, with_arm))
    assert np.array_equal(one, other)


def test_the_two_ways_of_grasping_a_cube_are_not_averaged() -> None:
    rng = np.random.default_rng(0)
    ways = np.concatenate([np.full(7, 0.3), np.full(7, 0.3 + np.pi / 2)])
    aslant = rng.uniform(0, np.pi, 14)
    every = np.concatenate([ways + rng.normal(0, 0.1, 14), aslant])
    tried = np.column_stack([rng.normal(0, 0.004, (28, 2)), every, np.full((28, 2), [0.05, 1.0])])
    quality, cosine, sine, _ = painted(tried)
    found = np.arctan2(sine, cosine)[quality > 0] / 2
    assert max(off(angle, 0.3, np.pi / 2) for angle in found) < 0.15
    middle = np.arctan2(sine, cosine)[SIDE // 2, SIDE // 2] / 2
    assert off(float(middle), 0.3) < 0.15
