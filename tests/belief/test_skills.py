"""How often single skills fail, and which seem dead."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.learned import Learned
from tpvqa.belief.learning.skills import GIVEN_UP, NAMED
from tpvqa.pddl import Action, Atom, Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

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


def test_tries_in_vain_are_those_of_what_may_be_dead(kitchen: Task) -> None:
    """With whatever, as long as none has worked; else with the hand, or the thing, with which none
    has."""
    chances, apple, knife = Chances(), grasp(kitchen), grasp(kitchen, "knife", "left", "counter")
    for action in (apple, apple, knife):
        chances.learn(FAILED, action)
    assert {chances.skill(action).vain for action in (apple, knife)} == {3.0}
    chances.learn(WORKED, knife)
    assert chances.skill(apple).vain == 2.0
    assert chances.skill(knife).vain == 1.0
    assert chances.skill(grasp(kitchen, "apple", "right", "floor")).vain == 2.0
    assert chances.skill(grasp(kitchen, "plate", "right", "floor")).vain == 0.0
    for action in (apple, grasp(kitchen, "plate", "left", "counter")):
        chances = Chances()
        chances.learn(WORKED, grasp(kitchen, "knife", "right", "counter"))
        for _ in range(3):
            chances.learn(FAILED, action)
            chances.learn(FAILED, grasp(kitchen, "knife", "left", "counter"))
        assert chances.skill(action).vain == 6.0  # the left hand


def test_actions_that_differ_in_what_the_skill_does_not_take_are_one_skill() -> None:
    files = find_task("eat_apple")
    task = load_task(files.domain, files.problem)
    belief = Belief(FaultModel(task, load_world_file(files.world, task)))
    learned = Learned(Chances(), belief, trusts=False)
    found, same = (task.action("find", ("fridge", near)) for near in ("tv", "sink"))
    before = learned.skill(found)
    for _ in range(6):
        belief.act(found, Rates())
        belief.see((Atom("near", ("fridge",)),), 0.0, 1.0)
        learned.learn(found)
    assert learned.skill(found).dead > before.dead + 0.3
    assert learned.skill(same) == learned.skill(found)
    assert learned.times(same) == learned.times(found) == (6.0, 6.0)
    assert learned.skill(task.action("find", ("sink", "tv"))).dead < learned.skill(found).dead


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


@given(st.integers(0, 4), st.integers(0, 4))
def test_to_do_again_what_is_done_is_no_failure(failed: int, again: int) -> None:
    chances, action = Chances(), Action_("find")
    for came in (*[FAILED] * failed, WORKED, *[{"achieved": 1.0}] * again):
        chances.learn(came, action)
    assert chances.skills.times(action) == pytest.approx((failed + 1, failed))


def test_what_is_not_known_of_a_try_is_counted_by_halves() -> None:
    chances, action = Chances(), Action_("find")
    chances.learn({"failure": 0.5, "success": 0.5}, action)
    chances.learn({"failure": 0.25, "success": 0.25, "achieved": 0.5}, action)
    # Of four such, one failed twice, one the first time, and two worked at once.
    assert chances.skills.times(action) == pytest.approx((0.5 * 2 + 0.5, 0.25 * 2 + 0.25))
    assert chances.skills.tries(action) == 2


def test_tries_are_not_forgotten_once_an_action_could_not_be_done() -> None:
    chances, action = Chances(), Action_("find")
    for _ in range(3):
        chances.learn(FAILED, action)
    shares: list[dict[str, float]] = [FAILED]
    for came, other in (({}, action), *((WORKED, Action_(f"go{each}")) for each in range(6))):
        chances.learn(came, other, shares)
        shares = [came, *shares]
    assert chances.skills.times(action) == pytest.approx((3, 3))


def test_what_never_works_disturbs_nothing() -> None:
    chances, action = Chances(), Action_("turn")
    rates = [chances.rates_of(action).disturbance]
    for _ in range(12):
        chances.learn({**FAILED, "undisturbed": 1.0}, action)
        rates.append(chances.rates_of(action).disturbance)
    assert rates == sorted(rates, reverse=True)
    assert rates[0] > 0.9 * chances.rates.disturbance
    assert rates[-1] < 0.15 * chances.rates.disturbance
    assert chances.rates_of(Action_("push")).disturbance > 0.15  # others do, as before
