"""Actions by how a log writes them: those out of reach too, and no others."""

import pytest

from tpvqa.bench.written_actions import WrittenActions
from tpvqa.pddl import task_from_text

DOMAIN = """(define (domain toys) (:predicates (on ?x ?y) (toy ?x))
  (:action drop :parameters (?x ?y) :precondition (and (toy ?x) (on ?x ?y))
    :effect (not (on ?x ?y))))"""
PROBLEM = """(define (problem one) (:domain toys) (:objects ball box)
  (:init (toy ball) (on ball box)) (:goal (not (on ball box))))"""


def test_an_action_is_found_whether_or_not_it_can_be_reached() -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    actions = WrittenActions(task)
    assert set(actions) == {"(drop ball box)"}
    assert actions["(drop box ball)"] == task.action("drop", ["box", "ball"])


@pytest.mark.parametrize("written", ["(drop ball)", "(lift ball box)", "(drop ball moon)", "()"])
def test_what_is_no_action_of_the_task_is_not_found(written: str) -> None:
    with pytest.raises(KeyError):
        WrittenActions(task_from_text(DOMAIN, PROBLEM))[written]
