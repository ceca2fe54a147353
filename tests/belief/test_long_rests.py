"""Plans that are longer than they are followed exactly: what their rest costs, and how many actions
are left for it."""

import pytest

from tests.belief.test_steps import PACKING, PICTURES, STUDIO
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.deciding.long_rests import LongRests
from tpvqa.belief.deciding.outlook import Outlook
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.filtering.sight import Sight
from tpvqa.belief.learning.chances import Chances
from tpvqa.pddl import Action, Task, task_from_text
from tpvqa.planning.regression import regress

RATES = Rates(0.25, 0.25, 0.0)


def packing() -> tuple[Task, tuple[Action, ...]]:
    task = task_from_text(STUDIO, PICTURES)
    words = (line.split() for line in PACKING.split(","))
    return task, tuple(task.action(name, arguments) for name, *arguments in words)


@pytest.mark.parametrize("place", [0, 4, 8])
def test_the_rest_of_a_plan_is_worth_about_what_it_does(place: int) -> None:
    """What is undone and brought about again by the plan itself is not lost."""
    task, actions = packing()
    state = task.init
    for action in actions[:place]:
        state = task.apply(state, action)
    plan = AnnotatedPlan(task, actions, regress(task, actions, task.init))
    model, costs = FaultModel(task), Costs(failure=1000)
    ahead = Outlook(model, costs, Sight(model))
    ahead.add(plan)
    ahead.learned(Chances(RATES).skill, RATES)
    belief = Belief(model, state, smallest=1e-7, most=2000)
    number = next(iter(belief.weights))
    rests = LongRests(model, ahead, costs)
    left = rests.of(plan, place, [number])[0]
    times = rests.repeated(plan, place)
    for action in actions[place:]:
        for _ in range(times):
            belief.act(action, RATES)
    told = 1 - (left - times * len(actions[place:])) / ahead.failure
    assert told == pytest.approx(belief.where(task.goal_holds), rel=0.15)


@pytest.mark.parametrize("left", [30, 45])
def test_who_has_few_actions_left_does_each_step_less_often(left: int) -> None:
    task, actions = packing()
    model = FaultModel(task)
    chooser, belief = Chooser(model, Costs()), Belief(model)
    chooser.ahead.add(AnnotatedPlan(task, actions, regress(task, actions, task.init)))
    chooser.settles, chooser.blind = 0.0, True
    chooser.ahead.learned(Chances(RATES).skill, RATES)
    done = 0
    while True:
        chooser.ahead.allow(left - done)
        action = chooser.table(belief, RATES, actions).best.action
        if action is None:
            break
        chooser.acted(belief, action)
        belief.act(action, RATES)
        done += 1
    blind = Belief(model)
    for action in actions:
        for _ in range(left // len(actions)):
            blind.act(action, RATES)
    assert done <= left
    assert belief.where(task.goal_holds) >= blind.where(task.goal_holds) - 0.01
