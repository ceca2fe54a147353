"""Things that people move while the robot works."""

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tpvqa.pddl import Atom, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.elsewhere import places_of
from tpvqa.worlds.people import somebody_moves
from tpvqa.worlds.simulation import Simulation
from tpvqa.worlds.world_file import load_world_file

TASK = load_task("serve_breakfast")
RULES = load_world_file(find_task("serve_breakfast").world, TASK)
ACTIONS = [TASK.action(name, tuple(arguments)) for name, *arguments in TASK.reachable_actions]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_whoever_moves_something_changes_its_place_and_nothing_else(seed: int) -> None:
    world, draw = Simulation(TASK, RULES, failure=0, moved=1, seed=seed), Random(seed)
    for _ in range(8):
        action = draw.choice([each for each in ACTIONS if TASK.applicable(world.state, each)])
        outcome = world.execute(action)
        if outcome.undone is None:
            continue
        (gone, thing) = outcome.undone, outcome.undone.arguments[0]
        intended = TASK.apply(outcome.before, action)
        assert gone in intended - outcome.after
        (new,) = outcome.after - intended
        assert intended - outcome.after == {gone}
        assert {gone, new} <= set(places_of(TASK)[thing])
        assert Atom("near", (thing,)) not in outcome.after
        assert not [a for a in outcome.after if a.predicate == "on" and a.arguments[1] == thing]
        for group in TASK.mutex_groups:
            assert len(group.atoms & outcome.after) <= 1


@pytest.mark.parametrize("rate", [0.0, 0.3])
def test_things_are_moved_at_their_rate_and_the_same_for_every_monitor(rate: float) -> None:
    action = TASK.action("turn_on", ("tv",))  # not possible at first: nothing else happens
    worlds = [
        Simulation(TASK, RULES, failure=0, disturbance=0, moved=rate, seed=3) for _ in range(2)
    ]
    told = [[each.execute(action).undone for _ in range(400)] for each in worlds]
    assert told[0] == told[1]
    share = sum(each is not None for each in told[0]) / 400
    assert share == pytest.approx(rate, abs=0.09)


def test_nothing_is_moved_where_a_place_is_more_than_one_fact() -> None:
    tower = load_task("build_tower")
    assert somebody_moves(tower, tower.init, Random(0)) is None
