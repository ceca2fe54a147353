"""Where in a plan a state stands."""

from collections.abc import Iterator
from random import Random

import pytest

from tests.planning.random_states import scrambled, walk
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.pddl import Task, literals
from tpvqa.pddl.validation import validate
from tpvqa.planning import Plan, Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.regression import regress


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = FastDownward()
    yield planner
    planner.close()


@pytest.fixture
def annotated(task: Task, planner: Planner) -> AnnotatedPlan:
    plan = planner.plan(task)
    assert isinstance(plan, Plan)
    return AnnotatedPlan(task, plan.actions, regress(task, plan.actions))


def test_from_its_place_the_plan_reaches_the_goal_from_any_state(
    task: Task, annotated: AnnotatedPlan
) -> None:
    placed = 0
    for seed in range(400):
        random = Random(seed)
        state = walk(task, random, seed % 9) if seed % 2 else scrambled(task, random)
        place = annotated.place(state)
        if place is not None:
            placed += 1
            replay = validate(task, annotated.actions[place:], state)
            assert replay.valid, (seed, place, str(replay))
            assert annotated.remaining(state) == len(annotated.actions) - place
    assert placed > 5


def test_along_the_plan_every_state_stands_at_its_step(
    task: Task, annotated: AnnotatedPlan
) -> None:
    state = task.init
    for index, action in enumerate(annotated.actions):
        assert annotated.place(state) == index
        state = task.apply(state, action)
    assert annotated.place(state) == len(annotated.actions)


def test_what_is_already_done_is_passed_over(task: Task, annotated: AnnotatedPlan) -> None:
    """All but the last step's work is there already: go on from the last step."""
    state = validate(task, annotated.actions).states[-2]
    assert annotated.remaining(state) == 1


def test_the_step_that_needs_a_fact_is_named(task: Task, annotated: AnnotatedPlan) -> None:
    last = len(annotated.actions)
    for literal in annotated.needs[last]:
        assert annotated.needing(literal.atom, 0) is not None
    mentioned = {each.atom for act in annotated.actions for each in literals(act.precondition)}
    for atom in task.atoms() - annotated.atoms() - mentioned:
        assert annotated.needing(atom, 0) is None
