import json
from collections.abc import Callable
from pathlib import Path

import pytest

from tpvqa.errors import PictureSetError, PluginError, UnknownNameError
from tpvqa.worlds import Report, Restorable, World
from tpvqa.worlds.pictures import MANIFEST
from tpvqa.worlds.simulation import Simulation
from tpvqa_household.images.manifest import load_pictures
from tpvqa_household.images.paper import PaperSimulation
from tpvqa_household.images.visible import describe, visible_state
from tpvqa_household.images.world import ImageWorld

PLAN = (
    ("find", "plate", "tv"),
    ("pick_up", "plate", "table", "left"),
    ("find", "sink", "plate"),
    ("wash", "plate", "sink", "left"),
)

Simulate = Callable[..., Simulation]


def run(world: ImageWorld, steps: int = 12) -> list[str]:
    """Act and look for a while; the pictures seen."""
    task = world.simulation.task
    seen = []
    for step in range(steps):
        name, *arguments = PLAN[step % len(PLAN)]
        world.execute(task.action(name, arguments))
        seen.append(world.observe().frames["front"].source)
    return seen


def test_it_is_a_world_that_can_be_restored(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld(simulate(), folder=painted)
    assert isinstance(world, World)
    assert isinstance(world, Restorable)


def test_a_picture_shows_the_true_state(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld(simulate(seed=3), folder=painted)
    pictures = {p.file: p for p in load_pictures(painted).manifest.pictures}
    for step in range(30):
        name, *arguments = PLAN[step % len(PLAN)]
        world.execute(world.simulation.task.action(name, arguments))
        frame = world.observe().frames["front"]
        shown = pictures[frame.source]
        assert shown.visible == describe(visible_state(world.simulation.state))
        assert frame.data == (painted / shown.file).read_bytes()


def test_the_same_trial_sees_the_same_pictures(painted: Path, simulate: Simulate) -> None:
    first = run(ImageWorld(simulate(seed=7, episode=2), folder=painted))
    again = run(ImageWorld(simulate(seed=7, episode=2), folder=painted))
    other = run(ImageWorld(simulate(seed=8, episode=2), folder=painted))
    assert first == again
    assert first != other


def test_a_draw_depends_on_the_look_and_the_state_alone(painted: Path, simulate: Simulate) -> None:
    """However the robot came there: it makes no difference which actions were tried before."""
    straight = ImageWorld(simulate(failure=0.0), folder=painted)
    detour = ImageWorld(simulate(failure=0.0), folder=painted)
    task = straight.simulation.task
    straight.execute(task.action("find", ("plate", "tv")))
    for name, *arguments in (("find", "sink", "tv"), ("find", "plate", "sink")):
        detour.execute(task.action(name, arguments))
    assert straight.simulation.state == detour.simulation.state
    for _ in range(20):
        a, b = straight.observe(), detour.observe()
        assert a.frames["front"].source == b.frames["front"].source


def test_every_look_draws_anew(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld(simulate(), folder=painted)
    seen = {world.observe().frames["front"].source for _ in range(60)}
    assert len(seen) == len(world.pictures.of(visible_state(world.simulation.state)))


def test_a_restored_world_goes_on_as_the_unbroken_one(painted: Path, simulate: Simulate) -> None:
    for simulation in (simulate(seed=5), PaperSimulation.like(simulate(seed=5))):
        unbroken = ImageWorld(simulation, folder=painted)
        run(unbroken, 7)
        saved = json.loads(json.dumps(unbroken.snapshot()))
        fresh = simulate(seed=5)
        if isinstance(simulation, PaperSimulation):
            fresh = PaperSimulation.like(fresh)
        resumed = ImageWorld(fresh, folder=painted)
        resumed.restore(saved)
        for atom in unbroken.simulation.state:
            assert resumed.truth.visible(atom) == unbroken.truth.visible(atom)
        assert run(resumed) == run(unbroken)
        assert resumed.simulation.state == unbroken.simulation.state


def test_truth_tells_what_the_last_picture_shows(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld(simulate(failure=0.0), folder=painted)
    task = world.simulation.task
    atom = next(a for a in task.init if str(a) == "on(plate, table)")
    assert not world.truth.visible(atom), "nothing has been seen yet"
    world.execute(task.action("find", ("plate", "tv")))
    world.observe()
    assert world.truth.holds(atom)
    assert world.truth.visible(atom)


def test_an_outcome_without_pictures_is_refused_and_changes_nothing(
    painted: Path, simulate: Simulate
) -> None:
    world = ImageWorld(simulate(failure=0.0), folder=painted)
    task = world.simulation.task
    before = world.simulation.state
    execution = world.execute(task.action("find", ("bread", "tv")))
    assert execution.report is Report.UNAVAILABLE
    assert "near(bread)" in execution.message
    assert world.simulation.state == before
    assert world.execute(task.action("find", ("plate", "tv"))).report is Report.DONE


def test_there_is_one_view(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld(simulate(), folder=painted)
    assert list(world.views()) == ["front"]
    with pytest.raises(UnknownNameError, match="front"):
        world.observe("ceiling")


def test_only_held_out_objects_on_request(painted: Path, simulate: Simulate) -> None:
    world = ImageWorld.from_spec("held_out", simulation=simulate(), pictures=str(painted))
    meshes = {p.file: p.meshes for p in load_pictures(painted).manifest.pictures}
    assert {meshes[source] for source in run(world, 30)} == {"held_out"}


def test_specifications(simulate: Simulate) -> None:
    assert isinstance(
        ImageWorld.from_spec("paper", simulation=simulate()).simulation, PaperSimulation
    )
    assert isinstance(
        ImageWorld.from_spec("", simulation=simulate(), simulator="paper").simulation,
        PaperSimulation,
    )
    with pytest.raises(PluginError, match="held_out"):
        ImageWorld.from_spec("hold_out", simulation=simulate())


def test_a_missing_or_broken_manifest_says_what_to_do(tmp_path: Path, painted: Path) -> None:
    with pytest.raises(PictureSetError, match="tpvqa dataset build"):
        load_pictures(tmp_path / "nowhere")
    manifest = painted / MANIFEST
    document = json.loads(manifest.read_text())
    document["pictures"][3]["width"] = "wide"
    manifest.write_text(json.dumps(document))
    with pytest.raises(PictureSetError, match=r"pictures\.3\.width"):
        load_pictures(painted)
