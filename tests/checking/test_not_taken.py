"""Arguments of actions that a skill hardly takes, as they are where the robot is."""

import pytest

from tpvqa.checking.world import not_taken
from tpvqa.pddl import task_from_text
from tpvqa.worlds.world_file import WorldRules

CELLAR = task_from_text(
    """(define (domain cellar) (:requirements :strips :typing) (:types place vessel)
      (:predicates (robot-at ?p - place) (full ?v - vessel) (rinsed ?v - vessel))
      (:action go :parameters (?from ?to - place) :precondition (robot-at ?from)
        :effect (and (robot-at ?to) (not (robot-at ?from))))
      (:action rack :parameters (?a ?b - vessel) :precondition (and (full ?a) (rinsed ?b))
        :effect (and (full ?b) (not (full ?a)) (not (rinsed ?a)))))""",
    """(define (problem cellar-1) (:domain cellar)
      (:objects yard press - place tank barrel - vessel)
      (:init (robot-at yard) (full tank) (rinsed barrel))
      (:goal (and (robot-at press) (full barrel))))""",
)


def test_where_the_robot_is_is_told_and_what_an_action_empties_is_not() -> None:
    told = [each.says for each in not_taken(CELLAR, WorldRules(), "world.yaml")]
    assert len(told) == 1
    assert told[0].startswith("?from of go ")


@pytest.mark.parametrize(
    ("predicate", "says"),
    [
        ("robot-at", "is where the robot is"),
        ("lift-at", "is where the lift is"),
        ("at", "is where the robot is"),
        ("lit", "is whatever (lit ?from) is true of"),
    ],
)
def test_whose_place_it_is_is_told(predicate: str, says: str) -> None:
    task = task_from_text(
        CELLAR.domain_text.replace("robot-at", predicate),
        CELLAR.problem_text.replace("robot-at", predicate),
    )
    (told,) = not_taken(task, WorldRules(), "world.yaml")
    assert told.says == f"?from of go {says}: a skill hardly takes it"
