"""Generated problems that a search with FF alone finds no plan for, or late."""

from itertools import pairwise
from random import Random

OPENSTACKS = """(define (domain openstacks) (:requirements :adl :typing :action-costs)
(:types order product count)
(:predicates (includes ?o - order ?p - product) (waiting ?o - order) (started ?o - order)
  (shipped ?o - order) (made ?p - product) (stacks ?n - count) (next ?a ?b - count))
(:functions (total-cost) - number)
(:action open-new-stack :parameters (?a ?b - count)
  :precondition (and (stacks ?a) (next ?a ?b))
  :effect (and (not (stacks ?a)) (stacks ?b) (increase (total-cost) 1)))
(:action start-order :parameters (?o - order ?a ?b - count)
  :precondition (and (waiting ?o) (stacks ?b) (next ?a ?b))
  :effect (and (not (waiting ?o)) (started ?o) (not (stacks ?b)) (stacks ?a)))
(:action make-product :parameters (?p - product)
  :precondition (and (not (made ?p))
    (forall (?o - order) (imply (includes ?o ?p) (started ?o))))
  :effect (made ?p))
(:action ship-order :parameters (?o - order ?a ?b - count)
  :precondition (and (started ?o) (stacks ?a) (next ?a ?b)
    (forall (?p - product) (imply (includes ?o ?p) (made ?p))))
  :effect (and (not (started ?o)) (shipped ?o) (not (stacks ?a)) (stacks ?b))))
"""
"""In the manner of the domain of IPC 2008; written anew."""

VISIT = """(define (domain visit) (:requirements :typing) (:types cell)
(:predicates (at ?c - cell) (visited ?c - cell) (next ?a ?b - cell))
(:action move :parameters (?a ?b - cell) :precondition (and (at ?a) (next ?a ?b))
  :effect (and (not (at ?a)) (at ?b) (visited ?b))))
"""

PRINTER = """(define (domain printer) (:requirements :adl :typing :action-costs)
(:types sheet part ink side)
(:predicates (blank ?s - sheet) (at ?s - sheet ?p - part) (free ?p - part) (link ?a ?b - part)
  (feeds ?p - part) (stacks ?p - part) (turns ?p - part) (prints ?p - part ?k - ink)
  (up ?s - sheet ?u - side) (other ?u ?v - side) (wants ?s - sheet ?u - side ?k - ink)
  (has ?s - sheet ?u - side ?k - ink) (after ?s ?t - sheet) (stacked ?s - sheet))
(:functions (total-cost) - number (price ?k - ink) - number)
(:action feed :parameters (?s - sheet ?p - part)
  :precondition (and (blank ?s) (feeds ?p) (free ?p))
  :effect (and (not (blank ?s)) (at ?s ?p) (not (free ?p)) (increase (total-cost) 1)))
(:action pass :parameters (?s - sheet ?p ?q - part)
  :precondition (and (at ?s ?p) (link ?p ?q) (free ?q))
  :effect (and (not (at ?s ?p)) (free ?p) (at ?s ?q) (not (free ?q)) (increase (total-cost) 1)))
(:action print :parameters (?s - sheet ?p - part ?k - ink ?u - side)
  :precondition (and (at ?s ?p) (prints ?p ?k) (up ?s ?u) (wants ?s ?u ?k))
  :effect (and (has ?s ?u ?k) (increase (total-cost) (price ?k))))
(:action turn :parameters (?s - sheet ?p - part ?u ?v - side)
  :precondition (and (at ?s ?p) (turns ?p) (up ?s ?u) (other ?u ?v))
  :effect (and (not (up ?s ?u)) (up ?s ?v) (increase (total-cost) 1)))
(:action stack :parameters (?s - sheet ?t - sheet ?p - part)
  :precondition (and (at ?s ?p) (stacks ?p) (after ?s ?t) (stacked ?t)
    (forall (?u - side ?k - ink) (imply (wants ?s ?u ?k) (has ?s ?u ?k))))
  :effect (and (not (at ?s ?p)) (free ?p) (stacked ?s) (increase (total-cost) 1))))
"""
"""In the manner of IPC 2008's parcprinter: sheets go one way through parts that hold one each,
past engines for each ink, and are stacked in their order; written anew."""


def printer(sheets: int, *, lines: int = 2, seed: int = 0) -> str:
    """Sheets with images on one side or both, through parallel lines of an engine for each ink."""
    random, names = Random(seed), [f"s{n}" for n in range(sheets + 1)]
    facts, parts = ["(other front back)", "(other back front)", "(stacked s0)"], ["feeder", "tray"]
    facts += ["(feeds feeder)", "(stacks tray)"]
    for line in range(lines):
        own = [f"{kind}{line}" for kind in ("in", "black", "colour", "turner", "again", "out")]
        facts += [f"(link {a} {b})" for a, b in pairwise(["feeder", *own, "tray"])]
        facts += [f"(prints black{line} black)", f"(prints colour{line} colour)"]
        facts += [f"(turns turner{line})", f"(link again{line} in{(line + 1) % lines})"]
        facts += [f"(link in{line} colour{line})"]
        parts += own
    for before, name in pairwise(names):
        facts += [f"(blank {name})", f"(up {name} front)", f"(after {name} {before})"]
        for side in ("front", "back")[: random.choice((1, 2, 2))]:
            facts.append(f"(wants {name} {side} {random.choice(('black', 'colour'))})")
    facts += [f"(free {part})" for part in parts]
    return f"""(define (problem prints) (:domain printer)
(:objects {" ".join(names)} - sheet {" ".join(parts)} - part black colour - ink front back - side)
(:init (= (total-cost) 0) (= (price black) 5) (= (price colour) 20) {" ".join(facts)})
(:goal (and {" ".join(f"(stacked {name})" for name in names[1:])}))
(:metric minimize (total-cost)))
"""


def openstacks(orders: int, *, seed: int = 0) -> str:
    """As many orders as products; how many stacks are open counts."""
    random = Random(seed)
    names = [f"o{n}" for n in range(orders)]
    products = [f"p{n}" for n in range(orders)]
    counts = [f"n{n}" for n in range(orders + 1)]
    facts = [f"(next {a} {b})" for a, b in pairwise(counts)]
    for product in products:
        wanting = random.sample(names, min(orders, random.randint(1, 3)))
        facts += [f"(includes {order} {product})" for order in wanting]
    facts += [f"(includes {name} {random.choice(products)})" for name in names]
    facts += [f"(waiting {name})" for name in names]
    return f"""(define (problem orders) (:domain openstacks)
(:objects {" ".join(names)} - order {" ".join(products)} - product {" ".join(counts)} - count)
(:init (= (total-cost) 0) (stacks n0) {" ".join(dict.fromkeys(facts))})
(:goal (and {" ".join(f"(shipped {name})" for name in names)}))
(:metric minimize (total-cost)))
"""


def visit(side: int) -> str:
    """All cells of a square, beginning in its middle."""
    cells = {(x, y): f"c{x}_{y}" for x in range(side) for y in range(side)}
    beside = [
        f"(next {name} {cells[other]})"
        for (x, y), name in cells.items()
        for other in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1))
        if other in cells
    ]
    return f"""(define (problem square) (:domain visit) (:objects {" ".join(cells.values())} - cell)
(:init (at c{side // 2}_{side // 2}) (visited c{side // 2}_{side // 2}) {" ".join(beside)})
(:goal (and {" ".join(f"(visited {name})" for name in cells.values())})))
"""
