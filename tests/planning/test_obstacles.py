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
