"""Durative actions, taken apart: what is read, what comes of it, and what is refused where."""

import re
from dataclasses import replace

import pytest

from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Task, load_task, task_from_text
from tpvqa.pddl.lasting import Phase
from tpvqa.planning import Crashed, Unfit
from tpvqa.planning.making import make_planner

DOMAIN = """(define (domain pots)
 (:requirements :typing :durative-actions)
 (:types pot place)
 (:predicates (raw ?p - pot) (fired ?p - pot) (shut) (busy) (warm ?p - pot) (at ?p - pot))
 (:functions (time ?p - pot))
 (:durative-action fire :parameters (?p - pot)
  :duration (= ?duration (* 2 (time ?p)))
  :condition (and (at start (raw ?p)) (over all (shut)) (at end (at ?p)))
  :effect (and (at start (busy)) (at start (not (at ?p))) (at end (not (busy)))
   (at end (fired ?p)) (forall (?q - pot) (when (at end (raw ?q)) (at end (warm ?q))))))
 (:action close :parameters () :precondition (and) :effect (shut)))
"""
PROBLEM = """(define (problem one) (:domain pots) (:objects vase jug - pot bench - place)
 (:init (raw vase) (raw jug) (at vase) (at jug) (= (time vase) 3) (= (time jug) 2.5))
 (:goal (fired vase)))
"""


def said(task: Task, name: str) -> tuple[set[str], set[str]]:
    action = task.action(name, ["vase"])
    needs = getattr(action.precondition, "parts", (action.precondition,))
    return {str(each) for each in needs}, {str(each.literal) for each in action.effects}


def test_each_condition_and_effect_goes_where_its_time_says() -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    running = "running-fire(vase)"
    warm = {"warm(vase)", "warm(jug)"}
    assert said(task, "start-fire") == (
        {f"not {running}", "raw(vase)"},
        {running, "busy()", "not at(vase)"},
    )
    assert said(task, "while-fire") == ({running, "shut()"}, {running})
    assert said(task, "end-fire") == (
        {running, "shut()", "at(vase)"},
        {f"not {running}", "not busy()", "fired(vase)", *warm},
    )
    assert said(task, "cancel-fire") == ({running}, {f"not {running}", "not busy()", "at(vase)"})


def test_how_long_an_action_lasts() -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    assert task.lasting is not None
    assert task.lasting.duration(task.action("start-fire", ["vase"])) == (6, 6)
    assert task.lasting.duration(task.action("end-fire", ["jug"])) == (5, 5)
    text = DOMAIN.replace(
        "(= ?duration (* 2 (time ?p)))", "(and (>= ?duration 2) (<= ?duration (time ?p)))"
    )
    lasting = task_from_text(text, PROBLEM).lasting
    assert lasting is not None
    assert lasting.duration(task.action("start-fire", ["vase"])) == (2, 3)


def test_begun_and_cancelled_it_is_as_it_was() -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    assert task.lasting is not None
    start = task.action("start-fire", ["vase"])
    begun = task.apply(task.init, start)
    assert task.lasting.under_way(task, begun) == (start,)
    assert task.apply(begun, task.lasting.part(task, start, Phase.CANCEL)) == task.init


YARD = """(define (domain yard) (:requirements :strips :typing :durative-actions)
 (:types crane crate spot)
 (:predicates (idle ?c - crane) (on ?x - crate ?s - spot) (lifted ?x - crate ?c - crane)
  (empty ?s - spot))
 (:durative-action carry :parameters (?c - crane ?x - crate ?from ?to - spot)
  :duration (= ?duration 4)
  :condition (and (at start (idle ?c)) (at start (on ?x ?from)) (at start (empty ?to))
   (over all (lifted ?x ?c)))
  :effect (and (at start (not (idle ?c))) (at start (not (on ?x ?from)))
   (at start (not (empty ?to))) (at start (lifted ?x ?c))
   (at end (idle ?c)) (at end (on ?x ?to)) (at end (not (lifted ?x ?c))) (at end (empty ?from)))))
"""
CRATES = """(define (problem two) (:domain yard) (:objects c - crane a - crate s t u - spot)
 (:init (idle c) (on a s) (empty t) (empty u)) (:goal (on a t)))
"""


@pytest.mark.parametrize(
    ("fallen", "lies"), [(None, "s"), ("s", "s"), ("u", "u")], ids=["held", "back", "elsewhere"]
)
def test_what_is_cancelled_frees_what_it_took(fallen: str | None, lies: str) -> None:
    task = task_from_text(YARD, CRATES)
    assert task.lasting is not None
    start = task.action("start-carry", ["c", "a", "s", "t"])
    begun = task.apply(task.init, start)
    if fallen is not None:
        begun = begun - {Atom("lifted", ("a", "c"))} | {Atom("on", ("a", fallen))}
    after = task.apply(begun, task.lasting.part(task, start, Phase.CANCEL))
    free = {Atom("idle", ("c",)), Atom("empty", ("t",)), Atom("empty", ("u",))}
    assert after == free | {Atom("on", ("a", lies))}


def test_what_is_needed_at_a_start_alone_makes_groups_too() -> None:
    """The translator's invariants are not told that what an end deletes held at the start."""
    text = YARD.replace("(idle ?c - crane)", "(idle ?c - crane) (wet ?s - spot) (dry ?s - spot)")
    text = (
        text[: text.rindex(")")]
        + """ (:durative-action rain :parameters (?s - spot)
     :duration (= ?duration 1) :condition (at start (dry ?s))
     :effect (and (at end (wet ?s)) (at end (not (dry ?s))))))"""
    )
    task = task_from_text(text, CRATES.replace("(on a s)", "(on a s) (dry s)"))
    (group,) = task.groups_of(Atom("dry", ("s",)))
    assert group.atoms == {Atom("dry", ("s",)), Atom("wet", ("s",))}
    assert group.exactly_one


def test_a_domain_in_which_nothing_lasts_has_nothing_of_it() -> None:
    task = load_task("clean_dishes")
    assert task.lasting is None
    assert not any("running" in name for name in task.predicates)


@pytest.mark.parametrize(
    ("old", "new", "line", "says"),
    [
        ("(at start (raw ?p))", "(raw ?p)", 8, "has no time; expected (at start …)"),
        (":condition", ":precondition", 8, "it is called :condition here"),
        (":duration (= ?duration (* 2 (time ?p)))", "", 6, "does not say how long it lasts"),
        ("(= ?duration (* 2 (time ?p)))", "(<= ?duration 3)", 7, "at least"),
        ("(* 2 (time ?p))", "(hours ?p)", 7, "'hours', which (:functions …) does not declare"),
        ("(at end (fired ?p))", "(over all (fired ?p))", 10, "an effect over all"),
        ("(at end (fired ?p))", "(increase (time ?p) (* #t 2))", 10, "#t"),
        ("(at end (fired ?p))", "(at end (increase (time ?p) 2))", 10, "is about numbers"),
        ("(when (at end (raw ?q))", "(when (at start (raw ?q))", 10, "at another time"),
        (":action close", ":action end-fire", 6, "rename one of them"),
        (
            "(:action close",
            "(:durative-action fire :duration)\n (:action close",
            11,
            "two durative",
        ),
        ("(* 2 (time ?p))", "1e999", 7, "'(1e999)' is no number"),
        ("(busy) (warm", "(running-fire ?p - pot) (warm", 6, "rename one of them"),
    ],
)
def test_what_is_not_known_is_told_where_it_stands(
    old: str, new: str, line: int, says: str
) -> None:
    assert old in DOMAIN
    with pytest.raises(PDDLError) as caught:
        task_from_text(DOMAIN.replace(old, new, 1), PROBLEM)
    assert says in str(caught.value)
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("(raw vase)", "(raw vase) (at 5 (shut))", "timed initial literal"),
        ("(= (time vase) 3)", "(= (time vase) soon)", "gives no number"),
        ("(= (time vase) 3)", "(= (time vase) 3e1)", "gives no number"),
        ("(= (time vase) 3)", "(= (time vase jug) 3)", "time takes 1 arguments, got 2"),
        ("(= (time vase) 3)", "(= (tiem vase) 3)", "Did you mean 'time'"),
        ("(= (time vase) 3)", "(= (time bench) 3)", "bench is of the type place, but ?p of time"),
        ("(= (time vase) 3)", "(= (time vase) 3) (= (time vase) 4)", "it has the value 3 already"),
        (" (:goal", " (:metric shrink (+ (total-time) 1))\n (:goal", "is not known; expected"),
    ],
)
def test_what_is_not_known_of_a_problem(old: str, new: str, says: str) -> None:
    with pytest.raises(PDDLError, match=re.escape(says)) as caught:
        task_from_text(DOMAIN, PROBLEM.replace(old, new, 1))
    assert caught.value.line == (3 if "metric" in new else 2)


@pytest.mark.parametrize("given", ["", "(= (time vase) 0)"])
def test_a_duration_has_to_be_one(given: str) -> None:
    pytest.importorskip("up_aries")
    task = task_from_text(DOMAIN, PROBLEM.replace("(= (time vase) 3)", given))
    result = make_planner("up:aries").plan(task)
    assert isinstance(result, Crashed)
    assert "fire(vase)" in result.reason


@pytest.mark.parametrize(("said", "lasts"), [("0.5", 1), (".5", 1), ("3.", 6), ("-2", None)])
def test_numbers_are_read_as_they_are_written(said: str, lasts: float | None) -> None:
    task = task_from_text(DOMAIN, PROBLEM.replace("(= (time vase) 3)", f"(= (time vase) {said})"))
    assert task.lasting is not None
    action = task.action("start-fire", ["vase"])
    if lasts is None:
        with pytest.raises(PDDLError, match="lasts -4 to -4"):
            task.lasting.duration(action)
    else:
        assert task.lasting.duration(action) == (lasts, lasts)


@pytest.mark.parametrize("planner", ["fast-downward", "clingo"])
def test_planners_that_know_no_time_say_so(planner: str) -> None:
    if planner == "clingo":
        pytest.importorskip("clingo")
    result = make_planner(planner).plan(task_from_text(DOMAIN, PROBLEM))
    assert isinstance(result, Unfit)
    assert "take up:tamer (" in result.reason
    assert "or up:aries (" in result.reason


def test_a_task_from_another_state_still_knows_what_lasts() -> None:
    task = task_from_text(DOMAIN, PROBLEM)
    again = task.with_init(task.init | {Atom("shut")})
    assert again.lasting == task.lasting
    assert replace(task).lasting is not None
