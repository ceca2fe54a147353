"""Why nothing can be elsewhere: the error says what the domain lacks, and of which thing."""

import pytest

from tpvqa.errors import WorldError
from tpvqa.pddl import Action, Task
from tpvqa.pddl.loading import task_from_text
from tpvqa.worlds.elsewhere import elsewhere

DOMAIN = """(define (domain yard) (:requirements :typing :conditional-effects)
  (:types thing place - object)
  (:predicates (in ?x - thing ?p - place) (carried ?x - thing) (at ?p - place) (clean ?x - thing))
  (:action go :parameters (?a ?b - place) :precondition (at ?a)
    :effect (and (at ?b) (not (at ?a))
      (forall (?x - thing) (when (carried ?x) (and (in ?x ?b) (not (in ?x ?a)))))))
  (:action lift :parameters (?x - thing ?p - place) :precondition (and (in ?x ?p) (at ?p))
    :effect (carried ?x))
  (:action wash :parameters (?x - thing) :effect (clean ?x)))"""


def task_with(goal: str) -> Task:
    return task_from_text(
        DOMAIN,
        "(define (problem p) (:domain yard) (:objects crate - thing hall van - place)"
        f" (:init (in crate hall) (at hall)) (:goal {goal}))",
    )


def test_a_thing_whose_place_is_in_no_group_is_named_with_what_mends_it() -> None:
    task = task_with("(in crate van)")
    lift = next(each for each in task.ground_actions() if each.name == "lift")
    with pytest.raises(WorldError, match="of crate the domain does not make sure") as error:
        elsewhere(task, 1, plan=lambda _: (lift,))
    assert "--true-start" in str(error.value)
    assert "name fewer" not in str(error.value)


def test_a_plan_that_handles_nothing_with_a_place_is_told_so() -> None:
    domain = DOMAIN.replace("(in crate hall)", "")
    task = task_from_text(
        domain,
        "(define (problem p) (:domain yard) (:objects crate - thing hall van - place)"
        " (:init (at hall)) (:goal (clean crate)))",
    )

    def plan(_: object) -> tuple[Action, ...]:
        return tuple(each for each in task.ground_actions() if each.name == "wash")

    with pytest.raises(WorldError, match="no action changes a fact that says where"):
        elsewhere(task, 1, plan=plan)
