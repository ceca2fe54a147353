"""Large tasks, of which objects are left out before grounding: plans hold, and none gets lost."""

import re
from pathlib import Path
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pddl.feature_domains import SAMPLES, Sample
from tests.planning.judges import COMPLETE
from tests.planning.random_states import random_states
from tests.planning.test_differential import judge
from tpvqa.pddl import Atom, Task, load_task, task_from_text, validate
from tpvqa.planning import Plan, Unsolvable
from tpvqa.planning.fast_downward import FastDownward

PER_SAMPLE = 3


def large(domain: str) -> str:
    """A domain that counts as large: an action of many arguments, which nothing makes possible."""
    of = " - object" if ":typing" in domain else ""
    names = [f"?v{number}" for number in range(14)]
    needed = " ".join(f"(never {first} {second})" for first, second in zip(names, names[1:]))
    action = (
        f"(:action nothing :parameters ({' '.join(names)}{of}) :precondition (and {needed}) "
        "\n:effect (done_nothing))"
    )
    predicates = f"(:predicates (never ?x ?y{of}) (done_nothing)"
    return domain.replace("(:predicates", predicates, 1).rstrip()[:-1] + action + ")"


def with_more(problem: str, each: int) -> str:
    """A problem with so many more objects of each kind, of which it says nothing."""
    found = re.search(r"\(:objects ([^)]*)\)", problem)
    assert found is not None
    kinds = dict.fromkeys(re.findall(r"- (\w+)", found[1])) or {"": None}
    more = [
        " ".join(f"more{kind}{number}" for number in range(each)) + (f" - {kind}" if kind else "")
        for kind in kinds
    ]
    return problem.replace(found[0], f"(:objects {found[1]} {' '.join(more)})")


PLAIN = [
    each for each in SAMPLES if "(:objects " in each.problem and "(:predicates (" in each.domain
]


def read(domain: str, problem: str, more: int) -> Task:
    """A large task, in which every object that does not matter is left out."""
    return task_from_text(large(domain), with_more(problem, more))


@pytest.mark.slow
@pytest.mark.parametrize("sample", PLAIN, ids=lambda sample: sample.name)
def test_every_feature_agrees_with_the_judges(sample: Sample, tmp_path: Path) -> None:
    task = read(sample.domain, sample.problem, 2)
    states = list(random_states(task, seed=4, count=PER_SAMPLE))
    judge(task, [task.init, *states], tmp_path, search=COMPLETE, val=sample.val)


STORE = """(define (domain store) (:requirements :adl :typing)
(:types place thing - object)
(:predicates (way ?a ?b - place) (here ?p - place) (at ?x - thing ?p - place) (held ?x - thing)
  (shut ?p - place) (opens ?x - thing ?p - place) (heavy ?x - thing) (tired) (seen ?p - place))
(:action go :parameters (?a ?b - place)
  :precondition (and (here ?a) (way ?a ?b) (not (shut ?b)))
  :effect (and (here ?b) (not (here ?a)) (seen ?b)
    (forall (?x - thing) (when (held ?x) (and (at ?x ?b) (not (at ?x ?a)))))
    (forall (?x - thing) (when (and (at ?x ?b) (heavy ?x)) (tired)))))
(:action unlock :parameters (?x - thing ?a ?b - place)
  :precondition (and (here ?a) (way ?a ?b) (shut ?b) (held ?x) (opens ?x ?b))
  :effect (not (shut ?b)))
(:action take :parameters (?x - thing ?p - place)
  :precondition (and (here ?p) (at ?x ?p) (not (tired)) (not (exists (?y - thing) (held ?y))))
  :effect (held ?x))
(:action drop :parameters (?x - thing) :precondition (held ?x) :effect (not (held ?x)))
(:action rest :parameters (?p - place)
  :precondition (and (here ?p) (forall (?x - thing) (not (and (at ?x ?p) (heavy ?x)))))
  :effect (not (tired))))"""
"""Things weigh on the robot, are held one at a time, and open doors; some goals are out of reach."""


@st.composite
def stores(draw: st.DrawFn) -> tuple[str, list[str]]:
    """A problem of the store, and the facts of another state of it."""
    random = Random(draw(st.integers(0, 1 << 30)))
    places = [f"p{number}" for number in range(random.randrange(3, 8))]
    things = [f"x{number}" for number in range(random.randrange(3, 9))]
    static = []
    for number, place in enumerate(places[1:], 1):
        other = random.choice(places[:number])
        static += [f"(way {other} {place})", f"(way {place} {other})"]
    shut = random.sample(places[1:], random.randrange(3))
    static += [f"(opens {random.choice(things)} {place})" for place in shut]
    static += [f"(heavy {thing})" for thing in things if random.random() < 0.2]

    def facts() -> list[str]:
        lying = [f"(at {thing} {random.choice(places)})" for thing in things]
        return [*lying, f"(here {random.choice(places)})", *(f"(shut {each})" for each in shut)]

    goal = [f"(at {x} {random.choice(places)})" for x in random.sample(things, 2)]
    goal += random.choice([[], ["(not (tired))"], [f"(seen {random.choice(places)})"]])
    problem = (
        f"(define (problem one) (:domain store) (:objects {' '.join(places)} - place "
        f"{' '.join(things)} - thing) (:init {' '.join((*static, *facts()))}) "
        f"(:goal (and {' '.join(goal)})))"
    )
    return problem, [*static, *facts()]


@settings(max_examples=15, deadline=None)
@given(stores())
def test_a_plan_is_found_where_the_whole_task_has_one_and_holds_in_it(
    drawn: tuple[str, list[str]],
) -> None:
    problem, facts = drawn
    task = task_from_text(large(STORE), problem)
    assert task_from_text(STORE, problem).left_out == frozenset()
    for state in (task.init, frozenset(map(Atom.parse, facts))):
        found = FastDownward().plan(task, state)
        whole = FastDownward(search="optimal").plan(task, state)
        assert isinstance(whole, Plan | Unsolvable)
        assert isinstance(found, Plan) == isinstance(whole, Plan)
        if isinstance(found, Plan) and isinstance(whole, Plan):
            assert validate(task, found.actions, state).valid
            assert found.cost >= whole.cost
