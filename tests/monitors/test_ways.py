"""The plans that a belief monitor has the trial follow."""

from tpvqa.belief.belief import Belief
from tpvqa.belief.chances import Chances
from tpvqa.belief.choices import Chooser
from tpvqa.belief.costs import Costs
from tpvqa.belief.faults import FaultModel
from tpvqa.belief.learned import Learned
from tpvqa.monitors.ways import UNSEEN, Ways
from tpvqa.pddl import load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file


def test_a_new_plan_begins_with_what_was_chosen() -> None:
    """Or else the same would be chosen again, and a plan be made again, without end."""
    files = find_task("serve_breakfast")
    task = load_task(files.domain, files.problem)
    model = FaultModel(task, load_world_file(files.world, task))
    chances = Learned(Chances(), Belief(model), trusts=False)
    ways = Ways(task, Chooser(model, Costs()), chances, Costs())
    plan = make_planner("fast-downward").plan(task, task.init, timeout=60)
    assert isinstance(plan, Plan)
    (other,) = (
        each
        for each in task.ground_actions()
        if each.pddl() == "(find fridge sink)" and task.applicable(task.init, each)
    )
    assert other not in plan.actions
    assert ways.plan(task.init, other) is None  # no way is known yet
    ways.take(plan, task.init)
    assert ways.plan(task.init, plan.actions[0]) is plan
    found = ways.plan(task.init, other)
    assert found is not None
    assert (found.actions, found.planner) == ((other, *plan.actions), UNSEEN)
