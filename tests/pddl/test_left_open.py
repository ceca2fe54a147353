"""What a problem leaves open of its initial state: read, and told where it is wrong."""

import pytest

from tests.ward import ward
from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Literal, State, Task, holds
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward


@pytest.fixture(scope="module")
def task() -> Task:
    return ward()


def facts(*words: str) -> frozenset[Atom]:
    return frozenset(map(Atom.parse, words))


def test_what_is_left_open_is_told_apart(task: Task) -> None:
    assert task.unknown == facts("(in lamp hall)", "(in lamp store)")
    assert task.oneof == (
        facts("(in pump store)", "(in pump theatre)", "(in pump hall)"),
        facts("(needs anna pump)", "(needs anna lamp)"),
    )
    assert task.left_open == task.unknown.union(*task.oneof)
    assert all(map(task.changes, task.left_open))


def test_one_possible_state_stands_for_all_and_keeps_the_invariants(task: Task) -> None:
    assert all(len(task.init & group) == 1 for group in task.oneof)
    exactly = [group.atoms for group in task.mutex_groups if group.exactly_one]
    for tool in ("pump", "lamp"):
        places = facts(*(f"(in {tool} {room})" for room in ("hall", "store", "theatre")))
        assert any(places < group for group in exactly)


def test_plans_are_found_from_all_that_may_be_the_case(task: Task) -> None:
    closed: State = task.init - task.left_open
    planner = FastDownward()
    try:
        for pump in ("hall", "store", "theatre"):
            for needed in ("pump", "lamp"):
                opened = facts(f"(in pump {pump})", "(in lamp store)", f"(needs anna {needed})")
                plan = planner.plan(task, closed | opened)
                assert isinstance(plan, Plan)
                state = closed | opened
                for action in plan.actions:
                    assert task.applicable(state, action)
                    state = task.apply(state, action)
                assert task.goal_holds(state)
    finally:
        planner.close()


def test_clauses_are_kept_by_the_state_that_stands_for_all() -> None:
    task = ward(
        "(oneof (needs anna pump) (needs anna lamp)) (in pump hall)"
        "(or (not (needs anna pump)) (in lamp store)) (or (needs anna lamp) (in lamp store))"
    )
    assert len(task.clauses) == 2
    assert Literal(Atom.parse("(needs anna pump)"), False) in task.clauses[0]
    assert all(any(holds(each, task.init) for each in clause) for clause in task.clauses)


@pytest.mark.parametrize(
    ("opened", "line", "says"),
    [
        ("(oneof (needs anna pump))", 5, "has 1 facts; expected (oneof (fact …) (fact …) …)"),
        ("(unknown)", 5, "has 0 facts; expected (unknown (fact …))"),
        ("(unknown (free) (at hall))", 5, "has 2 facts"),
        ("\n(unknown (in lamp hal))", 6, "Did you mean 'hall'"),
        ("(unknown (inn lamp hall))", 5, "Did you mean 'in'"),
        ("(unknown (in hall lamp))", 5, "hall is of the type room"),
        ("(unknown (not (in lamp hall)))", 5, "is no fact that unknown can leave open"),
        ("(unknown in)", 5, "in is no fact that unknown can leave open"),
        ("(oneof (and (at hall) (free)) (free))", 5, "is no fact that oneof can leave open"),
        ("(or (in lamp hall) (not (in lamp hall)))", 5, "names a fact twice"),
        ("(unknown (free))", 5, "(free) is left open here, and stated as well"),
        (
            "(oneof (in pump hall) (in lamp hall)) (oneof (in pump hall) (in lamp store))"
            "(oneof (in lamp hall) (in lamp store))",
            5,
            "no initial state is as (oneof …) and (or …) say; leave out",
        ),
    ],
)
def test_what_is_wrong_is_said_with_its_line(opened: str, line: int, says: str) -> None:
    with pytest.raises(PDDLError) as caught:
        ward(opened)
    assert says in str(caught.value)
    assert caught.value.line == line


def test_a_problem_that_leaves_nothing_open_is_as_before() -> None:
    task = ward("(in pump store)")
    assert not task.left_open
    assert "needs" not in task.fluents
