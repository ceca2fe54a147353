"""What lies ahead where a skill is dead, plans are forgotten, or the floor bars a choice."""

import numpy as np

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.outlook import PLANS, Outlook
from tpvqa.belief.deciding.table import Choice, Table
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.skills import SkillState
from tpvqa.pddl import load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.planning.regression import regress

TASK = load_task("serve_breakfast")
PLAN = make_planner("fast-downward").plan(TASK, TASK.init, timeout=60)
assert isinstance(PLAN, Plan)
ACTIONS = PLAN.actions


def _outlook(failure: float = 1.0) -> Outlook:
    model = FaultModel(TASK)
    return Outlook(model, Costs(failure=failure), Sight(model))


def _known(first: int = 0) -> AnnotatedPlan:
    state = TASK.init
    for action in ACTIONS[:first]:
        state = TASK.apply(state, action)
    return AnnotatedPlan(TASK, ACTIONS[first:], regress(TASK, ACTIONS[first:], state))


def test_a_task_stays_as_dear_when_its_long_plans_are_forgotten() -> None:
    ahead = _outlook()
    ahead.add(_known())
    dear = ahead.failure
    for _ in range(PLANS):
        ahead.add(_known(len(ACTIONS) - 1))
    assert len(ahead.plans) == PLANS
    assert ahead.failure == dear


def test_the_rest_of_a_way_is_not_paid_where_it_ends_at_a_dead_skill() -> None:
    ahead = _outlook(failure=50.0)
    plan = _known()
    ahead.add(plan)
    dead = SkillState(0.9, 0.85, 1.3, 0.85, 0.85)
    alive = SkillState(0.25, 0.0, 1.3)
    ahead.learned(lambda action: dead if action == ACTIONS[0] else alive, Rates())
    after = ahead.rest(1, plan)
    assert ahead.rest(0, plan) < ahead.failure < 0.85 * ahead.failure + after + 10
    assert ahead.rest(0, plan) > 0.85 * ahead.failure


def test_what_has_to_be_done_unseen_is_not_worth_more_tries_in_vain() -> None:
    ahead = _outlook(failure=50.0)
    ahead.add(_known())
    tries = [SkillState(0.99, 0.97, 1.3, 0.97, 0.97, vain=vain) for vain in (19.0, 20.0)]
    for settles in (1.0, 0.1):
        ahead.may_be_blind(settles)
        for tried, given_up in zip(tries, (False, True), strict=True):
            ahead.learned({ACTIONS[0]: tried}.__getitem__, Rates())
            assert ahead.given_up(ACTIONS[0]) is given_up
    assert ahead.dearer > 2


def test_what_no_try_can_show_is_given_up_after_twice_as_many() -> None:
    """Where it is doubtful throughout whether it could have worked, as in 236 tries of a trial."""
    ahead = _outlook(failure=50.0)
    ahead.add(_known())
    for vain, dead, given_up in ((39.0, 0.98, False), (40.0, 0.98, True), (99.0, 0.5, False)):
        tried = SkillState(0.99, dead, 1.3, 0.45, dead, vain=vain)
        ahead.learned({ACTIONS[0]: tried}.__getitem__, Rates())
        assert ahead.given_up(ACTIONS[0]) is given_up


def test_what_is_closed_is_not_chosen() -> None:
    done, other = Choice(None, TASK.init), Choice(ACTIONS[0], TASK.init)
    work = np.ones((2, 1, 2))
    work[1, 0, 0] = -0.1
    table = Table((other, done), (0,), np.ones(1), np.array([[1.0, 2.0]]), work)
    assert table.best is done
