"""Problems with long plans, for benchmarks: a tower in another order, things all over a home."""

from itertools import pairwise
from random import Random

TOWER = """(define (domain tower)
  (:requirements :strips :typing) (:types block)
  (:predicates (on ?x ?y - block) (on_table ?x - block) (clear ?x - block) (holding ?x - block)
    (empty))
  (:action pick_up :parameters (?x - block)
    :precondition (and (clear ?x) (on_table ?x) (empty))
    :effect (and (holding ?x) (not (on_table ?x)) (not (clear ?x)) (not (empty))))
  (:action put_down :parameters (?x - block)
    :precondition (holding ?x)
    :effect (and (on_table ?x) (clear ?x) (empty) (not (holding ?x))))
  (:action stack :parameters (?x ?y - block)
    :precondition (and (holding ?x) (clear ?y))
    :effect (and (on ?x ?y) (clear ?x) (empty) (not (holding ?x)) (not (clear ?y))))
  (:action unstack :parameters (?x ?y - block)
    :precondition (and (on ?x ?y) (clear ?x) (empty))
    :effect (and (holding ?x) (clear ?y) (not (on ?x ?y)) (not (clear ?x)) (not (empty)))))
"""

HOME = """(define (domain home)
  (:requirements :strips :typing :negative-preconditions)
  (:types item place - object cupboard - place)
  (:predicates (robot_at ?p - place) (at ?x - item ?p - place) (in_hand ?x - item) (hand_free)
    (closed ?p - place))
  (:action go :parameters (?from ?to - place)
    :precondition (robot_at ?from)
    :effect (and (robot_at ?to) (not (robot_at ?from))))
  (:action open :parameters (?p - cupboard)
    :precondition (and (robot_at ?p) (closed ?p) (hand_free))
    :effect (not (closed ?p)))
  (:action take :parameters (?x - item ?p - place)
    :precondition (and (robot_at ?p) (at ?x ?p) (hand_free) (not (closed ?p)))
    :effect (and (in_hand ?x) (not (at ?x ?p)) (not (hand_free))))
  (:action put :parameters (?x - item ?p - place)
    :precondition (and (robot_at ?p) (in_hand ?x) (not (closed ?p)))
    :effect (and (at ?x ?p) (hand_free) (not (in_hand ?x)))))
"""


def tower_problem(blocks: int, *, seed: int = 0) -> str:
    """One tower that is to stand in another order."""
    random, names = Random(seed), [f"b{number}" for number in range(blocks)]
    before, after = random.sample(names, blocks), random.sample(names, blocks)
    tower = [f"(on_table {before[0]})", f"(clear {before[-1]})", "(empty)"]
    tower += [f"(on {upper} {lower})" for lower, upper in pairwise(before)]
    goal = [f"(on {upper} {lower})" for lower, upper in pairwise(after)]
    return (
        f"(define (problem other_order) (:domain tower) (:objects {' '.join(names)} - block)\n"
        f"(:init {' '.join(tower)})\n(:goal (and {' '.join(goal)})))"
    )


def home_problem(things: int, *, seed: int = 0) -> str:
    """Things all over a home, half of them to be brought elsewhere; some places are closed."""
    random = Random(seed)
    cupboards = [f"cupboard{n}" for n in range(5)]
    places = [*(f"table{n}" for n in range(7)), *cupboards]
    names = [f"thing{n}" for n in range(things)]
    lying = {name: random.choice(places) for name in names}
    facts = ["(robot_at table0)", "(hand_free)", *(f"(closed {each})" for each in cupboards)]
    facts += [f"(at {name} {place})" for name, place in lying.items()]
    goal = []
    for name in names[: things // 2]:
        elsewhere = [place for place in places if place != lying[name]]
        goal.append(f"(at {name} {random.choice(elsewhere)})")
    return (
        f"(define (problem tidy) (:domain home) (:objects {' '.join(names)} - item\n"
        f"{' '.join(places[:7])} - place {' '.join(cupboards)} - cupboard)\n"
        f"(:init {' '.join(facts)})\n(:goal (and {' '.join(goal)})))"
    )
