"""The plans that a belief monitor has the trial follow."""

from types import SimpleNamespace
from typing import Any

import pytest

from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel
from tpvqa.belief.learning.chances import Chances
from tpvqa.belief.learning.learned import Learned
from tpvqa.bench.judge import CALLED_DEAD
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


def test_what_an_action_needs_is_doubted_the_more_the_longer_it_fails() -> None:
    """Once as soon as it looks as if it never worked, and again after several tries in vain."""
    task = load_task("eat_apple")
    model = FaultModel(task)
    belief = Belief(model)
    chances = Learned(Chances(), belief, trusts=False)
    ways = Ways(task, Chooser(model, Costs()), chances, Costs())
    fails = next(each for each in task.ground_actions() if each.name == "open")
    told = []
    for _ in range(12):
        chances.likeliest.learn({"failure": 1.0}, fails)
        told.append(ways.suspects(fails))
    given = [each for each in told if each]
    assert len(given) == 3
    assert given == sorted(given)
    assert given[0] < 0.5 < given[-1] <= 1.0


@pytest.mark.parametrize(
    ("able", "failed", "tries", "said"),
    [
        (12.0, 12.0, 12, "in about 12 of 12 tries"),
        (15.4, 15.2, 16, "in about 15 of 16 tries"),
        (15.9, 15.6, 16, "in about 16 of 16 tries"),
        (3.4, 3.2, 12, "in about 3 of 12 tries, of which about 3 could have worked"),
    ],
)
def test_how_often_a_skill_failed_is_said_as_what_is_believed(
    able: float, failed: float, tries: int, said: str
) -> None:
    """Which tries could have worked is never known for sure: no share of them counts as one."""
    task = load_task("eat_apple")
    chances: Any = SimpleNamespace(
        skill=lambda _: SimpleNamespace(shown=1.0),
        times=lambda _: (able, failed),
        tries=lambda _: tries,
    )
    ways = Ways(task, Chooser(FaultModel(task), Costs()), chances, Costs())
    action = next(each for each in task.ground_actions() if each.name == "open")
    step: Any = SimpleNamespace(
        action=action, book=SimpleNamespace(say=lambda _: "open the fridge")
    )
    assert ways.failing(step) == f"open the fridge failed {said}"
    assert CALLED_DEAD.match(ways.failing(step))  # a bench counts it by its words
