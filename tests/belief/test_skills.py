"""How often single skills fail, and which seem dead."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.chances import Chances
from tpvqa.belief.faults import Rates
from tpvqa.belief.skills import GIVEN_UP, NAMED
from tpvqa.pddl import Action, Task, load_task

FAILED, WORKED = {"failure": 1.0}, {"success": 1.0}


@pytest.fixture(scope="module")
def kitchen() -> Task:
    return load_task("eat_apple")


def grasp(task: Task, thing: str = "apple", hand: str = "left", place: str = "fridge") -> Action:
    return task.action("pick_up", (thing, place, hand))


def test_a_skill_that_always_fails_is_dead_within_eight_tries(kitchen: Task) -> None:
    chances, action, dead = Chances(), grasp(kitchen), []
    for _ in range(20):
        dead.append(chances.skill(action).dead)
        chances.learn(FAILED, action)
    assert dead == sorted(dead)
    assert dead[8] >= NAMED
    assert dead[4] < NAMED
    assert dead[-1] >= GIVEN_UP
    chances.learn(WORKED, action)
    assert chances.skill(action).dead < 0.01


def test_one_skill_that_is_dead_tells_little_of_the_others(kitchen: Task) -> None:
    chances = Chances()
    for _ in range(10):
        chances.learn(FAILED, grasp(kitchen))
    other = chances.skill(kitchen.action("open", ("fridge",)))
    assert other.dead < 0.06
    assert other.failure < 0.45


def test_what_fails_has_a_common_cause(kitchen: Task) -> None:
    chances = Chances()
    for thing, place in (("apple", "fridge"), ("knife", "counter")):
        for _ in range(5):
            chances.learn(FAILED, grasp(kitchen, thing, "left", place))
        chances.learn(WORKED, grasp(kitchen, thing, "right", place))
    assert chances.skill(grasp(kitchen, "apple", "left", "floor")).dead > NAMED  # the left hand
    assert chances.skill(grasp(kitchen, "apple", "right", "floor")).dead < 0.02


@given(st.floats(0.05, 0.95), st.integers(1, 6))
def test_what_was_not_seen_teaches_nothing(rate: float, tries: int) -> None:
    chances, action = Chances(Rates(rate, 0.25, 0.0)), Action_("go")
    before = chances.skill(action)
    for _ in range(tries):
        predicted = chances.skill(action).failure
        chances.learn({"failure": predicted, "success": 1 - predicted}, action)
        chances.learn({}, Action_("something else"))  # the run is over
    after = chances.skill(action)
    assert after.dead == pytest.approx(before.dead, abs=0.03)
    assert after.failure == pytest.approx(before.failure, abs=0.05)


def Action_(name: str) -> Action:  # noqa: N802
    from tpvqa.pddl import Conjunction

    return Action(name, (), Conjunction(()), ())
