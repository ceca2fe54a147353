"""Large tasks of which little matters: a scene of a home, logistics, blocksworld, for benchmarks.

The scene's domain is written as those for simulated homes are: no types but `item`, what a thing
is good for said by static facts, and effects for all things beside another.
"""

from itertools import pairwise
from random import Random

SCENE = """(define (domain scene)
  (:requirements :adl :typing)
  (:types agent item)
  (:predicates
    (grabbable ?x - item) (surface ?x - item) (container ?x - item) (lidded ?x - item)
    (switched ?x - item) (plugged_in ?x - item) (basin ?x - item) (room ?x - item)
    (open ?x - item) (on ?x - item) (clean ?x - item) (seat ?x - item)
    (in_room ?x ?r - item) (beside ?x ?y - item) (ontop ?x ?y - item) (inside ?x ?y - item)
    (within ?a - agent ?r - item) (next_to ?a - agent ?x - item) (sitting ?a - agent)
    (in_left ?a - agent ?x - item) (in_right ?a - agent ?x - item))
  (:action enter
    :parameters (?a - agent ?r - item)
    :precondition (and (room ?r) (not (sitting ?a)))
    :effect (and (within ?a ?r)
      (forall (?o - item) (when (not (= ?o ?r)) (not (within ?a ?o))))
      (forall (?o - item) (not (next_to ?a ?o)))))
  (:action walk_to
    :parameters (?a - agent ?x ?r - item)
    :precondition (and (in_room ?x ?r) (within ?a ?r) (not (sitting ?a)))
    :effect (and (next_to ?a ?x)
      (forall (?o - item) (when (not (beside ?o ?x)) (not (next_to ?a ?o))))
      (forall (?o - item) (when (beside ?o ?x) (next_to ?a ?o)))))
  (:action grab
    :parameters (?a - agent ?x - item)
    :precondition (and (grabbable ?x) (next_to ?a ?x)
      (not (exists (?o - item) (and (inside ?x ?o) (lidded ?o) (not (open ?o)))))
      (not (in_left ?a ?x)) (not (in_right ?a ?x))
      (not (and (exists (?o - item) (in_left ?a ?o)) (exists (?o - item) (in_right ?a ?o)))))
    :effect (and
      (when (exists (?o - item) (in_left ?a ?o)) (in_right ?a ?x))
      (when (not (exists (?o - item) (in_left ?a ?o))) (in_left ?a ?x))
      (forall (?o - item) (and (not (ontop ?x ?o)) (not (inside ?x ?o))))
      (forall (?o - item) (and (not (beside ?x ?o)) (not (beside ?o ?x))))))
  (:action put_on
    :parameters (?a - agent ?x ?y - item)
    :precondition (and (surface ?y) (next_to ?a ?y) (or (in_left ?a ?x) (in_right ?a ?x)))
    :effect (and (ontop ?x ?y) (beside ?x ?y) (beside ?y ?x)
      (not (in_left ?a ?x)) (not (in_right ?a ?x))))
  (:action put_inside
    :parameters (?a - agent ?x ?y - item)
    :precondition (and (container ?y) (next_to ?a ?y) (or (not (lidded ?y)) (open ?y))
      (or (in_left ?a ?x) (in_right ?a ?x)))
    :effect (and (inside ?x ?y) (beside ?x ?y) (beside ?y ?x)
      (not (in_left ?a ?x)) (not (in_right ?a ?x))))
  (:action open_up
    :parameters (?a - agent ?x - item)
    :precondition (and (lidded ?x) (next_to ?a ?x) (not (open ?x)) (not (on ?x)))
    :effect (open ?x))
  (:action shut
    :parameters (?a - agent ?x - item)
    :precondition (and (lidded ?x) (next_to ?a ?x) (open ?x))
    :effect (not (open ?x)))
  (:action plug_in
    :parameters (?a - agent ?x - item)
    :precondition (and (switched ?x) (next_to ?a ?x) (not (plugged_in ?x)))
    :effect (plugged_in ?x))
  (:action switch_on
    :parameters (?a - agent ?x - item)
    :precondition (and (switched ?x) (plugged_in ?x) (next_to ?a ?x) (not (on ?x)) (not (open ?x)))
    :effect (on ?x))
  (:action wash
    :parameters (?a - agent ?x ?b - item)
    :precondition (and (basin ?b) (next_to ?a ?b) (or (in_left ?a ?x) (in_right ?a ?x)))
    :effect (clean ?x))
  (:action sit_on
    :parameters (?a - agent ?x - item)
    :precondition (and (seat ?x) (next_to ?a ?x) (not (sitting ?a)))
    :effect (sitting ?a))
  (:action get_up
    :parameters (?a - agent)
    :precondition (sitting ?a)
    :effect (not (sitting ?a))))
"""

_ROOMS = ("kitchen", "living_room", "bedroom", "bathroom")
_WANTED = ("dishwasher", "plate", "soap", "sink", "table", "cupboard")


def scene_problem(things: int, *, seed: int = 0) -> str:
    """A home in which dishes are to be washed in a machine, and so many things lie about besides.

    Args:
        things: How many things there are besides rooms, agent and what the goal is about.
        seed: What they are and where they are.
    """
    random = Random(seed)
    names = [f"thing{n}" for n in range(things)]
    facts = [f"(room {room})" for room in _ROOMS]
    facts += [f"(in_room {name} kitchen)" for name in _WANTED]
    facts += ["(surface table)", "(basin sink)", "(container dishwasher)", "(lidded dishwasher)"]
    facts += ["(switched dishwasher)", "(grabbable plate)", "(grabbable soap)", "(lidded cupboard)"]
    facts += ["(container cupboard)", "(ontop plate table)", "(inside soap cupboard)"]
    facts += ["(beside plate table)", "(beside table plate)", "(within robot living_room)"]
    facts += ["(beside soap cupboard)", "(beside cupboard soap)", "(sitting robot)"]
    placed: dict[str, list[str]] = {room: [] for room in _ROOMS}
    for number, name in enumerate(names):
        room = random.choice(_ROOMS)
        facts.append(f"(in_room {name} {room})")
        if number % 4 == 0 or not placed[room]:  # furniture
            facts.append(f"(surface {name})")
            if random.random() < 0.5:
                facts += [f"(container {name})", f"(lidded {name})"]
            if random.random() < 0.3:
                facts.append(f"(switched {name})")
            placed[room].append(name)
        else:
            home = random.choice(placed[room])
            facts += [f"(grabbable {name})", f"(ontop {name} {home})"]
            facts += [f"(beside {name} {home})", f"(beside {home} {name})"]
    return f"""(define (problem scene_{things}) (:domain scene)
  (:objects robot - agent {" ".join((*_ROOMS, *_WANTED, *names))} - item)
  (:init {" ".join(facts)})
  (:goal (and (inside plate dishwasher) (inside soap dishwasher) (not (open dishwasher))
    (on dishwasher))))
"""


LOGISTICS = """(define (domain logistics)
  (:requirements :strips :typing)
  (:types truck plane - vehicle vehicle parcel - thing airport - place thing place city)
  (:predicates (in_city ?p - place ?c - city) (at ?x - thing ?p - place)
    (in ?x - parcel ?v - vehicle))
  (:action load
    :parameters (?x - parcel ?v - vehicle ?p - place)
    :precondition (and (at ?v ?p) (at ?x ?p))
    :effect (and (not (at ?x ?p)) (in ?x ?v)))
  (:action unload
    :parameters (?x - parcel ?v - vehicle ?p - place)
    :precondition (and (at ?v ?p) (in ?x ?v))
    :effect (and (not (in ?x ?v)) (at ?x ?p)))
  (:action drive
    :parameters (?t - truck ?from ?to - place ?c - city)
    :precondition (and (at ?t ?from) (in_city ?from ?c) (in_city ?to ?c))
    :effect (and (not (at ?t ?from)) (at ?t ?to)))
  (:action fly
    :parameters (?a - plane ?from ?to - airport)
    :precondition (at ?a ?from)
    :effect (and (not (at ?a ?from)) (at ?a ?to))))
"""


def logistics_problem(objects: int, *, seed: int = 0, wanted: int = 3) -> str:
    """Parcels all over many cities, of which a few are to be brought elsewhere.

    Args:
        objects: About how many objects there are: half of them parcels, a third places.
        seed: Where they are.
        wanted: How many parcels the goal is about.
    """
    random = Random(seed)
    cities = [f"city{n}" for n in range(max(2, objects // 20))]
    places = [f"{city}_place{n}" for city in cities for n in range(5)]
    ports = [f"{city}_airport" for city in cities]
    trucks = [f"{city}_truck" for city in cities]
    planes = [f"plane{n}" for n in range(max(1, len(cities) // 5))]
    parcels = [f"parcel{n}" for n in range(objects - 8 * len(cities) - len(planes))]
    everywhere = places + ports
    facts = [f"(in_city {place} {place.rsplit('_', 1)[0]})" for place in everywhere]
    facts += [f"(at {truck} {truck.rsplit('_', 1)[0]}_place0)" for truck in trucks]
    facts += [f"(at {plane} {random.choice(ports)})" for plane in planes]
    facts += [f"(at {parcel} {random.choice(everywhere)})" for parcel in parcels]
    goals = [f"(at {parcel} {random.choice(everywhere)})" for parcel in parcels[:wanted]]
    return f"""(define (problem logistics_{objects}) (:domain logistics)
  (:objects {" ".join(cities)} - city {" ".join(places)} - place {" ".join(ports)} - airport
    {" ".join(trucks)} - truck {" ".join(planes)} - plane {" ".join(parcels)} - parcel)
  (:init {" ".join(facts)})
  (:goal (and {" ".join(goals)})))
"""


BLOCKS = """(define (domain blocks)
  (:requirements :strips)
  (:predicates (on ?x ?y) (ontable ?x) (clear ?x) (handempty) (holding ?x))
  (:action pick_up
    :parameters (?x)
    :precondition (and (clear ?x) (ontable ?x) (handempty))
    :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty)) (holding ?x)))
  (:action put_down
    :parameters (?x)
    :precondition (holding ?x)
    :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))
  (:action stack
    :parameters (?x ?y)
    :precondition (and (holding ?x) (clear ?y))
    :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))
  (:action unstack
    :parameters (?x ?y)
    :precondition (and (on ?x ?y) (clear ?x) (handempty))
    :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y)))))
"""


def blocks_problem(blocks: int, *, seed: int = 0, wanted: int = 4) -> str:
    """Towers of four or so, of which a few blocks are to make another.

    Args:
        blocks: How many blocks there are.
        seed: Which tower they are in.
        wanted: How many blocks the goal is about.
    """
    random = Random(seed)
    names = [f"b{n}" for n in range(blocks)]
    order = random.sample(names, blocks)
    facts = ["(handempty)"]
    for start in range(0, blocks, 4):
        tower = order[start : start + 4]
        facts += [f"(ontable {tower[0]})", f"(clear {tower[-1]})"]
        facts += [f"(on {upper} {lower})" for lower, upper in pairwise(tower)]
    goal = [f"(on {x} {y})" for x, y in pairwise(names[:wanted])]
    return f"""(define (problem blocks_{blocks}) (:domain blocks)
  (:objects {" ".join(names)})
  (:init {" ".join(facts)})
  (:goal (and {" ".join(goal)})))
"""
