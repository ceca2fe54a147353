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
from tpvqa.tasks import shipped_tasks

PER_SAMPLE = 3


def large(domain: str) -> str:
    """A domain that counts as large: an action of many arguments, which nothing makes possible."""
    of = " - object" if ":typing" in domain else ""
    names = [f"?v{number}" for number in range(14)]
    action = (
        f"(:action nothing :parameters ({' '.join(names)}{of}) :precondition (never) "
        "\n:effect (not (never)))"
    )
    predicates = "(:predicates (never)"
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
"""Things weigh on the robot, are held one at a time, open doors; some goals are out of reach."""


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


def test_of_shipped_tasks_nothing_is_left_out() -> None:
    for files in shipped_tasks():
        assert load_task(files.name).left_out == frozenset()


CLUTTER = """(define (domain clutter) (:requirements :adl :typing)
(:types place thing - object)
(:predicates (at ?x - thing ?p - place) (held ?x - thing) (free) (lid ?p - place) (big ?x - thing)
  (inside ?x ?y - thing) (clean ?x - thing) (sponge ?x - thing))
(:action take :parameters (?x - thing ?p - place)
  :precondition (and (free) (at ?x ?p) (not (lid ?p)))
  :effect (and (held ?x) (not (at ?x ?p)) (not (free))))
(:action put :parameters (?x - thing ?p - place)
  :precondition (and (held ?x) (not (lid ?p))
    (forall (?y - thing) (or (not (big ?y)) (not (at ?y ?p)))))
  :effect (and (at ?x ?p) (free) (not (held ?x))))
(:action lift :parameters (?p - place) :precondition (lid ?p) :effect (not (lid ?p)))
(:action wipe :parameters (?x ?s - thing) :precondition (and (held ?s) (sponge ?s))
  :effect (clean ?x)))"""


def clutter(things: int, *, goal: str, more: str = "") -> str:
    """A problem with so many things on shelves that do not matter for its goal."""
    shelves = [f"shelf{number}" for number in range(things // 5)]
    names = [f"thing{number}" for number in range(things)]
    lying = " ".join(f"(at {name} {shelves[n % len(shelves)]})" for n, name in enumerate(names))
    return (
        f"(define (problem some) (:domain clutter) (:objects {' '.join(shelves)} box desk - place "
        f"{' '.join(names)} cup - thing) (:init (free) (lid box) (at cup desk) {lying} {more}) "
        f"(:goal {goal}))"
    )


def planned(task: Task, *state: frozenset[Atom]) -> list[str]:
    """The plan from a state, seen to hold in the whole task."""
    result = FastDownward().plan(task, *state)
    assert isinstance(result, Plan), result
    assert validate(task, result.actions, *state).valid
    return list(map(str, result.actions))


def test_what_does_not_matter_is_left_out_and_the_plan_is_that_without_it() -> None:
    goal = "(and (at cup box) (clean cup))"
    big = task_from_text(
        large(CLUTTER), clutter(150, goal=goal, more="(sponge thing7) (big thing9)")
    )
    assert len(big.left_out) > 170
    assert {"cup", "box", "desk", "thing7", "shelf7"}.isdisjoint(big.left_out)
    assert len(planned(big)) == 6
    # What is left out can still be spoken of.
    assert big.action("take", ["thing11", "shelf11"]).pddl() == "(take thing11 shelf11)"
    big.check_atom(Atom("at", ("cup", "shelf11")))


def test_what_was_left_out_matters_once_the_state_says_so() -> None:
    task = task_from_text(large(CLUTTER), clutter(150, goal="(at cup box)"))
    assert {"shelf3", "thing3"} <= task.left_out
    assert sorted(planned(task)) == ["lift(box)", "put(cup, box)", "take(cup, desk)"]
    moved = (task.init - {Atom("at", ("cup", "desk"))}) | {Atom("at", ("cup", "shelf3"))}
    assert "take(cup, shelf3)" in planned(task, moved)
    full = moved - {Atom("free"), Atom("at", ("thing3", "shelf3"))} | {Atom("held", ("thing3",))}
    steps = planned(task, full)
    assert any(step.startswith("put(thing3") for step in steps)
    again = task.with_init(full)
    assert "thing3" not in again.left_out
    assert Atom("at", ("thing3", "desk")) in again.atoms()


def test_groups_speak_of_places_that_were_left_out() -> None:
    task = task_from_text(large(CLUTTER), clutter(150, goal="(at cup box)"))
    (group,) = [g for g in task.groups_of(Atom("at", ("cup", "desk"))) if g.exactly_one]
    assert Atom("at", ("cup", "shelf3")) in group.atoms
    assert Atom("held", ("cup",)) in group.atoms


def test_a_plan_that_a_thing_left_out_forbids_is_not_taken() -> None:
    # Whatever is big and on a shelf keeps the cup away from there, though the goal is not about it.
    goal = "(exists (?p - place) (and (at cup ?p) (not (= ?p desk)) (not (= ?p box))))"
    on_all = " ".join(f"(big thing{number})" for number in range(29))
    task = task_from_text(large(CLUTTER), clutter(150, goal=goal, more=on_all))
    assert planned(task)[-1].startswith("put(cup, shelf")


def test_that_there_is_no_plan_is_said_of_the_whole_task() -> None:
    domain = large(CLUTTER).replace("(sponge ?s)", "(sponge ?s) (big ?s)")
    task = task_from_text(domain, clutter(60, goal="(clean cup)", more="(sponge thing7)"))
    assert isinstance(FastDownward().plan(task), Unsolvable)
    solvable = task_from_text(
        domain, clutter(60, goal="(clean cup)", more="(sponge thing7) (big thing7)")
    )
    assert planned(solvable) == ["take(thing7, shelf7)", "wipe(cup, thing7)"]


def test_optimal_plans_are_those_of_the_whole_task() -> None:
    (sample,) = [each for each in SAMPLES if each.name == "action costs"]
    task = read(sample.domain, sample.problem, 2)
    assert task.left_out
    result = FastDownward(search="optimal").plan(task)
    assert isinstance(result, Plan)
    assert result.cost == sample.cost
