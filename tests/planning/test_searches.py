"""Searches that follow one another, and one that has read the task before it is asked."""

import importlib.util
from pathlib import Path
from random import Random
from types import ModuleType

import pytest

from tests.planning.families import OPENSTACKS, PRINTER, VISIT, openstacks, printer, visit
from tests.planning.judges import val_accepts
from tests.planning.random_states import walk
from tpvqa.errors import PluginError
from tpvqa.pddl import Atom, Task, load_task, task_from_text
from tpvqa.planning import Plan, TimedOut, Unsolvable, fast_downward
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.tasks import find_task

FF_ALONE = {"simple": fast_downward._FF, "other": fast_downward._FF}


@pytest.mark.parametrize(
    ("domain", "problem"),
    [(OPENSTACKS, openstacks(25)), (PRINTER, printer(8, seed=1)), (VISIT, visit(20))],
    ids=["stacks", "printer", "unit"],
)
def test_lama_finds_what_ff_alone_does_not(
    domain: str, problem: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    task = task_from_text(domain, problem)
    planner = FastDownward()
    plan = planner.plan(task, timeout=20)
    assert isinstance(plan, Plan)
    assert task.goal_holds(_end(task, plan))
    with monkeypatch.context() as patched:
        patched.setattr(fast_downward, "_searches", lambda *_: FF_ALONE)
        assert isinstance(planner.plan(task, timeout=3), TimedOut)


def _end(task: Task, plan: Plan) -> frozenset[Atom]:
    state = task.init
    for action in plan.actions:
        assert task.applicable(state, action)
        state = task.apply(state, action)
    return state


def test_anytime_ends_by_itself_where_no_plan_is_better() -> None:
    task = load_task("eat_apple")
    plan = FastDownward(search="anytime", improving=30).plan(task)
    assert isinstance(plan, Plan)
    assert plan.cost == 7
    assert plan.seconds < 15


def test_anytime_uses_the_time_that_it_is_given_and_no_more() -> None:
    task = task_from_text(VISIT, visit(9))
    quick, better = FastDownward(), FastDownward.from_spec("anytime:2")
    assert better.name == "fast-downward:anytime:2"
    first, last = quick.plan(task, timeout=30), better.plan(task, timeout=30)
    assert isinstance(first, Plan)
    assert isinstance(last, Plan)
    assert last.cost < first.cost
    assert last.seconds < first.seconds + 4


@pytest.mark.parametrize("spec", ["anytime:", "anytime:soon", "lama:3", "optimal:2"])
def test_only_anytime_takes_seconds(spec: str) -> None:
    with pytest.raises(PluginError, match="fast-downward:anytime:SECONDS"):
        FastDownward.from_spec(spec)


@pytest.fixture(scope="module")
def household() -> Task:
    """So large that the next search reads it ahead, and not so large that anything is left out."""
    path = Path(__file__).parents[2] / "benchmarks" / "household_problems.py"
    spec = importlib.util.spec_from_file_location("household_problems", path)
    assert spec is not None
    assert spec.loader is not None
    module: ModuleType = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    domain = find_task("eat_apple").domain.read_text()
    return task_from_text(domain, module.household_problem(40))


def test_plans_do_not_depend_on_what_was_read_ahead(household: Task, tmp_path: Path) -> None:
    random = Random(3)
    states = [walk(household, random, 3) for _ in range(3)]
    anew = []
    for state in states:
        planner = FastDownward()
        anew.append(planner.plan(household, state))
        planner.close()
    planner = FastDownward()
    for _ in range(2):
        planner.plan(household)
    for state, first in zip(states, anew, strict=True):
        again = planner.plan(household, state)
        assert isinstance(again, Plan)
        assert isinstance(first, Plan)
        assert again.actions == first.actions
        assert val_accepts(household, state, again.actions, tmp_path)


def test_a_goal_that_is_met_or_out_of_reach_is_told_after_reading_ahead(household: Task) -> None:
    planner = FastDownward()
    plan = planner.plan(household)
    assert isinstance(plan, Plan)
    for _ in range(2):
        planner.plan(household)
    met = planner.plan(household, _end(household, plan))
    assert isinstance(met, Plan)
    assert met.actions == ()
    stuck = frozenset(atom for atom in household.init if atom.predicate != "free")
    assert isinstance(planner.plan(household, stuck), Unsolvable)
