"""Steps followed unseen: worked out backward they come to what the filter predicts forward."""

from math import isclose

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.belief.test_belief import plan_of
from tpvqa.belief.belief import Belief
from tpvqa.belief.faults import FaultModel, Rates
from tpvqa.belief.steps import Steps
from tpvqa.pddl import load_task
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

LOST = 100.0


@pytest.fixture(scope="module")
def model() -> FaultModel:
    files = find_task("clean_dishes")
    task = load_task(files.domain, files.problem)
    return FaultModel(task, load_world_file(files.world, task))


@settings(max_examples=15, deadline=None)
@given(
    times=st.lists(st.integers(0, 3), min_size=4, max_size=4),
    failure=st.floats(0.05, 0.6),
    disturbance=st.floats(0.0, 0.5),
    spontaneous=st.sampled_from([0.0, 0.05]),
    redone=st.sampled_from([0.0, 0.1]),
)
def test_what_is_paid_backward_is_what_is_lost_forward(
    model: FaultModel,
    times: list[int],
    failure: float,
    disturbance: float,
    spontaneous: float,
    redone: float,
) -> None:
    rates, plan = Rates(failure, disturbance, spontaneous, redone), plan_of(model.task)
    actions = [action for action, often in zip(plan, times, strict=False) for _ in range(often)]
    belief = Belief(model, smallest=0.0, most=100_000)
    (begun,) = belief.weights
    for action in actions:
        belief.act(action, rates)
    steps = Steps(model)
    steps.cover({begun: 1.0}, set(plan), rates)
    left = np.array([*(0.0 if model.goal_holds(n) else LOST for n in steps.numbers), LOST])[:, None]
    for action in reversed(actions):
        left = 1.0 + steps.back(action, left, failure, rates)
    lost = LOST * (1 - belief.where(model.task.goal_holds))
    told = float(left[steps.place[begun], 0])
    assert isclose(told, len(actions) + lost, rel_tol=0.01)


def test_what_is_not_told_apart_is_lost(model: FaultModel) -> None:
    steps, plan = Steps(model), plan_of(model.task)
    begun = next(iter(Belief(model).weights))
    steps.cover({begun: 1.0}, set(), Rates())
    assert steps.numbers == [begun]
    after = steps.back(plan[0], np.array([[0.0], [LOST]]), 0.25, Rates(0.25, 0.0, 0.0))
    assert isclose(float(after[0, 0]), 0.75 * LOST)
