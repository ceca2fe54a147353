"""What is done unseen, changed as long as that makes it cheaper."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.belief.test_belief import plan_of
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.improving import Improving
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.deciding.steps import Steps
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.chances import Chances
from tpvqa.pddl import Action, Task, load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

COSTS = Costs()


@pytest.fixture(scope="module", params=["clean_dishes", "serve_breakfast"])
def task(request: pytest.FixtureRequest) -> Task:
    return load_task(request.param)


@pytest.fixture(scope="module")
def model(task: Task) -> FaultModel:
    return FaultModel(task, load_world_file(find_task(task.name).world, task))


def paid(model: FaultModel, actions: tuple[Action, ...], rates: Rates) -> float:
    """What some actions cost, with the failed task, by the filter that predicts forward."""
    belief = Belief(model, smallest=0.0, most=100_000)
    for action in actions:
        belief.act(action, rates)
    return len(actions) * COSTS.action + COSTS.failure * (1 - belief.where(model.task.goal_holds))


def improved(
    model: FaultModel, actions: tuple[Action, ...], rates: Rates, most: int | None = None
) -> tuple[Action, ...]:
    ahead = Outlook(model, COSTS, Sight(model))
    ahead.learned(Chances(rates).skill, rates)
    steps, plan = Steps(model), tuple(plan_of(model.task))
    (begun,) = Belief(model).weights
    steps.cover({begun: 1.0}, [plan], rates)
    masses = np.zeros(len(steps.numbers) + 1)
    masses[steps.place[begun]] = 1.0
    goals = [0.0 if model.goal_holds(n) else COSTS.failure for n in steps.numbers]
    after = np.array([*goals, COSTS.failure])
    return Improving(steps, ahead, COSTS.action).improved(actions, [plan], masses, after, most)


@settings(max_examples=12, deadline=None)
@given(data=st.data(), redone=st.sampled_from([0.0, 0.1]))
def test_it_never_costs_more_than_before(
    model: FaultModel, data: st.DataObject, redone: float
) -> None:
    plan, rates = plan_of(model.task), Rates(0.25, 0.25, 0.0, redone)
    actions = tuple(data.draw(st.lists(st.sampled_from(plan), max_size=12)))
    better = improved(model, actions, rates)
    assert paid(model, better, rates) <= paid(model, actions, rates) + 0.5


def test_a_step_that_is_missing_is_put_in(model: FaultModel) -> None:
    plan, rates = tuple(plan_of(model.task)), Rates(0.0, 0.0, 0.0)
    assert paid(model, plan[1:], rates) > COSTS.failure
    better = improved(model, plan[1:], rates)
    assert paid(model, better, rates) == pytest.approx(len(plan) * COSTS.action)


def test_what_is_done_for_nothing_is_left_out(model: FaultModel) -> None:
    plan, rates = tuple(plan_of(model.task)), Rates(0.0, 0.0, 0.0)
    twice = tuple(action for action in plan for _ in range(3))
    assert improved(model, twice, rates) == plan


def test_there_are_no_more_actions_than_are_left(model: FaultModel) -> None:
    plan, rates = tuple(plan_of(model.task)), Rates(0.25, 0.25, 0.0)
    assert len(improved(model, plan, rates)) > len(plan) + 2
    assert len(improved(model, plan, rates, len(plan) + 2)) == len(plan) + 2
