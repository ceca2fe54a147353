"""Plans to other facts than the goal."""

import pytest

from tests.planning.test_without import DOMAIN, PROBLEM
from tpvqa.pddl import Atom, Task, task_from_text
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.planning.towards import plan_towards

COMMENTED = PROBLEM.replace("(:goal", "; (:goal (lit))\n(:goal")


@pytest.fixture(scope="module")
def rooms() -> Task:
    return task_from_text(DOMAIN, COMMENTED)


def test_what_is_wanted_is_brought_about_and_no_more(rooms: Task, planner: Planner) -> None:
    there = Atom("at", ("b",))
    found = plan_towards(planner, rooms, rooms.init, frozenset({there}))
    assert isinstance(found, Plan)
    assert [each.pddl() for each in found.actions] == ["(go a b)"]
    assert found.actions[0] is rooms.action("go", ("a", "b"))
    both = plan_towards(planner, rooms, rooms.init, frozenset({Atom("at", ("c",)), Atom("lit")}))
    assert isinstance(both, Plan)
    assert len(both.actions) == 2


def test_where_a_thing_cannot_be_reached_that_is_said(rooms: Task, planner: Planner) -> None:
    after = frozenset({*rooms.init - {Atom("at", ("a",))}, Atom("at", ("d",))})
    assert isinstance(
        plan_towards(planner, rooms, after, frozenset({Atom("at", ("a",))})), Unsolvable
    )
