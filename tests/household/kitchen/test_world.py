"""The live kitchen as a world; needs MuJoCo and software GL."""

import json
from collections.abc import Iterator
from threading import Event

import pytest

from tpvqa.errors import PluginError, UnknownNameError
from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds import Report, Restorable, World
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import load_world_file
from tpvqa_household.kitchen.world import KitchenWorld

pytestmark = pytest.mark.rendering


@pytest.fixture(scope="module")
def task() -> Task:
    files = find_task("serve_breakfast")
    return load_task(files.domain, files.problem)


def _simulation(task: Task, *, failure: float = 0.0, disturbance: float = 0.0) -> Simulation:
    rules = load_world_file(find_task("serve_breakfast").world, task)
    return Simulation(task, rules, failure=failure, disturbance=disturbance, seed=11)


@pytest.fixture
def world(task: Task) -> Iterator[KitchenWorld]:
    made = KitchenWorld(_simulation(task))
    yield made
    made.close()
    made.close()


def _action(task: Task, text: str) -> Action:
    name, *arguments = text.replace("(", " ").replace(")", " ").replace(",", " ").split()
    return task.action(name, arguments)


def test_it_is_a_world_that_can_be_restored(world: KitchenWorld) -> None:
    assert isinstance(world, World)
    assert isinstance(world, Restorable)
    assert world.views()[0] == "front"
    assert {"left", "right", "overview"} <= set(world.views())


def test_acting_changes_the_truth_and_the_picture(world: KitchenWorld, task: Task) -> None:
    before = world.observe()
    assert world.execute(_action(task, "find(bread, sink)")).report is Report.DONE
    assert world.execute(_action(task, "pick_up(bread, counter, left)")).report is Report.DONE
    after = world.observe()
    assert after.frames["front"].data != before.frames["front"].data
    held = Atom("in_hand", ("bread", "left"))
    assert world.truth.holds(held)
    assert world.truth.visible(held)


def test_every_view_gives_its_picture(world: KitchenWorld) -> None:
    for view in world.views():
        observation = world.observe(view)
        assert list(observation.frames) == [view]
        assert observation.frames[view].pixels.shape == (224, 224, 3)
    with pytest.raises(UnknownNameError, match="front"):
        world.observe("fornt")


def test_cancelled_or_late_before_the_start_changes_nothing(
    world: KitchenWorld, task: Task
) -> None:
    state = world.simulation.state
    cancel = Event()
    cancel.set()
    find = _action(task, "find(bread, sink)")
    assert world.execute(find, cancel=cancel).report is Report.CANCELLED
    assert world.execute(find, deadline=0.0).report is Report.LATE
    assert world.simulation.state == state


def test_a_restored_world_is_the_unbroken_one(task: Task) -> None:
    def drop(world: KitchenWorld) -> None:
        world.execute(_action(task, "find(bread, sink)"))
        world.execute(_action(task, "pick_up(bread, counter, left)"))
        floor = Atom("on", ("bread", "floor"))
        held = {Atom("in_hand", ("bread", "left"))}
        simulation = world.simulation
        simulation.state = (simulation.state - held) | {floor, Atom("free", ("left",))}
        world.execute(_action(task, "find(plate, bread)"))
        world.execute(_action(task, "find(bread, plate)"))

    first = KitchenWorld(_simulation(task))
    drop(first)
    kept = json.loads(json.dumps(first.snapshot()))
    expected = first.observe().frames["front"].data
    first.close()
    second = KitchenWorld(_simulation(task))
    second.restore(kept)
    assert second.observe().frames["front"].data == expected
    second.close()


def test_a_specification_names_the_split(task: Task) -> None:
    made = KitchenWorld.from_spec("held_out", simulation=_simulation(task))
    assert made.scene.split == "held_out"
    made.close()
    with pytest.raises(PluginError, match="held_out"):
        KitchenWorld.from_spec("everything", simulation=_simulation(task))
