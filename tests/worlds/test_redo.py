"""What comes of an action whose effects hold already: free, risky, refused."""

from collections import Counter

import pytest

from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.config.layers import Layer, combined
from tpvqa.episodes import MemoryWriter
from tpvqa.errors import ConfigError
from tpvqa.events.events import Acted
from tpvqa.pddl import Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds import Report
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.simulation import Redo, Simulation
from tpvqa.worlds.world_file import load_world_file


@pytest.fixture(scope="module")
def task() -> Task:
    return load_task("clean_dishes")


def redone(task: Task, redo: str, failure: float) -> Counter[tuple[Failure | None, bool]]:
    """How a plate that is held already is picked up again in a hundred episodes."""
    rules = load_world_file(find_task("clean_dishes").world, task)
    pick = task.action("pick_up", ("plate", "table", "left"))
    counted: Counter[tuple[Failure | None, bool]] = Counter()
    for episode in range(100):
        simulation = Simulation(
            task, rules, failure=failure, disturbance=0.5, redo=redo, episode=episode
        )
        simulation.state = task.apply(
            task.apply(task.init, task.action("find", ("plate", "tv"))), pick
        )
        outcome = simulation.execute(pick)
        counted[outcome.failure, outcome.undone is not None] += 1
    return counted


def test_free_redoing_changes_and_risks_nothing(task: Task) -> None:
    assert redone(task, "free", 1.0) == {(None, False): 100}


def test_risky_redoing_fails_as_any_action_and_may_undo_what_was_done(task: Task) -> None:
    counted = redone(task, "risky", 0.5)
    assert counted.keys() == {(None, False), (Failure.CHANCE, False), (Failure.CHANCE, True)}
    assert 30 <= counted[None, False] <= 70
    assert counted[Failure.CHANCE, True] >= 10


def test_preconditions_of_risky_redoing_are_waived(task: Task) -> None:
    assert redone(task, "risky", 0.0) == {(None, False): 100}  # the plate is not on the table


def test_refused_redoing_is_reported_by_the_skill(task: Task) -> None:
    assert redone(task, "refused", 1.0) == {(Failure.REFUSED, False): 100}
    writer = MemoryWriter()
    config = configured(
        task="clean_dishes", monitor="blind:2", world="symbolic", redo="refused", failure=0.0
    )
    with Trial(config) as trial:
        trial.run(writer)
    reports = [event.report for event in writer.events if isinstance(event, Acted)]
    assert reports == [Report.DONE, Report.FAILED] * 4


def test_the_default_is_the_best_reading_for_who_repeats_blindly(task: Task) -> None:
    assert Simulation(task).redo is Redo.FREE
    key = ("simulation", "redo")
    with pytest.raises(ConfigError, match="--redo"):
        combined([Layer({key: "often"}, {key: "--redo"})])
