"""Names that say less than they seem to: drafted as English goes, or marked to be looked at."""

import pytest
import yaml

from tpvqa.drafting import LOOK, draft
from tpvqa.pddl.loading import task_from_text

DOMAIN = """(define (domain yard) (:requirements :typing)
  (:types horse saddle hook bag crate knife rope gate room - object)
  (:predicates (carries ?s - saddle) (hangs-on ?s - saddle ?k - hook) (hooves-picked ?h - horse)
    (gloves-on) (packed ?b - bag ?c - crate) (sealed ?b - bag) (kept ?k - knife)
    (halyard-clipped ?h - horse) (scale-beside ?k - knife) (windlass-left-at ?g - gate)
    (watertight ?g - gate) (loose ?r - rope) (idling) (led ?h - horse))
  (:action hang-up :parameters (?s - saddle ?k - hook) :precondition (carries ?s)
    :effect (and (hangs-on ?s ?k) (not (carries ?s))))
  (:action pick-hooves :parameters (?h - horse) :effect (hooves-picked ?h))
  (:action put-on-gloves :parameters () :effect (gloves-on))
  (:action pack :parameters (?b - bag ?c - crate) :effect (packed ?b ?c))
  (:action seal :parameters (?b - bag ?k - horse) :effect (and (sealed ?b) (led ?k)))
  (:action clip-on-halyard :parameters (?h - horse) :effect (halyard-clipped ?h))
  (:action lay-scale :parameters (?k - knife) :effect (scale-beside ?k))
  (:action lay-down-windlass :parameters (?g - gate)
    :effect (and (windlass-left-at ?g) (watertight ?g)))
  (:action pick-up-windlass :parameters (?g - gate) :effect (not (windlass-left-at ?g)))
  (:action let-go :parameters (?r - rope) :effect (loose ?r))
  (:action let-idle :parameters () :effect (idling))
  (:action lead-away :parameters (?h - horse) :effect (led ?h)))"""
PROBLEM = """(define (problem p) (:domain yard) (:objects Bess - horse GP_saddle17 - saddle
    hookA - hook bag_A1 BAG_B - bag crate1 - crate Knife_07B - knife bow_line - rope
    north_gate - gate bedroom_2 - room)
  (:init) (:goal (gloves-on)))"""


def drafted() -> str:
    return draft(task_from_text(DOMAIN, PROBLEM))


def test_verbs_take_what_english_joins_to_them() -> None:
    actions = yaml.safe_load(drafted())["actions"]
    said = {name: each["say"].replace(".the", "") for name, each in actions.items()}
    assert said["hang-up"].replace("the ", "") == "hang up {s} on {k}"
    assert said["pick-hooves"] == "pick the hooves of the {h}"
    assert said["put-on-gloves"] == "put on the gloves"
    assert said["pack"].replace("the ", "") == "pack {b} into {c}"
    assert said["lay-scale"].replace("the ", "") == "lay scale beside {k}"
    assert said["lay-down-windlass"] == "lay down the windlass at the {g}"
    assert said["pick-up-windlass"] == "pick up the windlass from the {g}"
    assert said["let-go"] == "let go of the {r}"
    assert actions["lead-away"]["done"] == "led away the {h}"


def test_facts_are_asked_of_who_does_it_and_of_several_things_as_several() -> None:
    asked = yaml.safe_load(drafted())["predicates"]
    assert asked["carries"][0] == "Is the robot carrying {s.the}?"
    assert asked["gloves-on"][0] == "Are the gloves on?"
    assert asked["hooves-picked"][0] == "Are the hooves of the {h} picked?"
    assert asked["windlass-left-at"] == [
        "Is the windlass left at the {g}?",
        "Is it true that the windlass is left at the {g}?",
    ]
    assert asked["watertight"][0] == "Is the {g} watertight?"


def test_what_the_names_leave_open_is_marked() -> None:
    marked = {line.split(":")[0].strip() for line in drafted().splitlines() if LOOK in line}
    assert {"seal", "clip-on-halyard", "let-idle"} <= marked
    assert not {"hang-up", "pack", "lay-scale", "let-go", "put-on-gloves"} & marked


def test_codes_keep_the_capitals_and_compounds_stay_whole() -> None:
    named = yaml.safe_load(drafted())["objects"]
    said = {
        name: each.get("name") if isinstance(each, dict) else each for name, each in named.items()
    }
    assert said["knife_07b"] == "knife 07B"
    assert said["bag_a1"] == "bag A1"
    assert said["bag_b"] == "bag B"
    assert said["hooka"] == "hook A"
    assert said["gp_saddle17"] == "GP saddle 17"
    assert said.get("bedroom_2") is None


@pytest.mark.parametrize(
    ("name", "asked"),
    [
        ("gloves", "Are the gloves on?"),
        ("news", "Is the news on?"),
        ("physics", "Is the physics on?"),
        ("biceps", "Is the biceps on?"),
    ],
)
def test_what_ends_in_an_s_is_not_always_several_things(name: str, asked: str) -> None:
    domain = DOMAIN.replace("gloves-on", f"{name}-on")
    text = draft(task_from_text(domain, PROBLEM.replace("gloves-on", f"{name}-on")))
    assert yaml.safe_load(text)["predicates"][f"{name}-on"][0] == asked


IDIOMS = """(define (domain ship) (:requirements :typing)
  (:types letter boiler tray - object)
  (:predicates (opened ?l - letter) (drained ?b - boiler) (on-fire ?b - boiler) (cold ?b - boiler)
    (stored ?l - letter))
  (:action letter-open :parameters (?l - letter) :effect (opened ?l))
  (:action let-out-water :parameters (?b - boiler) :effect (drained ?b))
  (:action set-on-fire :parameters (?b - boiler) :effect (on-fire ?b))
  (:action put-in-gear :parameters (?b - boiler) :effect (cold ?b))
  (:action lay-at-rest :parameters (?b - boiler) :effect (cold ?b))
  (:action leave-at-home :parameters (?b - boiler) :effect (cold ?b))
  (:action put-in-reverse :parameters (?b - boiler) :effect (cold ?b))
  (:action cut-in-two :parameters (?b - boiler) :effect (cold ?b))
  (:action put-in-tray :parameters (?l - letter) :effect (stored ?l)))"""
SHIP = """(define (problem p) (:domain ship) (:objects note - letter kettle - boiler blue - tray)
  (:init) (:goal (opened note)))"""


def test_an_article_stands_before_things_and_not_in_idioms() -> None:
    actions = yaml.safe_load(draft(task_from_text(IDIOMS, SHIP)))["actions"]
    said = {name: each["say"] for name, each in actions.items()}
    assert said["letter-open"] == "open the {l}"
    assert said["let-out-water"] == "let out the water of the {b}"
    assert said["set-on-fire"] == "set the {b} on fire"
    assert said["put-in-gear"] == "put the {b} in gear"
    assert said["lay-at-rest"] == "lay the {b} at rest"
    assert said["leave-at-home"] == "leave the {b} at home"
    assert said["put-in-reverse"] == "put the {b} in reverse"
    assert said["cut-in-two"] == "cut the {b} in two"
    assert said["put-in-tray"] == "put the {l} in the tray"


GRIPPER = """(define (domain gripper-strips)
  (:predicates (room ?r) (ball ?b) (gripper ?g) (at-robby ?r) (at ?b ?r) (free ?g) (carry ?o ?g))
  (:action pick :parameters (?obj ?room ?gripper)
    :precondition (and (ball ?obj) (room ?room) (gripper ?gripper) (at ?obj ?room)
      (at-robby ?room) (free ?gripper))
    :effect (and (carry ?obj ?gripper) (not (at ?obj ?room)) (not (free ?gripper))))
  (:action drop :parameters (?obj ?room ?gripper)
    :precondition (and (ball ?obj) (room ?room) (gripper ?gripper) (carry ?obj ?gripper)
      (at-robby ?room))
    :effect (and (at ?obj ?room) (free ?gripper) (not (carry ?obj ?gripper)))))"""
BALLS = """(define (problem p) (:domain gripper-strips) (:objects rooma roomb ball1 left right)
  (:init (room rooma) (room roomb) (ball ball1) (gripper left) (gripper right) (at-robby rooma)
    (free left) (free right) (at ball1 rooma)) (:goal (at ball1 roomb)))"""


def test_that_something_is_done_with_a_gripper_is_no_guess() -> None:
    text = draft(task_from_text(GRIPPER, BALLS))
    assert "with {gripper.the}" in yaml.safe_load(text)["actions"]["pick"]["say"]
    assert LOOK not in text.partition("actions:")[2]


def test_underwater_robots_act_and_grip() -> None:
    """Acronyms without a vowel keep their capitals."""
    task = task_from_text(
        """(define (domain sea) (:requirements :typing) (:types rov tool station van - object)
        (:predicates (isAt ?r - rov ?s - station) (gripped ?r - rov ?t - tool)
          (inBasket ?t - tool) (linked ?t - tool ?p - van))
        (:action takeTool :parameters (?r - rov ?t - tool) :precondition (inBasket ?t)
          :effect (and (gripped ?r ?t) (not (inBasket ?t))))
        (:action plug-in :parameters (?t - tool ?p - van) :precondition (inBasket ?t)
          :effect (linked ?t ?p))
        (:action transit :parameters (?r - rov ?a ?b - station) :precondition (isAt ?r ?a)
          :effect (and (isAt ?r ?b) (not (isAt ?r ?a)))))""",
        """(define (problem p) (:domain sea) (:objects Triton_XL - rov jet-1 - tool
          TMS manifold - station board - van)
        (:init (isAt Triton_XL TMS) (inBasket jet-1)) (:goal (gripped Triton_XL jet-1)))""",
    )
    told = yaml.safe_load(draft(task))
    asked = ["Is {t.the} gripped by the {r}?", "Is the {r} gripping {t.the}?"]
    assert told["predicates"]["gripped"] == asked
    assert told["actions"]["taketool"]["say"] == "take {t.the}"
    assert told["actions"]["plug-in"]["say"].startswith("plug ")
    assert told["objects"] == {"triton_xl": "triton XL", "tms": "TMS"}
