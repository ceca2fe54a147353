"""Answer set programming, beside an optimal search."""

import math
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from tests.pddl.feature_domains import SAMPLES, Sample
from tests.planning.random_states import random_states
from tpvqa.errors import PluginError
from tpvqa.pddl import Task, load_task, task_from_text, validate
from tpvqa.planning import Crashed, Plan, Planner, TimedOut, Unsolvable
from tpvqa.planning.clingo import ClingoPlanner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.making import make_planner

pytest.importorskip("clingo")


@pytest.fixture(scope="module")
def clingo() -> Planner:
    return make_planner("clingo")


@pytest.fixture(scope="module")
def optimal() -> Planner:
    return FastDownward(search="optimal")


def agree(task: Task, clingo: Planner, optimal: Planner, *, seed: int, count: int) -> set[str]:
    """Whether both say the same from random states; the kinds of results."""
    kinds = set()
    for state in random_states(task, seed=seed, count=count):
        ours, other = clingo.plan(task, state, timeout=30), optimal.plan(task, state)
        assert type(ours) is type(other), sorted(map(str, state))
        if isinstance(ours, Plan) and isinstance(other, Plan):
            assert validate(task, ours.actions, state).valid
            assert len(ours.actions) == len(other.actions)
        kinds.add(type(ours).__name__)
    return kinds


@pytest.mark.parametrize("name", ["clean_dishes", "serve_breakfast", "eat_apple", "collect_toys"])
def test_shipped_tasks_as_an_optimal_search(name: str, clingo: Planner, optimal: Planner) -> None:
    kinds = agree(load_task(name), clingo, optimal, seed=11, count=9)
    assert "Plan" in kinds


@pytest.fixture(scope="module")
def blocks() -> Task:
    return load_task("build_tower")


@settings(max_examples=4, deadline=None, suppress_health_check=list(HealthCheck))
@given(seed=st.integers(0, 10_000))
def test_blocksworld_as_an_optimal_search(
    seed: int, blocks: Task, clingo: Planner, optimal: Planner
) -> None:
    agree(blocks, clingo, optimal, seed=seed, count=3)


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_every_feature(sample: Sample, clingo: Planner, optimal: Planner) -> None:
    """Conditional effects, derived predicates, negation, quantifiers: as the planner behind all."""
    task = task_from_text(sample.domain, sample.problem)
    result = clingo.plan(task, timeout=30)
    if sample.cost is None:
        assert isinstance(result, Unsolvable)
        return
    assert isinstance(result, Plan)
    assert result.cost >= sample.cost
    if all(schema.cost == 1 for schema in task.schemas):
        assert result.cost == sample.cost


DETOUR = """(define (domain ways) (:requirements :action-costs) (:predicates (a) (b) (c))
(:functions (total-cost) - number)
(:action dear :parameters () :precondition (a) :effect (and (b) (increase (total-cost) 9)))
(:action fair :parameters () :precondition (a) :effect (and (b) (increase (total-cost) 4)))
(:action half :parameters () :precondition (a) :effect (and (c) (increase (total-cost) 1)))
(:action rest :parameters () :precondition (c) :effect (and (b) (increase (total-cost) 1))))
"""
GO = """(define (problem go) (:domain ways) (:init (a) (= (total-cost) 0)) (:goal (b))
(:metric minimize (total-cost)))"""


def test_the_fewest_steps_and_among_those_the_least_cost(clingo: Planner) -> None:
    result = clingo.plan(task_from_text(DETOUR, GO))
    assert isinstance(result, Plan)
    assert [str(action) for action in result.actions] == ["fair()"]


LAMPS = """(define (domain lamps) (:types lamp) (:predicates (lit ?l - lamp) (spare))
(:action swap :parameters (?a ?b - lamp) :precondition (and (lit ?a) (not (lit ?b)))
 :effect (and (lit ?b) (not (lit ?a)))))"""


def lamps(count: int) -> Task:
    """One lamp is lit, two are wanted; the relaxation does not see that it cannot be."""
    names = [f"l{n}" for n in range(count)]
    return task_from_text(
        LAMPS,
        f"(define (problem two) (:domain lamps) (:objects {' '.join(names)} - lamp)"
        "(:init (lit l0)) (:goal (and (lit l0) (lit l1))))",
    )


def test_no_plan_is_proved_where_every_sequence_comes_back_to_a_state(clingo: Planner) -> None:
    result = clingo.plan(lamps(4), timeout=30)
    assert isinstance(result, Unsolvable)
    assert "without coming to a state twice" in result.reason


def test_what_is_not_proved_in_time_is_not_called_unsolvable(clingo: Planner) -> None:
    assert isinstance(clingo.plan(lamps(40), timeout=1.5), TimedOut)


def test_too_much_memory_ends_the_engine_and_not_us() -> None:
    result = ClingoPlanner(memory=20).plan(lamps(60), timeout=30)
    assert isinstance(result, Crashed)
    assert "out of memory (its limit is 20 MiB)" in result.reason


def test_arguments_are_refused() -> None:
    with pytest.raises(PluginError, match="Write clingo alone"):
        make_planner("clingo:fast")


def test_no_limit_of_time(clingo: Planner, tmp_path: Path) -> None:
    assert isinstance(clingo.plan(load_task("clean_dishes"), timeout=math.inf), Plan)
