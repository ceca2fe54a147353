"""Opposites that are both asked about: told where they are some of every object, and safely."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa

__all__ = ["tpvqa"]
DOMAIN = """(define (domain bins) (:requirements :adl)
  (:types bin - object)
  (:predicates (lid-open ?b - bin) (sealed ?b - bin))
  (:action open-lid :parameters (?b - bin)
    :precondition (and (not (lid-open ?b)) (not (sealed ?b))) :effect (lid-open ?b))
  (:action seal-bin :parameters (?b - bin)
    :effect (when (lid-open ?b) (and (sealed ?b) (not (lid-open ?b))))))"""
PROBLEM = """(define (problem p) (:domain bins) (:objects cage skip - bin)
  (:init (lid-open cage) (lid-open skip)) (:goal (and (sealed cage) (sealed skip))))"""
QUESTIONS = """predicates: {lid-open: "Is the lid of the {b} open?", sealed: "Is the {b} sealed?"}
actions: {open-lid: {say: "open the {b}", done: "opened the {b}"},
  seal-bin: {say: "seal the {b}", done: "sealed the {b}"}}
"""


@pytest.fixture
def said(tpvqa: Run) -> "Said":
    return Said(tpvqa)


class Said:
    """What the command says of opposites in the bins, with a problem changed."""

    def __init__(self, tpvqa: Run):
        self._tpvqa = tpvqa

    def __call__(self, old: str = "", new: str = "", questions: str = QUESTIONS) -> str:
        assert old in PROBLEM
        Path("domain.pddl").write_text(DOMAIN)
        Path("problem.pddl").write_text(PROBLEM.replace(old, new) if old else PROBLEM)
        Path("questions.yaml").write_text(questions)
        code, out, _ = self._tpvqa("check", "domain.pddl", "problem.pddl")
        assert code == 0
        return out


def test_the_one_that_the_goal_does_not_want_is_left_unasked(said: Said) -> None:
    out = said()
    assert "exactly one of lid-open and sealed holds, and both are asked about" in out
    assert '- fact: "(lid-open ?b)"' in out
    assert "because: it is asked as sealed, its opposite\n" in out


def test_it_is_said_where_the_goal_wants_what_is_left_unasked(said: Said) -> None:
    out = said("(sealed skip))", "(lid-open skip))")
    assert '- fact: "(sealed ?b)"' in out
    assert "because: it is asked as lid-open, its opposite; so is what the goal wants of it" in out


def test_opposites_of_one_object_alone_are_none(said: Said) -> None:
    """The skip is at first neither open nor sealed."""
    assert "exactly one of" not in said("(lid-open skip)) (:goal", ") (:goal")


def test_what_is_left_unasked_is_asked_as_its_opposite_of_every_object(said: Said) -> None:
    never = 'never_asked: [{fact: "(sealed skip)", because: "the skip stands behind a wall"}]\n'
    assert "exactly one of" not in said(questions=QUESTIONS + never)
