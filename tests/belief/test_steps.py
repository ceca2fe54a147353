"""Steps followed unseen: worked out backward they come to what the filter predicts forward."""

from math import isclose

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.belief.test_belief import plan_of
from tpvqa.belief.deciding.steps import Steps
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.pddl import Atom, load_task, task_from_text
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file

LOST = 100.0


@pytest.fixture(scope="module")
def model() -> FaultModel:
    files = find_task("clean_dishes")
    task = load_task(files.domain, files.problem)
    return FaultModel(task, load_world_file(files.world, task))


@settings(max_examples=15, deadline=None)
@given(
    times=st.lists(st.integers(0, 3), min_size=4, max_size=4),
    failure=st.floats(0.05, 0.6),
    disturbance=st.floats(0.0, 0.5),
    spontaneous=st.sampled_from([0.0, 0.05]),
    redone=st.sampled_from([0.0, 0.1]),
)
def test_what_is_paid_backward_is_what_is_lost_forward(
    model: FaultModel,
    times: list[int],
    failure: float,
    disturbance: float,
    spontaneous: float,
    redone: float,
) -> None:
    rates, plan = Rates(failure, disturbance, spontaneous, redone), plan_of(model.task)
    actions = [action for action, often in zip(plan, times, strict=False) for _ in range(often)]
    belief = Belief(model, smallest=0.0, most=100_000)
    (begun,) = belief.weights
    for action in actions:
        belief.act(action, rates)
    steps = Steps(model)
    steps.cover({begun: 1.0}, [tuple(actions)], rates)
    left = np.array([*(0.0 if model.goal_holds(n) else LOST for n in steps.numbers), LOST])[:, None]
    for action in reversed(actions):
        left = 1.0 + steps.back(action, left, failure, rates)
    lost = LOST * (1 - belief.where(model.task.goal_holds))
    told = float(left[steps.place[begun], 0])
    assert isclose(told, len(actions) + lost, rel_tol=0.01)


@settings(max_examples=25, deadline=None)
@given(
    data=st.data(),
    failure=st.floats(0.0, 1.0),
    disturbance=st.floats(0.0, 1.0),
    spontaneous=st.sampled_from([0.0, 0.05]),
    redone=st.sampled_from([0.0, 0.1]),
)
def test_forth_and_back_are_the_same_step(
    model: FaultModel,
    data: st.DataObject,
    failure: float,
    disturbance: float,
    spontaneous: float,
    redone: float,
) -> None:
    """What is expected after an action: of where it leads to, or of what it leads back to."""
    rates, plan = Rates(failure, disturbance, spontaneous, redone), plan_of(model.task)
    (begun,) = Belief(model).weights
    steps = Steps(model)
    steps.cover({begun: 1.0}, [tuple(plan)], rates)
    amounts = st.lists(
        st.floats(0, 10), min_size=len(steps.numbers) + 1, max_size=len(steps.numbers) + 1
    )
    masses, after = np.array(data.draw(amounts)), np.array(data.draw(amounts))
    action = data.draw(st.sampled_from(plan))
    led = steps.forth(action, masses, failure, rates)
    back = steps.back(action, after[:, None], failure, rates)[:, 0]
    assert isclose(float(led @ after), float(masses @ back), rel_tol=1e-9, abs_tol=1e-9)
    assert isclose(float(led.sum()), float(masses.sum()), rel_tol=1e-9, abs_tol=1e-9)


def test_what_is_not_told_apart_is_lost(model: FaultModel) -> None:
    steps, plan = Steps(model), plan_of(model.task)
    begun = next(iter(Belief(model).weights))
    steps.cover({begun: 1.0}, [], Rates())
    assert steps.numbers == [begun]
    after = steps.back(plan[0], np.array([[0.0], [LOST]]), 0.25, Rates(0.25, 0.0, 0.0))
    assert isclose(float(after[0, 0]), 0.75 * LOST)


STUDIO = """(define (domain studio) (:requirements :strips :typing) (:types room thing)
  (:predicates (robot-in ?r - room) (in ?t - thing ?r - room) (held ?t - thing) (hand-free)
    (open ?r - room) (clean ?t - thing) (packed ?t - thing))
  (:action go :parameters (?a ?b - room) :precondition (robot-in ?a)
    :effect (and (robot-in ?b) (not (robot-in ?a))))
  (:action unlock :parameters (?r - room) :precondition (and (robot-in ?r) (hand-free))
    :effect (open ?r))
  (:action take :parameters (?t - thing ?r - room)
    :precondition (and (robot-in ?r) (open ?r) (in ?t ?r) (hand-free))
    :effect (and (held ?t) (not (in ?t ?r)) (not (hand-free))))
  (:action put :parameters (?t - thing ?r - room)
    :precondition (and (robot-in ?r) (open ?r) (held ?t))
    :effect (and (in ?t ?r) (hand-free) (not (held ?t))))
  (:action clean :parameters (?t - thing ?r - room)
    :precondition (and (robot-in ?r) (in ?t ?r) (hand-free)) :effect (clean ?t))
  (:action pack :parameters (?t - thing ?r - room)
    :precondition (and (robot-in ?r) (in ?t ?r) (hand-free) (clean ?t)) :effect (packed ?t)))"""
PICTURES = """(define (problem pictures) (:domain studio)
  (:objects hall cellar attic - room frame canvas - thing)
  (:init (robot-in hall) (hand-free) (open hall) (in frame cellar) (in canvas attic))
  (:goal (and (packed frame) (packed canvas) (in frame hall) (in canvas hall))))"""
PACKING = """go hall cellar, unlock cellar, take frame cellar, go cellar hall, put frame hall,
    clean frame hall, pack frame hall, go hall attic, unlock attic, take canvas attic,
    go attic hall, put canvas hall, clean canvas hall, pack canvas hall"""


@pytest.mark.parametrize("often", [2, 3, 5])
def test_a_long_way_unseen_is_no_hopeless_one(often: int) -> None:
    """Fourteen steps with the robot and a thing perhaps elsewhere meet more joint states than can
    be told apart: those that are, are the ones that the way goes through."""
    task = task_from_text(STUDIO, PICTURES)
    words = (line.split() for line in PACKING.split(","))
    plan = [task.action(name, arguments) for name, *arguments in words]
    moved = [
        (task.init - {robot, frame} | {Atom("robot-in", (room,)), Atom("in", ("frame", there))})
        for robot, frame in [(Atom("robot-in", ("hall",)), Atom("in", ("frame", "cellar")))]
        for room in ("hall", "attic", "cellar")
        for there in ("cellar", "attic", "hall")
    ]
    chances = [0.42, 0.175, 0.105, 0.12, 0.05, 0.03, 0.06, 0.025, 0.015]
    model, rates = FaultModel(task), Rates(0.25, 0.25, 0.0)
    belief = Belief(model, smallest=1e-7, most=2000)
    belief.begin(list(zip(moved, chances, strict=True)))
    begun = dict(belief.weights)
    steps = Steps(model)
    steps.cover(begun, [tuple(plan)], rates)
    ended = [*(0.0 if model.goal_holds(n) else LOST for n in steps.numbers), LOST]
    left = np.array(ended)[:, None]
    done = [action for action in plan for _ in range(often)]
    for told_apart in (0.9, 0.55):  # that way, and once more after it
        for action in done:
            belief.act(action, rates)
        for action in reversed(done):
            left = steps.back(action, left, 0.25, rates)
        told = 1 - np.array([*begun.values()]) @ left[steps.places(begun), 0] / LOST
        there = belief.where(task.goal_holds)
        assert told_apart * there <= told <= there + 1e-6
