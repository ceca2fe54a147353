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
