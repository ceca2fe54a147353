"""Problems of the unified-planning library."""

import subprocess
import sys
from typing import Any

import pytest

from tpvqa.errors import PDDLError, PlannerError
from tpvqa.pddl import validate
from tpvqa.planning import Crashed, Plan, Unsolvable
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.unified import sequential_plan, task_from_problem

shortcuts = pytest.importorskip("unified_planning.shortcuts")


def robot() -> Any:
    """A robot that moves between places and may carry one thing."""
    up = shortcuts
    place, thing = up.UserType("Place"), up.UserType("Thing")
    here = up.Fluent("here", up.BoolType(), p=place)
    at = up.Fluent("at", up.BoolType(), x=thing, p=place)
    held = up.Fluent("held", up.BoolType(), x=thing)
    move = up.InstantaneousAction("move", a=place, b=place)
    move.add_precondition(here(move.a))
    move.add_precondition(up.Not(up.Equals(move.a, move.b)))
    move.add_effect(here(move.a), False)
    move.add_effect(here(move.b), True)
    take = up.InstantaneousAction("take", x=thing, p=place)
    take.add_precondition(up.And(here(take.p), at(take.x, take.p)))
    take.add_effect(at(take.x, take.p), False)
    take.add_effect(held(take.x), True)
    problem = up.Problem("errand")
    for fluent in (here, at, held):
        problem.add_fluent(fluent, default_initial_value=False)
    problem.add_actions([move, take])
    home, shop = problem.add_object("home", place), problem.add_object("shop", place)
    milk = problem.add_object("milk", thing)
    problem.set_initial_value(here(home), True)
    problem.set_initial_value(at(milk, shop), True)
    problem.add_goal(up.And(held(milk), here(home)))
    return problem


def test_a_problem_becomes_a_task_that_can_be_planned() -> None:
    task = task_from_problem(robot())
    plan = FastDownward(search="optimal").plan(task)
    assert isinstance(plan, Plan)
    expected = ["move(home, shop)", "take(milk, shop)", "move(shop, home)"]
    assert [str(action) for action in plan.actions] == expected
    assert validate(task, plan.actions).valid


def test_what_pddl_cannot_say_is_refused() -> None:
    problem = robot()
    place = problem.user_type("Place")
    home = shortcuts.Fluent("dwelling", place)
    problem.add_fluent(home, default_initial_value=problem.object("home"))
    problem.action("move").add_precondition(shortcuts.Equals(home, home))
    with pytest.raises(PDDLError):
        task_from_problem(problem)


def test_the_extra_is_named_where_it_is_missing() -> None:
    script = (
        "import sys; sys.modules['unified_planning'] = None\n"
        "from tpvqa.planning.unified import task_from_problem\n"
        "task_from_problem(None)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert "pip install -e 'packages/tpvqa[up]'" in done.stderr


@pytest.mark.parametrize("kind", [Unsolvable, Crashed])
def test_what_is_no_plan_is_not_handed_over(kind: Any) -> None:
    with pytest.raises(PlannerError, match=r"no plan to hand over.*it broke.*isinstance"):
        sequential_plan(shortcuts.Problem("x"), kind("it broke", "clingo", 0.1))


def test_problems_whose_actions_last_are_out() -> None:
    action = shortcuts.DurativeAction("wait")
    action.set_fixed_duration(3)
    problem = shortcuts.Problem("x")
    problem.add_action(action)
    with pytest.raises(PDDLError, match=r"actions last.*write it as PDDL files"):
        task_from_problem(problem)
