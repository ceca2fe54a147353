"""A simulated world in which actions last: its clock, and what befalls what runs."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pddl.test_durative import DOMAIN, PROBLEM
from tpvqa.pddl import Action, Atom, Task, task_from_text
from tpvqa.pddl.pattern import Pattern
from tpvqa.worlds.outcome import Failure
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.symbolic import SymbolicWorld
from tpvqa.worlds.undo import Reversal, UndoRule

SHUT = Atom("shut")


@pytest.fixture(scope="module")
def task() -> Task:
    return task_from_text(DOMAIN, PROBLEM)


def simulation(task: Task, *, interruption: float = 0.0, seed: int = 0) -> Simulation:
    opens = UndoRule(Pattern.parse("(shut)", task), (Reversal("it opens", None, (), (), (), ()),))
    return Simulation(task, failure=0.0, interruption=interruption, undoing=(opens,), seed=seed)


def fire(task: Task, part: str) -> Action:
    return task.action(f"{part}-fire", ["vase"])


def test_an_action_ends_at_its_time_and_not_before(task: Task) -> None:
    text = DOMAIN.replace("(at start (not (at ?p))) ", "")
    task = task_from_text(text, PROBLEM)
    here = simulation(task)
    here.execute(task.action("close"))
    assert here.execute(fire(task, "start")).succeeded
    here.wait(5.9)
    assert here.execute(fire(task, "end")).failure is Failure.PRECONDITION
    here.wait(6.0)
    assert here.execute(fire(task, "end")).succeeded
    assert Atom("fired", ("vase",)) in here.state
    assert Atom("running-fire", ("vase",)) not in here.state


def test_what_lacks_what_it_needs_stops_as_if_it_were_cancelled(task: Task) -> None:
    here = simulation(task, interruption=1.0)
    here.execute(task.action("close"))
    before = here.state
    here.execute(fire(task, "start"))
    outcome = here.wait(6.0)
    assert outcome is not None
    assert (outcome.undone, outcome.undoing) == (SHUT, "it opens")
    assert here.state == before - {SHUT}
    assert here.execute(fire(task, "end")).failure is Failure.PRECONDITION
    assert here.execute(fire(task, "cancel")).after == here.state


def test_nothing_befalls_what_was_cancelled_in_time(task: Task) -> None:
    for seed in range(5):
        here = simulation(task, interruption=1.0, seed=seed)
        here.execute(task.action("close"))
        here.execute(fire(task, "start"))
        here.execute(fire(task, "cancel"))
        assert here.wait(100.0) is None
        assert SHUT in here.state


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 1000),
    waits=st.lists(st.floats(0.1, 4), min_size=1, max_size=5),
    cut=st.integers(0, 5),
)
def test_put_back_a_world_goes_on_as_it_would_have(
    task: Task, seed: int, waits: list[float], cut: int
) -> None:
    def begun() -> SymbolicWorld:
        world = SymbolicWorld(simulation(task, interruption=0.7, seed=seed))
        world.execute(task.action("close"))
        world.execute(fire(task, "start"))
        return world

    whole, broken, clock = begun(), begun(), 0.0
    for number, step in enumerate(waits):
        if number == cut:
            kept = json.loads(json.dumps(broken.snapshot()))
            broken = SymbolicWorld(simulation(task, interruption=0.7, seed=seed))
            broken.restore(kept)
        clock += step
        assert whole.wait(clock) == broken.wait(clock) == clock
        assert whole.simulation.state == broken.simulation.state


@pytest.mark.parametrize(
    "change",
    [
        {"clock": "soon"},
        {"clock": float("inf")},
        {"runs": [["(end-fire vase)", 0, None, 0, 0]]},
        {"runs": [["(start-fire vase)", 0, None, 0, 2]]},
    ],
)
def test_a_damaged_snapshot_changes_nothing(task: Task, change: dict[str, object]) -> None:
    here = simulation(task)
    assert here.running is not None
    kept = here.running.snapshot()
    with pytest.raises(ValueError):  # noqa: PT011  any of them
        here.running.restore({**kept, **change})
    assert here.running.snapshot() == kept


def test_a_look_and_stopping_what_does_not_run_move_nothing(task: Task) -> None:
    here = Simulation(task, failure=1.0, disturbance=1.0, seed=0)
    for part in ("while", "cancel", "end"):
        outcome = here.execute(fire(task, part))
        assert (outcome.after, outcome.undone) == (outcome.before, None)
