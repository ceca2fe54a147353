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


def depot(grip: str) -> Task:
    return task_from_text(
        f"""(define (domain depot) (:requirements :typing) (:types robot cone bay - object)
        (:predicates (at ?r - robot ?b - bay) (stands ?c - cone ?b - bay)
          (held ?r - robot ?c - cone) (free ?r - robot) (boxed ?c - cone))
        (:action drive :parameters (?r - robot ?a ?b - bay) :precondition (at ?r ?a)
          :effect (and (at ?r ?b) (not (at ?r ?a))))
        (:action grab :parameters (?r - robot ?c - cone ?b - bay)
          :precondition (and (at ?r ?b) {grip} (free ?r))
          :effect (and (held ?r ?c) (not {grip}) (not (free ?r))))
        (:action drop :parameters (?r - robot ?c - cone ?b - bay)
          :precondition (and (at ?r ?b) (held ?r ?c))
          :effect (and {grip} (free ?r) (not (held ?r ?c)))))""",
        f"""(define (problem p) (:domain depot) (:objects bot - robot cone1 - cone b1 b2 - bay)
        (:init (at bot b1) (free bot) {grip.replace("?c", "cone1").replace("?b", "b1")})
        (:goal (held bot cone1)))""",
    )


def grabbed(task: Task) -> tuple[Action, ...]:
    return tuple(each for each in task.ground_actions() if each.name in ("grab", "drive"))


def test_a_robot_may_be_named_before_the_thing_that_it_holds() -> None:
    task = depot("(stands ?c ?b)")
    plan = grabbed(task)
    state = elsewhere(task, 1, plan=lambda _: plan)
    assert {atom.pddl() for atom in state - task.init} == {"(stands cone1 b2)"}


def test_a_thing_that_has_one_place_alone_is_told_with_its_fact() -> None:
    task = depot("(boxed ?c)")
    with pytest.raises(WorldError, match=r"\(boxed cone1\) names no place") as error:
        elsewhere(task, 1, plan=lambda _: grabbed(task))
    assert "no action changes" not in str(error.value)
