"""Action costs: what a plan costs, judged by VAL, and how near the searches come to the least."""

from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest

from tests.pddl.feature_domains import COSTS
from tests.planning.judges import least_cost, val_value
from tpvqa.pddl import Task, task_from_text
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import SEARCHES, FastDownward

COURIER = """(define (domain courier) (:requirements :typing :action-costs)
  (:types place thing)
  (:predicates (here ?p - place) (at ?x - thing ?p - place) (road ?a ?b - place)
    (carried ?x - thing) (hand))
  (:functions (distance ?a ?b - place) - number (total-cost) - number)
  (:action go :parameters (?a ?b - place) :precondition (and (here ?a) (road ?a ?b))
    :effect (and (here ?b) (not (here ?a)) (increase (total-cost) (distance ?a ?b))))
  (:action fly :parameters (?a ?b - place) :precondition (here ?a)
    :effect (and (here ?b) (not (here ?a)) (increase (total-cost) 50)))
  (:action take :parameters (?x - thing ?p - place)
    :precondition (and (here ?p) (at ?x ?p) (hand))
    :effect (and (carried ?x) (not (at ?x ?p)) (not (hand))))
  (:action put :parameters (?x - thing ?p - place) :precondition (and (here ?p) (carried ?x))
    :effect (and (at ?x ?p) (not (carried ?x)) (hand))))"""


def courier(places: int, things: int, seed: int) -> Task:
    """Things are to be carried along short roads, or flown at a price; carrying costs nothing."""
    random = Random(seed)
    names = [f"p{number}" for number in range(places)]
    roads = {(a, b) for a in names for b in random.sample(names, 2) if a != b}
    roads |= {(b, a) for a, b in roads}
    init = ["(here p0) (hand) (= (total-cost) 0)"]
    for a, b in sorted(roads):
        init.append(f"(road {a} {b}) (= (distance {a} {b}) {random.randint(1, 20)})")
    goal = []
    for number in range(things):
        init.append(f"(at t{number} {random.choice(names)})")
        goal.append(f"(at t{number} {random.choice(names)})")
    objects = " ".join(f"t{number}" for number in range(things))
    return task_from_text(
        COURIER,
        f"(define (problem errands) (:domain courier)\n"
        f"(:objects {' '.join(names)} - place {objects} - thing)\n"
        f"(:init {' '.join(init)})\n(:goal (and {' '.join(goal)}))\n"
        f"(:metric minimize (total-cost)))",
    )


@pytest.fixture(params=[None, *SEARCHES])
def planner(request: pytest.FixtureRequest) -> Iterator[FastDownward]:
    made = FastDownward(search=request.param)
    yield made
    made.close()


def test_without_a_metric_a_plan_costs_its_length(planner: FastDownward, tmp_path: Path) -> None:
    task = task_from_text(
        COSTS.domain, COSTS.problem.replace("(:metric minimize (total-cost))", "")
    )
    plan = planner.plan(task)
    assert isinstance(plan, Plan)
    assert plan.cost == len(plan.actions) == val_value(task, task.init, plan.actions, tmp_path) == 2


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_costs_are_those_of_the_judges(planner: FastDownward, seed: int, tmp_path: Path) -> None:
    task = courier(5, 2, seed)
    plan = planner.plan(task)
    assert isinstance(plan, Plan)
    assert plan.cost == val_value(task, task.init, plan.actions, tmp_path)
    least = least_cost(task, task.init, tmp_path)
    assert plan.cost == least if planner.search == "optimal" else plan.cost >= least


@pytest.mark.slow
@pytest.mark.parametrize("search", [None, "lama"])
def test_searches_that_take_any_plan_count_costs_too(search: str | None) -> None:
    """Over ten tasks their plans cost half as much again as the best; the shortest, five times."""
    ratios = []
    for seed in range(10):
        task = courier(8, 3, seed)
        best, found = (FastDownward(search=each).plan(task) for each in ("optimal", search))
        assert isinstance(best, Plan)
        assert isinstance(found, Plan)
        ratios.append(found.cost / max(1, best.cost))
    assert sum(ratios) / len(ratios) < 2


@pytest.mark.slow
def test_costs_do_not_keep_it_from_finding_a_plan() -> None:
    """FF that counts costs by itself finds none in a minute; short plans fly, for 2,000."""
    plan = FastDownward(timeout=30).plan(courier(20, 20, 1))
    assert isinstance(plan, Plan)
    assert plan.cost < 1500
