"""Names that leave a preposition out, or end in one: said with it, or marked to be looked at."""

import yaml

from tpvqa.drafting import LOOK, draft
from tpvqa.pddl.loading import task_from_text

DOMAIN = """(define (domain greenhouse) (:requirements :typing)
  (:types plant bed crate bottle robot - object)
  (:predicates (standing ?c - crate ?b - bed) (grows ?p - plant ?b - bed) (visiting ?r - robot
    ?b - bed) (filled-with ?l - bottle) (switched-on ?l - bottle) (touching ?c - crate ?p - plant))
  (:action do :parameters (?p - plant ?b - bed ?c - crate ?l - bottle ?r - robot)
    :effect (and (standing ?c ?b) (grows ?p ?b) (visiting ?r ?b) (filled-with ?l) (switched-on ?l)
    (touching ?c ?p))))"""
PROBLEM = """(define (problem p) (:domain greenhouse) (:objects tomato - plant bed_north - bed
  tray - crate flask - bottle rover - robot) (:init) (:goal (filled-with flask)))"""


def _drafted() -> str:
    return draft(task_from_text(DOMAIN, PROBLEM))


def test_who_stands_stands_at_a_place() -> None:
    asked = yaml.safe_load(_drafted())["predicates"]
    assert asked["standing"] == ["Is the {c} on the {b}?", "Is the {c} standing on the {b}?"]


def test_a_question_that_lacks_a_word_is_marked() -> None:
    marked = {line.split(":")[0].strip() for line in _drafted().splitlines() if LOOK in line}
    assert {"grows", "filled-with"} <= marked
    assert not {"standing", "visiting", "switched-on", "touching"} & marked
