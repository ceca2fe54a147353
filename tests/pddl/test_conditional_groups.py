"""Mutex groups where effects are conditional, or delete what the action does not need."""

import pytest
from hypothesis import given, settings

from tests.listing import every_state
from tests.pddl.conditional_domains import tasks
from tests.trolley import INIT, trolley
from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.pddl import Atom, Task, task_from_text

ROOMS = ("hall", "attic", "cellar")


def facts(*words: str) -> frozenset[Atom]:
    return frozenset(map(Atom.parse, words))


def places(box: str) -> frozenset[Atom]:
    return facts(*(f"(at {box} {room})" for room in ROOMS))


def found(task: Task) -> dict[frozenset[Atom], bool]:
    return {group.atoms: group.exactly_one for group in task.mutex_groups}


def test_what_effects_move_together_stays_in_one_place() -> None:
    groups = found(trolley())
    for box in ("crate", "chest"):
        assert groups[places(box)]
        assert groups[facts(f"(aboard {box})", f"(beside {box})")]
    assert groups[facts(*(f"(parked {room})" for room in ROOMS))]


def test_a_deletion_on_further_terms_is_no_balance() -> None:
    task = trolley(left="(beside ?b)")  # what is aboard is not beside, so it is left behind
    assert places("crate") not in found(task)
    assert any(len(state & places("crate")) > 1 for state in every_state(task))


def test_groups_hold_from_all_that_a_problem_leaves_open() -> None:
    sure = "(beside crate) (aboard chest) (parked hall) (at chest hall)"
    one = "(oneof (at crate hall) (at crate attic))"
    assert found(trolley(f"{sure} {one}"))[places("crate")]
    task = trolley(f"{sure} (unknown (at crate hall)) (unknown (at crate attic))")
    assert places("crate") not in found(task)
    assert found(task)[places("chest")]


def gripper(soils: str) -> Task:
    return task_from_text(
        f"""(define (domain ward) (:predicates (soiled) (clean) (held) (brought))
        (:action collect :parameters () :precondition (and) :effect (and (held) {soils}))
        (:action wash :parameters () :precondition (soiled)
          :effect (and (clean) (not (soiled)) (not (held))))
        (:action bring :parameters () :precondition (clean) :effect (brought)))""",
        "(define (problem p) (:domain ward) (:init (soiled)) (:goal (and (brought) (held))))",
    )


def test_what_gives_way_without_being_needed_is_of_the_group() -> None:
    """Who collects need not be clean, and is soiled afterwards all the same."""
    task = gripper("(soiled) (not (clean))")
    pair = facts("(clean)", "(soiled)")
    assert found(task)[pair]
    assert all(len(state & pair) == 1 for state in every_state(task))
    clean, soiled = (Atom.parse(word) for word in ("(clean)", "(soiled)"))
    back = BackToBefore(task).results(clean, frozenset({clean}), [soiled], task)
    assert [state for _, state in back] == [frozenset({soiled})]


def test_what_begins_may_end_several() -> None:
    """Which way a robot faces: to turn ends whatever held, of which nothing is needed."""
    ways = ("north", "east", "south", "west")
    turns = "".join(
        f"(:action turn-{way} :parameters () :precondition (awake) :effect (and ({way}) "
        + " ".join(f"(not ({other}))" for other in ways if other != way)
        + "))"
        for way in ways
    )
    task = task_from_text(
        f"(define (domain d) (:predicates (awake) {' '.join(f'({way})' for way in ways)}) {turns})",
        "(define (problem p) (:domain d) (:init (awake) (south)) (:goal (west)))",
    )
    assert found(task)[facts(*(f"({way})" for way in ways))]


def test_what_a_quantifier_ends_is_of_the_group() -> None:
    """Brought from wherever it is: no action says where that was."""
    rooms = " ".join(f"r{number}" for number in range(20))
    task = task_from_text(
        """(define (domain d) (:requirements :typing :quantified-preconditions) (:types box room)
        (:predicates (at ?b - box ?r - room) (in ?r - room))
        (:action go :parameters (?a ?b - room) :precondition (in ?a)
          :effect (and (in ?b) (not (in ?a))))
        (:action bring :parameters (?b - box ?r - room) :precondition (in ?r)
          :effect (and (forall (?o - room) (not (at ?b ?o))) (at ?b ?r))))""",
        f"""(define (problem p) (:domain d) (:objects a b - box {rooms} - room)
        (:init (in r0) (at a r0) (at b r1)) (:goal (and (at a r2) (at b r3))))""",
    )
    for box in "ab":
        assert found(task)[facts(*(f"(at {box} {room})" for room in rooms.split()))]


@pytest.mark.parametrize("soils", ["(soiled)", "(not (clean))"])
def test_what_stays_or_leaves_nothing_is_no_group_of_one(soils: str) -> None:
    assert not found(gripper(soils)).get(facts("(clean)", "(soiled)"))


def test_two_at_first_are_no_group() -> None:
    assert places("crate") not in found(trolley(f"{INIT} (at crate attic)"))


def test_what_follows_from_other_facts_is_not_taken_for_what_never_holds() -> None:
    """An action that needs it can be done, and breaks what it breaks."""
    task = task_from_text(
        """(define (domain lab) (:types rack pipette)
        (:predicates (robot-at ?r - rack) (reach ?r - rack) (stands ?p - pipette ?r - rack)
          (held ?p - pipette) (clean ?p - pipette) (running))
        (:derived (reach ?r - rack) (robot-at ?r))
        (:action go :parameters (?a ?b - rack) :precondition (robot-at ?a)
          :effect (and (not (robot-at ?a)) (robot-at ?b)))
        (:action start :parameters () :effect (running))
        (:action grasp :parameters (?p - pipette ?r - rack)
          :precondition (and (stands ?p ?r) (reach ?r))
          :effect (and (held ?p) (not (stands ?p ?r))))
        (:action put :parameters (?p - pipette ?r - rack) :precondition (and (held ?p) (reach ?r))
          :effect (and (not (held ?p)) (stands ?p ?r) (when (running) (clean ?p)))))""",
        """(define (problem wash) (:domain lab) (:objects r1 r2 - rack p - pipette)
        (:init (robot-at r1) (stands p r1)) (:goal (and (clean p) (stands p r2))))""",
    )
    assert found(task) == {
        facts("(held p)", "(stands p r1)", "(stands p r2)"): True,
        facts("(robot-at r1)", "(robot-at r2)"): True,
    }


@settings(max_examples=150, deadline=None)
@given(tasks() | tasks(derived=True))
def test_every_state_keeps_every_group(task: Task) -> None:
    for state in every_state(task):
        for group in task.mutex_groups:
            assert len(state & group.atoms) <= 1
            assert not group.exactly_one or state & group.atoms
