"""The household task, and what actions, states and groups mean."""

import pickle

import pytest

from tests.pddl.feature_domains import (
    ADD_AFTER_DELETE,
    CASE,
    CONDITIONAL,
    COSTS,
    DERIVED,
    EITHER,
    QUANTIFIERS,
    SAMPLES,
    Sample,
)
from tpvqa.errors import PDDLError
from tpvqa.pddl import (
    Action,
    Atom,
    Conjunction,
    Disjunction,
    Effect,
    Literal,
    State,
    Task,
    load_task,
    task_from_text,
    validate,
)


def facts(*texts: str) -> State:
    return frozenset(map(Atom.parse, texts))


def read(sample: Sample) -> Task:
    return task_from_text(sample.domain, sample.problem)


@pytest.fixture(scope="module")
def household() -> Task:
    return load_task("eat_apple")


def test_names_objects_and_predicates(household: Task) -> None:
    assert (household.name, household.domain_name) == ("eat_apple", "household")
    assert household.objects["apple"] == "fruit"
    assert household.types["fruit"] == "food"
    assert household.types["object"] is None
    assert household.predicates["in_hand"] == ("thing", "hand")
    assert {"plate", "table", "sink"} <= set(household.objects_by_type["surface"])
    assert "fridge" not in household.objects_by_type["surface"]
    assert Atom.parse("(on apple fridge)") in household.init
    assert household.goal == Literal(Atom("halved", ("apple",)))
    assert household.domain_path is not None
    assert household.domain_path.name == "domain.pddl"


def test_an_action_is_what_its_author_wrote(household: Task) -> None:
    find = household.action("find", ("apple", "tv"))
    assert find.precondition == Conjunction(
        (
            Literal(Atom("near", ("tv",))),
            Disjunction(
                (
                    Literal(Atom("opened", ("fridge",))),
                    Literal(Atom("on", ("apple", "fridge")), positive=False),
                )
            ),
        )
    )
    assert [str(effect.literal) for effect in find.effects] == ["near(apple)", "not near(tv)"]
    assert find.pddl() == "(find apple tv)"
    assert household.action("FIND", ["Apple", "TV"]) is find


def test_equality_is_decided(household: Task) -> None:
    nowhere = household.action("find", ("tv", "tv"))
    assert nowhere.precondition == Disjunction()
    assert not household.applicable(household.init, nowhere)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("fnd", "apple", "tv"), "no action 'fnd'. Did you mean 'find'"),
        (("find", "apple"), r"find takes 2 arguments \(\?x - thing, \?from - thing\), got 1"),
        (("find", "aple", "tv"), "no object 'aple'. Did you mean 'apple'"),
        (("find", "left", "tv"), "left is a hand, but .x of the action find must be a thing"),
    ],
)
def test_actions_that_are_none(household: Task, words: tuple[str, ...], message: str) -> None:
    with pytest.raises(PDDLError, match=message):
        household.action(words[0], words[1:])


@pytest.mark.parametrize("name", ["clean_dishes", "serve_breakfast", "eat_apple"])
def test_household_groups_are_what_the_domain_means(name: str) -> None:
    task = load_task(name)
    things = [thing for thing in task.objects if thing not in ("left", "right")]
    expected = {frozenset(Atom("near", (thing,)) for thing in things)}
    for hand in ("left", "right"):
        held = {Atom("in_hand", (thing, hand)) for thing in things}
        expected.add(frozenset(held | {Atom("free", (hand,))}))
    for item in ("plate", "bread", "apple", "knife"):
        somewhere = {Atom("on", (item, thing)) for thing in things}
        somewhere |= {Atom("in_hand", (item, hand)) for hand in ("left", "right")}
        expected.add(frozenset(somewhere))
    assert {group.atoms for group in task.mutex_groups} == expected
    assert all(group.exactly_one for group in task.mutex_groups)
    floor = Atom.parse("on apple floor")  # nothing in the domain puts it there; a mishap does
    (group,) = task.groups_of(floor)
    assert Atom.parse("in_hand apple left") in group.atoms
    assert task.groups_of(Atom.parse("opened fridge")) == ()


def test_groups_hold_only_atoms_of_fitting_types() -> None:
    """A truck is somewhere, as a parcel is, but in no truck."""
    task = read(EITHER)
    for group in task.mutex_groups:
        task.check_state(group.atoms)
    (van,) = task.groups_of(Atom.parse("at van home"))
    assert van.atoms == facts("at van home", "at van shop")


def test_groups_follow_the_initial_state(household: Task) -> None:
    nowhere = household.with_init(household.init - facts("on apple fridge"))
    group = {g.atoms for g in household.groups_of(Atom.parse("on apple fridge"))}
    assert group.isdisjoint(g.atoms for g in nowhere.mutex_groups)
    both = household.with_init(household.init | facts("on apple table"))
    assert both.groups_of(Atom.parse("on apple table")) == ()
    assert household.with_init(household.init) == household
    assert nowhere != household


def test_a_group_that_can_become_empty_is_not_exactly_one() -> None:
    groups = read(
        Sample(
            "",
            """(define (domain oven) (:requirements :strips)
            (:predicates (raw ?x) (done ?x) (eaten ?x))
            (:action bake :parameters (?x) :precondition (raw ?x)
              :effect (and (done ?x) (not (raw ?x))))
            (:action throw :parameters (?x) :precondition (raw ?x) :effect (not (raw ?x))))""",
            """(define (problem pie) (:domain oven) (:objects a) (:init (raw a))
            (:goal (done a)))""",
            1,
        )
    ).mutex_groups
    assert [(set(map(str, g.atoms)), g.exactly_one) for g in groups] == [
        ({"raw(a)", "done(a)"}, False)
    ]


@pytest.mark.parametrize("sample", SAMPLES, ids=lambda sample: sample.name)
def test_groups_hold_along_every_walk(sample: Sample) -> None:
    from random import Random

    task = read(sample)
    random = Random(0)
    for _ in range(10):
        state = task.init
        for _ in range(15):
            for group in task.mutex_groups:
                count = len(group.atoms & state)
                assert count == 1 if group.exactly_one else count <= 1
            possible = [a for a in task.ground_actions() if task.applicable(state, a)]
            if not possible:
                break
            state = task.apply(state, random.choice(possible))
            assert {atom for atom in state if atom.predicate in task.fluents} <= task.atoms()


def test_either_and_supertypes() -> None:
    task = read(EITHER)
    assert task.predicates["at"] == ("truck|parcel", "place")
    assert set(task.objects_by_type["object"]) == {"van", "box", "crate", "home", "shop"}


def test_conditional_effects_see_the_state_before() -> None:
    task = read(CONDITIONAL)
    state = facts("here home", "at pen home", "inside pen", "rainy garden", "at pad garden")
    after = task.apply(state, task.action("move", ("home", "garden")))
    assert after == facts(
        "here garden", "at pen garden", "inside pen", "wet pen", "rainy garden", "at pad garden"
    )


def test_what_is_added_and_deleted_at_once_holds() -> None:
    task = read(ADD_AFTER_DELETE)
    state = task.init | facts("used n")
    assert task.apply(state, task.action("flip", ["n"])) == state
    assert task.apply(state, task.action("move", ["n", "n"])) == state


def test_derived_atoms() -> None:
    task = read(DERIVED)
    full = task.extend(task.init)
    assert full - task.init == facts("above a b", "above b c", "above a c", "clear a")
    assert task.applicable(task.init, task.action("unstack", "ab"))
    assert not task.applicable(task.init, task.action("unstack", "bc"))
    assert task.derived == {"above", "clear", "tidy"}


def test_quantifiers_range_over_types() -> None:
    check = read(QUANTIFIERS).action("check", ["s1"])
    assert str(check.precondition).count("on") >= 2
    assert isinstance(check.precondition, Conjunction)
    assert len(check.precondition.parts) == 2  # one for each box


def test_costs_come_from_functions() -> None:
    task = read(COSTS)
    assert task.action("go", "pq").cost == 3
    assert task.action("jump", "pr").cost == 9
    assert task.action("rest", "p").cost == 0
    with pytest.raises(PDDLError, match=r"cost of go\(p, r\) is \(distance p r\).*no value"):
        task.action("go", "pr")


def test_case_does_not_matter() -> None:
    task = read(CASE)
    assert task.init == facts("at hall", "linked hall attic")
    assert task.action("Go", ["HALL", "attic"]).name == "go"


def test_ground_actions_are_the_reachable_ones(household: Task) -> None:
    actions = {action.pddl() for action in household.ground_actions()}
    assert "(pick_up apple fridge left)" in actions
    assert "(pick_up fridge apple left)" not in actions
    assert "(find tv tv)" not in actions


def test_tasks_can_be_pickled_and_compared(household: Task) -> None:
    household.action("open", ["fridge"])
    copy = pickle.loads(pickle.dumps(household))
    assert copy == household
    assert hash(copy) == hash(household)
    assert copy.ground_actions() == household.ground_actions()
    assert copy.mutex_groups == household.mutex_groups


def test_atoms_of_another_task_are_refused(household: Task) -> None:
    for text, message in [
        ("on apple flor", "Did you mean 'floor'"),
        ("onn apple floor", "Did you mean 'on'"),
        ("on apple", "takes 2 arguments"),
    ]:
        with pytest.raises(PDDLError, match=message):
            household.check_atom(Atom.parse(text))


def test_validation_says_where_a_plan_fails(household: Task) -> None:
    steps = [household.action("find", ("fridge", "tv")), household.action("find", ("apple", "tv"))]
    result = validate(household, steps)
    assert not result.valid
    assert result.failed_step == 1
    assert "near(tv)" in map(str, result.failed)
    assert str(result).startswith("step 2, find(apple, tv), needs near(tv)")
    unfinished = validate(household, steps[:1])
    assert unfinished.failed_step == 1
    assert str(unfinished) == "the goal does not hold at the end: halved(apple)"
    never = validate(household, [household.action("find", ("tv", "tv"))])
    assert str(never).endswith("a condition that can never hold")


def test_core_types_are_plain() -> None:
    action = Action("go", ("a",), Conjunction(), (Effect(Conjunction(), Literal(Atom("at"))),))
    assert str(action) == "go(a)"
    assert action == pickle.loads(pickle.dumps(action))
