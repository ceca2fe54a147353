"""What joint states remember: nothing that no fault can lead back to, and all that one can."""

from random import Random

import pytest

from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.states.memory import ByRules, Past
from tpvqa.belief.states.undoing import BackToBefore
from tpvqa.pddl import Action, Atom, State, Task, task_from_text

DOMAIN = """(define (domain blocks)
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
    :effect (and (holding ?x) (clear ?y) (not (on ?x ?y)) (not (clear ?x)) (not (empty)))))"""
PROBLEM = """(define (problem three) (:domain blocks) (:objects a b c - block)
  (:init (on_table a) (on b a) (on_table c) (clear b) (clear c) (empty))
  (:goal (and (on a b) (on b c))))"""


@pytest.fixture(scope="module")
def blocks() -> Task:
    return task_from_text(DOMAIN, PROBLEM)


class _Whole(ByRules):
    """Remembers all that ended."""

    def __init__(self, task: Task):
        self._back = BackToBefore(task)
        super().__init__(task, (self._back,))

    def undone(self, atom: Atom, state: State, past: Past) -> list[tuple[float, State]]:
        return self._back.with_shares(atom, state, self._back.latest(atom, past))


def done(model: FaultModel, actions: list[Action]) -> Belief:
    belief = Belief(model, smallest=0.0, most=10**6)
    for action in actions:
        belief.act(action, Rates(0.25, 0.25, 0.1))
    return belief


@pytest.mark.parametrize("seed", range(10))
def test_forgetting_what_no_fault_leads_back_to_changes_no_probability(
    blocks: Task, seed: int
) -> None:
    """The filter that remembers all that ended is the same one, with more joint states."""
    random, actions = Random(seed), list[Action]()
    state = blocks.init
    for _ in range(6):
        possible = [each for each in blocks.ground_actions() if blocks.applicable(state, each)]
        actions.append(random.choice(possible))
        state = blocks.apply(state, actions[-1])
    short, whole = FaultModel(blocks), FaultModel(blocks)
    whole._memory = _Whole(blocks)
    few, many = done(short, actions), done(whole, actions)
    for atom in blocks.atoms():
        assert few.probability(atom) == pytest.approx(many.probability(atom), abs=1e-12)
    assert len(few.weights) < len(many.weights)
