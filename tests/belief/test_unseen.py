"""Ways followed unseen: which is best, however the answers before have put the others in order."""

from itertools import pairwise

import pytest

from tests.belief.test_belief import plan_of
from tpvqa.belief.costs import Costs
from tpvqa.belief.deciding.annotated import AnnotatedPlan
from tpvqa.belief.deciding.choices import Chooser
from tpvqa.belief.filtering.belief import Belief
from tpvqa.belief.filtering.faults import FaultModel, Rates
from tpvqa.belief.learning.chances import Chances
from tpvqa.pddl import Action, Atom, Task, load_task, task_from_text
from tpvqa.planning.regression import regress
from tpvqa.tasks import find_task
from tpvqa.worlds.world_file import load_world_file


def unseen(task: Task, *, left: int | None = None) -> tuple[Chooser, Belief]:
    """A chooser whose answers say nothing, before the first action of a known plan."""
    rules = load_world_file(find_task(task.name).world, task)
    model, plan = FaultModel(task, rules), plan_of(task)
    chooser, belief = Chooser(model, Costs()), Belief(model)
    needs = regress(task, tuple(plan), task.init)
    chooser.ahead.add(AnnotatedPlan(task, tuple(plan), needs))
    chooser.settles, chooser.blind = 0.0, True
    chooser.ahead.allow(left)
    return chooser, belief


def followed(
    chooser: Chooser, belief: Belief, task: Task, redone: float = 0.0, most: int = 200
) -> list[Action]:
    """What is done until nothing more is worth it."""
    plan, rates, done = tuple(plan_of(task)), Rates(redone=redone), list[Action]()
    chooser.ahead.learned(Chances(rates).skill, rates)
    while len(done) < most:
        action = chooser.table(belief, rates, plan).best.action
        if action is None:
            break
        chooser.acted(belief, action)
        belief.act(action, Rates(0.25, 0.25, 0.0, redone))
        done.append(action)
    return done


def test_a_task_is_done_unseen_as_thoroughly_as_by_repeating_blindly() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    done = followed(chooser, belief, task)
    blind = Belief(belief.model)
    for action in plan_of(task):
        for _ in range(5):
            blind.act(action, Rates(0.25, 0.25, 0.0))
    assert belief.where(task.goal_holds) > blind.where(task.goal_holds) - 0.02
    assert len(done) < 100


@pytest.mark.parametrize(
    ("name", "redone", "more"),
    [
        ("serve_breakfast", 0.0, 0.1),
        ("eat_apple", 0.0, 0.07),
        ("clean_dishes", 0.06, 0.1),
        ("serve_breakfast", 0.06, 0.1),
        ("eat_apple", 0.06, 0.15),
    ],
)
def test_unseen_a_task_is_done_more_surely_than_by_any_number_of_repetitions(
    name: str, redone: float, more: float
) -> None:
    """What comes undone most easily is done last, or again, each step as often as it needs."""
    task, rates = load_task(name), Rates(0.25, 0.25, 0.0, redone)
    chooser, belief = unseen(task)
    followed(chooser, belief, task, redone)
    blindly = []
    for times in (1, 2, 3, 5, 8):
        blind = Belief(belief.model)
        for action in plan_of(task):
            for _ in range(times):
                blind.act(action, rates)
        blindly.append(blind.where(task.goal_holds))
    assert belief.where(task.goal_holds) > max(blindly) + more


@pytest.mark.parametrize("name", ["clean_dishes", "serve_breakfast", "eat_apple"])
def test_who_knows_that_doing_again_undoes_what_is_done_does_it_less(name: str) -> None:
    """The goal is reached more often so than by who takes it for free."""
    task, reached = load_task(name), {}
    for redone in (0.0, 0.2):
        chooser, belief = unseen(task)
        truly = Belief(belief.model)
        for action in followed(chooser, belief, task, redone):
            truly.act(action, Rates(0.25, 0.25, 0.0, 0.2))
        reached[redone] = truly.where(task.goal_holds)
    assert reached[0.2] > reached[0.0] + 0.1


def test_no_action_is_followed_where_none_is_left() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task, left=10)
    assert chooser.table(belief, Rates(), plan_of(task)).best.action is not None
    chooser.ahead.allow(0)
    assert chooser.table(belief, Rates(), plan_of(task)).best.action is None


def test_what_is_certain_ends_what_is_followed() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    assert chooser.table(belief, Rates(), plan_of(task)).best.action is not None
    state = task.init
    for action in plan_of(task):
        state = task.apply(state, action)
    belief.begin([(state, 1.0)])
    assert chooser.table(belief, Rates(), plan_of(task)).best.action is None


def test_what_is_followed_is_decided_anew_where_something_else_is_noticed() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    plan = tuple(plan_of(task))
    first = chooser.table(belief, Rates(), plan).best.action
    assert first is not None
    chooser.acted(belief, first)
    belief.act(first, Rates(0.25, 0.25, 0.0))
    left = chooser.following
    chooser.table(belief, Rates(), plan)
    assert chooser.following == left
    effect = next(e.literal.atom for e in first.effects if e.literal.positive)
    belief.see((effect,), 0.01, 0.99)  # as by a sensor
    chooser.table(belief, Rates(), plan)
    assert len(chooser.following) > len(left)  # all of it, from the start


def test_what_cannot_be_done_is_not_followed() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    plan = tuple(plan_of(task))
    assert chooser.table(belief, Rates(), plan).best.action is not None
    chooser.acted(belief, plan[0])
    belief.act(plan[0], Rates(1.0, 0.0, 0.0))  # and it has not worked
    left = chooser.following
    while chooser.following[0] == plan[0]:
        chooser.acted(belief, plan[0])
        belief.act(plan[0], Rates(1.0, 0.0, 0.0))
    second = chooser.following[0]
    assert second in left
    assert not task.applicable(task.init, second)
    assert chooser.table(belief, Rates(), plan).best.action != second


def test_what_cannot_be_done_is_left_out_and_the_rest_followed() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    plan = tuple(plan_of(task))
    assert chooser.table(belief, Rates(), plan).best.action is not None
    while chooser.following[0] == plan[0]:
        chooser.acted(belief, plan[0])
        belief.act(plan[0], Rates(1.0, 0.0, 0.0))
    left = chooser.following
    chooser.table(belief, Rates(), plan)
    assert left[0] == plan[1]
    assert chooser.following
    assert chooser.following == left[len(left) - len(chooser.following) :]


def test_what_is_followed_is_decided_anew_where_a_failed_task_costs_more() -> None:
    task = load_task("clean_dishes")
    chooser, belief = unseen(task)
    chooser.settles = 0.9
    plan = tuple(plan_of(task))
    first = chooser.table(belief, Rates(), plan).best.action
    assert first == plan[0]
    cheap = chooser.following
    chooser.acted(belief, first)
    belief.act(first, Rates(0.25, 0.25, 0.0))
    chooser.settles = 0.0
    chooser.table(belief, Rates(), plan)
    assert len(chooser.following) >= len(cheap)  # as thoroughly as what it is worth now


def test_a_long_way_is_handed_over_whole() -> None:
    """It was handed over a step at a time: each was a change of plan, and ten are allowed."""
    stones = [f"s{each}" for each in range(21)]
    task = task_from_text(
        """(define (domain d) (:requirements :typing) (:types stone)
        (:predicates (at ?s - stone) (next ?a ?b - stone))
        (:action step :parameters (?a ?b - stone) :precondition (and (at ?a) (next ?a ?b))
          :effect (and (not (at ?a)) (at ?b))))""",
        f"""(define (problem p) (:domain d) (:objects {" ".join(stones)} - stone)
        (:init (at s0) {" ".join(f"(next {a} {b})" for a, b in pairwise(stones))})
        (:goal (at s20)))""",
    )
    model = FaultModel(task)
    chooser, belief = Chooser(model, Costs()), Belief(model)
    plan = tuple(task.action("step", pair) for pair in pairwise(stones))
    chooser.ahead.add(AnnotatedPlan(task, plan, regress(task, plan, task.init)))
    chooser.settles, chooser.blind = 0.0, True
    left: tuple[Action, ...] = ()
    for done in range(20):
        action = chooser.table(belief, Rates(), plan).best.action
        assert action is not None
        assert action == chooser.following[0]
        if done == 0:
            assert tuple(dict.fromkeys(chooser.following)) == plan
        else:
            assert chooser.following == left[len(left) - len(chooser.following) :]
        chooser.acted(belief, action)
        belief.act(action, Rates())
        left = chooser.following


def test_a_thing_at_one_of_many_places_is_looked_for_at_each_of_them() -> None:
    """Nothing tells where it is; that a grasp at any one place will hardly do was reckoned with."""
    places = [f"p{each}" for each in range(12)]
    task = task_from_text(
        """(define (domain d) (:requirements :typing) (:types place)
        (:constants home - place) (:predicates (at ?p - place) (thing ?p - place) (holding) (done))
        (:action go :parameters (?a ?b - place) :precondition (at ?a)
          :effect (and (not (at ?a)) (at ?b)))
        (:action pick :parameters (?p - place) :precondition (and (at ?p) (thing ?p))
          :effect (and (not (thing ?p)) (holding)))
        (:action drop :parameters (?p - place) :precondition (and (at ?p) (holding))
          :effect (and (thing ?p) (not (holding))))
        (:action put :parameters () :precondition (and (at home) (holding))
          :effect (and (not (holding)) (done))))""",
        f"""(define (problem p) (:domain d) (:objects {" ".join(places)} - place)
        (:init (at home) (thing p0)) (:goal (done)))""",
    )
    model = FaultModel(task)
    chooser, belief = Chooser(model, Costs()), Belief(model)
    rest, states = task.init - {Atom("thing", ("p0",))}, []
    plan: tuple[Action, ...] = ()
    for place in places:
        state = rest | {Atom("thing", (place,))}
        words = (("go", "home", place), ("pick", place), ("go", place, "home"), ("put",))
        plan = tuple(task.action(name, arguments) for name, *arguments in words)
        chooser.ahead.add(AnnotatedPlan(task, plan, regress(task, plan, state)))
        states.append((state, 1 / len(places)))
    belief.begin(states)
    chooser.settles, chooser.blind = 0.0, True
    chooser.ahead.allow(None)
    for _ in range(150):
        action = chooser.table(belief, Rates(), plan).best.action
        if action is None:
            break
        chooser.acted(belief, action)
        belief.act(action, Rates(0.1, 0.0, 0.0))
    else:
        raise AssertionError("it goes round and round")
    assert belief.where(task.goal_holds) > 0.8
