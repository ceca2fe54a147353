"""A goal that wants what no action ends: told, with how it comes to hold."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa

__all__ = ["tpvqa"]
DOMAIN = """(define (domain belt) (:requirements :strips :typing :negative-preconditions)
  (:types can - object)
  (:predicates (magnet-on) (jammed) (on-belt ?c - can) (caught ?c - can))
  (:action energise :parameters () :precondition (not (magnet-on)) :effect (magnet-on))
  (:action jam :parameters () :precondition (not (jammed)) :effect (jammed))
  (:action sweep :parameters (?c - can) :precondition (and (magnet-on) (on-belt ?c))
    :effect (and (caught ?c) (not (on-belt ?c)))))"""
PROBLEM = """(define (problem p) (:domain belt) (:objects tin - can) (:init (on-belt tin) {init})
  (:goal (and {goal})))"""


@pytest.mark.parametrize(
    ("init", "goal", "says"),
    [
        (
            "",
            "(caught tin) (not (magnet-on))",
            "the goal wants (not (magnet-on)), but every way to the rest of it brings about "
            "(magnet-on), which no action ends",
        ),
        ("(jammed)", "(caught tin) (not (jammed))", "(not (jammed)), which holds, and no action"),
        ("", "(caught tin) (on-belt tin) (not (jammed))", "never hold together"),
        ("", "(caught tin) (not (jammed))", None),
    ],
)
def test_what_the_goal_wants_to_have_ended_is_named(
    init: str, goal: str, says: str | None, tpvqa: Run
) -> None:
    Path("domain.pddl").write_text(DOMAIN)
    Path("problem.pddl").write_text(PROBLEM.format(init=init, goal=goal))
    code, out, _ = tpvqa("check", "domain.pddl", "problem.pddl")
    assert code == (0 if says is None else 1)
    assert "brings about" not in out if says is None else says in out
