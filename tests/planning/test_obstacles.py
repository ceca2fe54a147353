"""Why there is no plan, where that can be told: by the fact that nothing brings about."""

import pytest

from tpvqa.pddl import task_from_text
from tpvqa.planning import Plan, Planner, Unsolvable
from tpvqa.planning.fast_downward import FastDownward

DOMAIN = """(define (domain tools) (:requirements :strips :typing) (:types tool room)
(:predicates (in ?t - tool ?r - room) (beside ?a ?b - room) (at ?r - room) (held ?t - tool)
  (fits ?t - tool) (done))
(:action go :parameters (?a ?b - room) :precondition (and (at ?a) (beside ?a ?b))
  :effect (and (at ?b) (not (at ?a))))
(:action take :parameters (?t - tool ?r - room) :precondition (and (at ?r) (in ?t ?r))
  :effect (and (held ?t) (not (in ?t ?r))))
(:action mend :parameters (?t - tool) :precondition (and (held ?t) (fits ?t))
  :effect (and (done) (not (held ?t)))))"""
PROBLEM = """(define (problem p) (:domain tools) (:objects saw axe - tool hall shed - room)
(:init (at hall) (in saw shed) {init}) (:goal {goal}))"""


@pytest.mark.parametrize(
    ("init", "goal", "says"),
    [
        ("(beside hall shed) (fits saw)", "(done)", None),
        (
            "(beside shed hall) (fits saw)",
            "(done)",
            "the goal needs done(); go(hall, shed) needs beside(hall, shed), which nothing brings "
            "about (beside(shed, hall) holds: are its arguments in the right order?)",
        ),
        (
            "(beside hall shed)",
            "(done)",
            "mend(saw) needs fits(saw), which nothing brings about and which does not hold",
        ),
        (
            "(beside hall shed) (fits saw)",
            "(fits axe)",
            "the goal needs fits(axe), which nothing brings about and which does not hold "
            "(fits(saw) does)",
        ),
        # Each of the two can be had, but not both: nothing that this could name.
        ("(beside hall shed) (fits saw)", "(and (done) (held saw))", ""),
    ],
)
def test_what_nothing_brings_about_is_named(init: str, goal: str, says: str | None) -> None:
    planner: Planner = FastDownward()
    result = planner.plan(task_from_text(DOMAIN, PROBLEM.format(init=init, goal=goal)))
    planner.close()
    if says is None:
        assert isinstance(result, Plan)
    else:
        assert isinstance(result, Unsolvable)
        assert says in result.reason
        assert says or "needs" not in result.reason


CHAIN = 1500
ROADS = """(define (domain roads) (:requirements :strips :action-costs)
(:predicates (at ?a) (near ?a ?b)) (:functions (total-cost) (len ?a ?b))
(:action go :parameters (?a ?b) :precondition (and (at ?a) (near ?a ?b))
  :effect (and (at ?b) (not (at ?a)) (increase (total-cost) (len ?a ?b)))))"""
STEPS = "(define (domain steps) (:predicates (s0) {facts}) {actions})".format(
    facts=" ".join(f"(s{n})" for n in range(1, CHAIN)),
    actions=" ".join(
        f"(:action a{n} :precondition (s{n}) :effect (s{n + 1}))" for n in range(CHAIN - 1)
    ),
)


@pytest.mark.parametrize(
    ("domain", "problem", "says"),
    [
        (  # costs of roads that are not there are not asked for
            ROADS,
            """(define (problem p) (:domain roads) (:objects a b c) (:init (at a) (near a b)
            (= (total-cost) 0) (= (len a b) 3)) (:goal (at c)) (:metric minimize (total-cost)))""",
            "needs near(",
        ),
        (  # however long the chain is
            STEPS,
            f"(define (problem p) (:domain steps) (:init) (:goal (s{CHAIN - 1})))",
            f"the goal needs s{CHAIN - 1}(); a0() needs s0(), which nothing brings about",
        ),
    ],
)
def test_a_hint_changes_no_result(domain: str, problem: str, says: str) -> None:
    planner: Planner = FastDownward()
    result = planner.plan(task_from_text(domain, problem))
    planner.close()
    assert isinstance(result, Unsolvable)
    assert says in result.reason
