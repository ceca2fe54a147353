"""What is counted of faults in some trials, and what is believed in the next."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.calibrating.counted import (
    Came,
    CountedFaults,
    LabelledAct,
    SkillCount,
    count_faults,
)
from tpvqa.belief.filtering.faults import Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.experience import Experience
from tpvqa.belief.learning.skills import ALIKE, NAMED
from tpvqa.belief.learning.spread import TRIES, alike
from tpvqa.monitors.belief_settings import BeliefSettings
from tpvqa.pddl import Action, Conjunction

GRASP, PUSH, NEVER_SEEN = (
    Action(name, (), Conjunction(()), ()) for name in ("grasp", "push", "turn")
)


def acts(action: str, failed: int, worked: int) -> list[LabelledAct]:
    came = [Came.FAILURE] * failed + [Came.SUCCESS] * worked
    return [LabelledAct(f"{n % 10}", action, each, None) for n, each in enumerate(came)]


def test_actions_are_counted_by_skill_and_by_what_came_undone() -> None:
    told = [
        *acts("grasp", 3, 7),
        LabelledAct("0", "grasp", Came.IMPOSSIBLE, undone=True),
        LabelledAct("0", "grasp", Came.FAILURE, undone=False),
        LabelledAct("0", "push", Came.SUCCESS, undone=False),
        LabelledAct("0", "push", Came.ACHIEVED, undone=True),
    ]
    assert count_faults(told) == CountedFaults(
        skills={
            "grasp": SkillCount(failed=4, worked=7, together=((0, 1, 7), (1, 0, 2), (2, 0, 1))),
            "push": SkillCount(failed=0, worked=1, together=((0, 1, 1),)),
        },
        disturbance=(1, 1),
        spontaneous=(0, 1),
        redone=(1, 0),
    )
    assert count_faults([]) is None


def test_each_skill_is_believed_to_fail_as_often_as_it_did() -> None:
    chances = Chances(counted=count_faults([*acts("grasp", 80, 20), *acts("push", 0, 100)]))
    unknown = Chances()
    expected = [chances.skill(each).failure for each in (GRASP, NEVER_SEEN, PUSH)]
    assert expected[0] == pytest.approx(0.75, abs=0.05)
    assert expected[2] < 0.1
    assert expected[2] < unknown.skill(PUSH).failure < expected[1] < expected[0]


def test_a_skill_that_breaks_is_noticed_however_often_it_has_worked() -> None:
    chances, unknown = Chances(counted=count_faults(acts("grasp", 300, 900))), Chances()
    assert chances.skill(GRASP).dead == unknown.skill(GRASP).dead
    tries = 0
    while chances.skill(GRASP).dead < 0.9:
        chances.learn({"failure": 1.0}, GRASP)
        tries += 1
    assert 3 <= tries <= 10


def test_tries_are_counted_by_trial_and_by_what_was_done_with_them() -> None:
    told = [
        LabelledAct(trial, "grasp", came, None, (what,))
        for trial, what, came in [
            ("0", "cup", Came.FAILURE),
            ("0", "cup", Came.SUCCESS),
            ("0", "jug", Came.FAILURE),
            ("0", "cup", Came.ACHIEVED),
            ("1", "cup", Came.FAILURE),
        ]
    ]
    counted = count_faults(told)
    assert counted is not None
    assert counted.skills["grasp"].together == ((1, 0, 2), (1, 1, 1))
    assert CountedFaults.model_validate_json(counted.model_dump_json()) == counted


def test_where_a_failure_says_nothing_of_the_next_try_the_mean_is_worth_more() -> None:
    """A quarter fails in both: each try by itself, or all tries of some trials."""
    fresh = SkillCount(failed=100, worked=300, together=((0, 2, 113), (1, 1, 74), (2, 0, 13)))
    stuck = SkillCount(failed=100, worked=300, together=((0, 2, 145), (1, 1, 10), (2, 0, 45)))
    told, same = alike(fresh), alike(stuck)
    assert told is not None
    assert same is not None
    assert ALIKE <= same < ALIKE + 0.5
    assert told > 20
    assert alike(SkillCount(failed=100, worked=300)) is None


def test_a_skill_that_was_counted_is_named_after_as_many_tries_whatever_its_rate() -> None:
    """A third failed by chance where a quarter would; tails of what may be do not delay it."""
    trials = ((0, 1, 50), (1, 0, 12), (1, 1, 34), (2, 0, 3))
    count = SkillCount(failed=52, worked=84, together=trials)
    chances = Chances(counted=CountedFaults(skills={"grasp": count}))
    blurred = Chances(
        counted=CountedFaults(skills={"grasp": count.model_copy(update={"together": ()})})
    )
    tries = 0
    while chances.skill(GRASP).dead < NAMED:
        for each in (chances, blurred):
            each.learn({"failure": 1.0}, GRASP)
        tries += 1
    assert 4 <= tries <= 8
    assert blurred.skill(GRASP).dead < NAMED


@given(st.lists(st.tuples(st.integers(0, 50), st.integers(0, 50), st.integers(0, 10**6))))
def test_the_mean_is_worth_as_many_tries_as_it_may_be(told: list[tuple[int, int, int]]) -> None:
    failed, worked = (sum(each[way] * each[2] for each in told) for way in (0, 1))
    found = alike(SkillCount(failed=failed, worked=worked, together=tuple(told)))
    assert found is None if not told else ALIKE - 1e-6 <= (found or 0) <= max(TRIES) + 1e-6


def test_what_was_tried_once_says_little_of_any_skill() -> None:
    often = [*acts("grasp", 5, 15), *acts("push", 5, 15)]
    chances = Chances(counted=count_faults([*often, *acts("turn", 1, 0)]))
    assert chances.rates.failure < 0.3
    assert chances.skill(NEVER_SEEN).failure < 0.4


@given(st.integers(0, 10**9), st.integers(0, 10**9))
def test_whatever_was_counted_probabilities_lie_between_none_and_all(
    failed: int, worked: int
) -> None:
    count = SkillCount(failed=failed, worked=worked)
    cases = failed, worked
    chances = Chances(
        counted=CountedFaults(
            skills={"grasp": count}, disturbance=cases, spontaneous=cases, redone=cases
        )
    )
    for action in (GRASP, PUSH):
        state, rates = chances.skill(action), chances.rates_of(action)
        assert 0 < state.dead < 1
        told = rates.failure, rates.disturbance, rates.spontaneous, rates.redone
        assert all(0 < rate < 1 for rate in told)
        chances.learn({"failure": 0.4, "success": 0.6}, action)
        assert 0 < chances.skill(action).failure < 1


def test_what_is_stated_goes_before_what_was_counted() -> None:
    counted = count_faults(acts("grasp", 80, 20))
    stated = BeliefSettings.parse("failure_rate=0.1").chances(counted, None)
    assert stated.skill(GRASP).failure == Chances(Rates(failure=0.1)).skill(GRASP).failure
    other = BeliefSettings.parse("disturbance_rate=0.1").chances(counted, None)
    assert other.skill(GRASP).failure > 0.6
    assert other.rates.disturbance == pytest.approx(0.1)


def test_what_a_robot_has_learned_since_goes_before_common_rates_alone() -> None:
    counted = count_faults(acts("grasp", 80, 20))
    since = Experience.of(Chances(Rates(failure=0.05), strength=500), None, 40)
    chances = BeliefSettings().chances(counted, since)
    assert chances.rates.failure == pytest.approx(0.05, abs=0.01)
    assert chances.skill(GRASP).failure > 0.6
    assert chances.skill(NEVER_SEEN).failure < 0.15
