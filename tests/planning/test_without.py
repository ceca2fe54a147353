"""Plans without certain actions."""

import pytest

from tpvqa.pddl import Task, load_task, task_from_text
from tpvqa.pddl.validation import validate
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.planning.without import plan_without

DOMAIN = """; (:action ghost) in a comment
(define (domain rooms)
  (:predicates (at ?r) (door ?a ?b) (lit)) ; (:predicates)
  (:action GO :parameters (?a ?b) ; a parameter (of two)
    :precondition (and (at ?a) (door ?a ?b)) :effect (and (at ?b) (not (at ?a))))
  (:action light :parameters () :effect (lit)))
"""
PROBLEM = """(define (problem p) (:domain rooms) (:objects a b c d)
  (:init (at a) (door a b) (door b d) (door a c) (door c d)) (:goal (and (at d) (lit))))
"""


@pytest.fixture(scope="module")
def rooms() -> Task:
    return task_from_text(DOMAIN, PROBLEM)


def test_another_way_is_found_and_is_a_plan_of_the_task(rooms: Task, planner: Planner) -> None:
    first = planner.plan(rooms)
    assert isinstance(first, Plan)
    moved = next(each for each in first.actions if each.arguments[:1] == ("a",))
    other = plan_without(planner, rooms, rooms.init, [moved])
    assert isinstance(other, Plan)
    assert moved not in other.actions
    assert validate(rooms, other.actions).valid
    assert all(rooms.action(each.name, each.arguments) is each for each in other.actions)


def test_where_there_is_no_other_way_that_is_said(rooms: Task, planner: Planner) -> None:
    light = rooms.action("light")
    assert isinstance(plan_without(planner, rooms, rooms.init, [light]), Unsolvable)
    ways = [rooms.action("go", (place, "d")) for place in "bc"]
    assert isinstance(plan_without(planner, rooms, rooms.init, ways), Unsolvable)


def test_a_state_of_ones_own(rooms: Task, planner: Planner) -> None:
    state = rooms.init - {next(a for a in rooms.init if a.predicate == "at")}
    from tpvqa.pddl import Atom

    there = state | {Atom("at", ("b",))}
    back = plan_without(planner, rooms, there, [rooms.action("go", ("a", "b"))])
    assert isinstance(back, Plan)
    assert len(back.actions) == 2


def test_the_household(planner: Planner) -> None:
    task = load_task("eat_apple")
    plan = planner.plan(task)
    assert isinstance(plan, Plan)
    grasp = next(each for each in plan.actions if each.name == "pick_up")
    other = plan_without(planner, task, task.init, [grasp])
    assert isinstance(other, Plan)
    assert grasp not in other.actions
    assert validate(task, other.actions).valid
