"""What a name asks and tells of which thing, and what it leaves to a person to say."""

import pytest
import yaml

from tpvqa.drafting import LOOK, draft
from tpvqa.pddl.loading import task_from_text

TYPES = "(:types barrel cart pot shelf bulb scene visitor vial syringe shaft guard - object)"
OBJECTS = """oak - barrel dray - cart kettle - pot low_shelf - shelf bulb1 - bulb obj60w - bulb
  atrium gallery - scene MrBean tall_visitor anna - visitor phial - vial pump - syringe
  warden - guard
  spindle - shaft"""


def drafted(predicates: str, *actions: str) -> tuple[dict[str, list[str]], dict[str, str], str]:
    """The questions, what is said of actions, and all of the draft."""
    effects = "\n".join(
        f"(:action {head} :parameters ({of}) :effect (and {what}))"
        for head, of, what in (each.split("|") for each in actions)
    )
    domain = f"(define (domain d) (:requirements :typing) {TYPES} (:predicates {predicates})"
    problem = f"(define (problem p) (:domain d) (:objects {OBJECTS}) (:init) (:goal (and)))"
    text = draft(task_from_text(f"{domain} {effects})", problem))
    read = yaml.safe_load(text)
    asked = {
        name: [each] if isinstance(each, str) else each for name, each in read["predicates"].items()
    }
    said = {name: each["say"] for name, each in read["actions"].items()}
    return asked, said, text


ASKED = {
    "(guard_of ?g - guard ?s - shaft)": "Is the {g} the guard of the {s}?",
    "(shaft-of ?g - guard ?s - shaft)": "Is the {s} the shaft of the {g}?",
    "(rustCovered ?p - pot)": "Is the {p} covered with rust?",
    "(cold-enough ?p - pot)": "Is the {p} cold enough?",
    "(water-enough ?p - pot)": "Does the {p} have enough water?",
    "(noCrackIn ?p - pot)": "Is there no crack in the {p}?",
    "(is-in-tune ?p - pot)": "Is the {p} in tune?",
    "(has_4_handles ?p - pot)": "Does the {p} have 4 handles?",
    "(clampedInFrame ?p - pot)": "Is the {p} clamped in the frame?",
    "(cut-in-half ?p - pot)": "Is the {p} cut in half?",
    "(camera2-aimed-at ?p - pot)": "Is the camera 2 aimed at the {p}?",
}


@pytest.mark.parametrize("predicate", ASKED)
def test_a_name_asks_what_it_says(predicate: str) -> None:
    name, *rest = predicate.strip("()").split()
    heads = " ".join(word for word in rest if word.startswith("?"))
    changed = drafted(predicate, f"do|{' '.join(rest)}|({name} {heads})")
    first, *others = changed[0][name.lower()]
    assert first == ASKED[predicate]
    assert all(each.startswith("Is it true that") or "been" in each for each in others)


def test_what_a_name_leaves_open_is_marked() -> None:
    predicates = (
        "(mirrorCovered ?p - pot) (twin_of ?p - pot ?b - barrel) (ready4use ?p - pot) "
        "(fed ?p - pot) (exposed ?b - bulb) (warm-enough ?p - pot) (filled-to-4cm ?p - pot)"
    )
    effects = (
        "(mirrorCovered ?p) (twin_of ?p ?b) (ready4use ?p) (fed ?p) (exposed ?l) "
        "(warm-enough ?p) (filled-to-4cm ?p)"
    )
    _, _, text = drafted(predicates, f"do|?p - pot ?b - barrel ?l - bulb|{effects}")
    marked = {line.split(":")[0].strip() for line in text.splitlines() if LOOK in line}
    assert {"mirrorcovered", "twin_of", "ready4use", "fed", "exposed", "warm-enough"} <= marked
    assert "filled-to-4cm" not in marked


def test_an_action_is_said_of_what_it_is_done_to() -> None:
    predicates = (
        "(wetWith ?v - vial ?s - syringe) (waxOn ?b - barrel) (trained-on ?b - bulb ?s - scene) "
        "(aimed-at ?b - bulb ?s - scene) (stowed ?b - bulb) (wearing ?v - visitor ?p - pot) "
        "(clampedInFrame ?p - pot)"
    )
    _, said, text = drafted(
        predicates,
        "squeeze_into|?s - syringe ?v - vial|(wetWith ?v ?s)",
        "put-wax-on|?b - barrel|(waxOn ?b)",
        "put_wax_back_on|?b - barrel|(waxOn ?b)",
        "aim|?b - bulb ?s - scene|(aimed-at ?b ?s)",
        "stow|?b - bulb ?s - scene|(stowed ?b) (not (aimed-at ?b ?s))",
        "dressGuest|?v - visitor ?p - pot|(wearing ?v ?p)",
        "clampInFrame|?p - pot|(clampedInFrame ?p)",
    )
    plain = {name: each.replace(".the", "").replace("the ", "") for name, each in said.items()}
    assert plain["squeeze_into"] == "squeeze {s} into {v}"
    assert plain["put-wax-on"] == "put wax on {b}"
    assert plain["put_wax_back_on"] == "put back wax on {b}"
    assert plain["aim"] == "aim {b} at {s}"
    assert plain["stow"] == "stow {b}"
    assert "in the frame" in said["clampinframe"]
    marked = {line.split(":")[0].strip() for line in text.splitlines() if LOOK in line}
    assert "dressguest" in marked
    assert "put-wax-on" not in marked


def test_what_is_done_is_told_in_the_past_tense() -> None:
    _, _, text = drafted("(bare ?p - pot)", "take-lid-off|?p - pot|(bare ?p)")
    assert 'done: "took off the lid' in text


def test_people_have_names_and_things_are_what_they_are() -> None:
    changed = "(here ?v - visitor) (dimmed ?b - bulb)"
    _, _, text = drafted(changed, "do|?v - visitor ?b - bulb|(here ?v) (dimmed ?b)")
    assert '"Mr Bean"' in text
    assert '"Anna"' in text
    assert '"tall visitor"' not in text.replace("tall_visitor", "")  # its name as it is
    assert '"bulb 60w"' in text


def test_what_is_at_one_place_and_then_at_another_goes_to_it() -> None:
    _, said, _ = drafted(
        "(lift-at ?s - scene) (on ?p - pot ?s - shelf)",
        "call-lift|?s ?from - scene|(lift-at ?s) (not (lift-at ?from))",
        "put|?p - pot ?a ?b - shelf|(on ?p ?b) (not (on ?p ?a))",
    )
    plain = {name: each.replace(".the", "").replace("the ", "") for name, each in said.items()}
    assert plain["call-lift"] == "call lift from {from} to {s}"
    assert plain["put"] == "put {p} from {a} on {b}"


def test_verbs_of_laboratories_and_lines_are_known() -> None:
    actions = {
        "thaw": "thaw the {p}",
        "invert": "invert the {p}",
        "cap": "cap the {p}",
        "scan-barcode": "scan the barcode of the {p}",
        "press-button": "press the button of the {p}",
        "ring-bell": "ring the bell of the {p}",
        "transfer": "transfer the {p}",
    }
    _, said, text = drafted("(bare ?p - pot)", *(f"{each}|?p - pot|(bare ?p)" for each in actions))
    assert said == actions
    assert LOOK not in text.partition("actions:")[2]
    assert "transferred the" in text


def test_that_something_was_rung_is_seldom_shown() -> None:
    asked, _, text = drafted("(bell-rung ?p - pot)", "ring|?p - pot|(bell-rung ?p)")
    assert asked["bell-rung"][0] == "Is the bell of the {p} rung?"
    assert "bell-rung:   # LOOK: does a picture show it?" in text
    assert 'done: "rang the {p}"' in text
