"""Numbers that actions change: arithmetic, reading, and what a plan makes of them."""

import random
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.errors import PDDLError
from tpvqa.pddl import Atom, Literal, Task, load_task, task_from_text, validate
from tpvqa.pddl.arithmetic import (
    COMPARISONS,
    Expression,
    compared,
    compares,
    evaluated,
    nearest,
    number,
    parsed,
    text_of,
    values_in,
    written,
)
from tpvqa.pddl.numeric import steps_of, value_of, with_values
from tpvqa.planning.propositional import propositional

ROVER = Path(__file__).parents[2] / "examples/numbers/rover"
FUNCTIONS = [("load",), ("charge", "rover"), ("way", "hill", "lake")]
NUMBERS = st.fractions(min_value=-50, max_value=50, max_denominator=8)
LEAVES = st.one_of(NUMBERS.map(written), st.sampled_from(FUNCTIONS))
EXPRESSIONS = st.recursive(
    LEAVES, lambda inner: st.tuples(st.sampled_from("+-*/"), inner, inner), max_leaves=6
)
VALUES = st.fixed_dictionaries(dict.fromkeys(FUNCTIONS, NUMBERS))


@given(NUMBERS)
def test_a_number_is_read_as_it_was_written(value: Fraction) -> None:
    assert number(written(value)) == value


@given(EXPRESSIONS)
def test_an_expression_is_read_as_it_was_written(expression: Expression) -> None:
    assert parsed(text_of(expression)) == expression


@given(st.sampled_from(sorted(COMPARISONS)), EXPRESSIONS, EXPRESSIONS, VALUES)
def test_the_simplest_form_of_a_comparison_says_the_same(
    comparison: str,
    left: Expression,
    right: Expression,
    values: dict[tuple[str, ...], Fraction],
) -> None:
    sides = evaluated(left, values), evaluated(right, values)
    if None in sides:  # divided by nothing
        return
    found = compared(comparison, left, right)
    holds = COMPARISONS[comparison](*sides)  # type: ignore[arg-type]
    if isinstance(found, bool):
        assert found == holds
        return
    state = frozenset(value_of(words, value) for words, value in values.items())
    assert compares(*found, state) == holds
    assert Literal(Atom(*found)).holds(state) == holds
    assert Atom.parse(Atom(*found).pddl()) == Atom(*found)


@given(st.sampled_from([">=", "<=", ">", "<", "="]), NUMBERS, st.booleans(), NUMBERS)
def test_the_nearest_value_is_on_the_side_that_is_said(
    comparison: str, bound: Fraction, holds: bool, step: Fraction
) -> None:
    value = nearest(comparison, bound, holds=holds, step=abs(step) or Fraction(1))
    assert COMPARISONS[comparison](value, bound) == holds
    assert abs(value - bound) in (0, abs(step) or 1)


def rover() -> Task:
    return load_task(ROVER / "domain.pddl", ROVER / "problem.pddl")


def test_values_are_facts_of_the_state() -> None:
    task = rover()
    assert task.numeric is not None
    assert Atom("=", ("battery", "60")) in task.init
    assert steps_of(task, task.numeric) == {"battery": 10, "load": Fraction(1, 2)}
    drive = task.action("drive", ["base", "hill"])
    assert Literal(Atom(">=", ("battery", "20"))) in drive.precondition.parts  # type: ignore[union-attr]
    after = task.apply(task.init, drive)
    assert values_in(after) == {("battery",): 40, ("load",): 0}
    assert list(task.numeric.asked_after(drive, task.init, after)) == [
        Literal(Atom("<=", ("battery", "40")))
    ]
    assert task.with_init(after).init == after
    assert not task.applicable(with_values(task.init, {("battery",): Fraction(19)}), drive)


def test_a_denied_comparison_is_believed_by_the_nearest_value() -> None:
    task = rover()
    numeric = task.numeric
    assert numeric is not None
    steps = steps_of(task, numeric)
    denied = Literal(Atom(">=", ("battery", "20")), False)
    corrected = numeric.believing(numeric.init, denied, steps)
    assert values_in(corrected)["battery",] == 10
    assert numeric.believing(numeric.init, denied.negate(), steps) == numeric.init


@pytest.mark.parametrize("seed", range(12))
def test_numbers_go_as_in_another_simulator(seed: int) -> None:
    """Random walks of a random task, beside unified-planning's own reader and simulator."""
    io = pytest.importorskip("unified_planning.io")
    plans = pytest.importorskip("unified_planning.plans")
    shortcuts = pytest.importorskip("unified_planning.shortcuts")
    draw = random.Random(seed)
    domain, problem = _random_task(draw)
    task = task_from_text(domain, problem)
    assert task.numeric is not None
    within_reach = set(map(str, propositional(task, task.init).actions))
    theirs = io.PDDLReader().parse_problem_string(domain, problem)
    with shortcuts.SequentialSimulator(theirs) as simulator:
        there, here = simulator.get_initial_state(), task.init
        for _ in range(12):
            actions = [task.action(each.name, each.arguments) for each in task.ground_actions()]
            possible = []
            for action in actions:
                arguments = tuple(shortcuts.ObjectExp(theirs.object(o)) for o in action.arguments)
                instance = plans.ActionInstance(theirs.action(action.name), arguments)
                can = simulator.is_applicable(there, instance)
                assert can == task.applicable(here, action), (action, domain, problem)
                if can:
                    possible.append((action, instance))
            assert simulator.is_goal(there) == task.goal_holds(here)
            if not possible:
                break
            assert {str(action) for action, _ in possible} <= within_reach
            action, instance = draw.choice(possible)
            there, here = simulator.apply(there, instance), task.apply(here, action)
            for words, value in values_in(here).items():
                objects = [shortcuts.ObjectExp(theirs.object(o)) for o in words[1:]]
                fluent = theirs.fluent(words[0])(*objects)
                assert there.get_value(fluent).constant_value() == value


def _random_task(draw: random.Random) -> tuple[str, str]:
    """Two things whose numbers random actions change."""

    def expression(depth: int = 2) -> str:
        if not depth or draw.random() < 0.4:
            leaf = [str(draw.randint(0, 9)), "(total)", "(has ?x)", "(size ?x)", "0.5"]
            return draw.choice(leaf)
        return f"({draw.choice('+-*')} {expression(depth - 1)} {expression(depth - 1)})"

    def comparison() -> str:
        return f"({draw.choice(['>=', '<=', '>', '<'])} {expression()} {expression()})"

    def change() -> str:
        kind = draw.choice(["increase", "decrease", "assign"])
        return f"({kind} {draw.choice(['(total)', '(has ?x)'])} {expression(1)})"

    actions = []
    for number_ in range(4):
        needs = " ".join(comparison() for _ in range(draw.randint(0, 2)))
        parts = [change()]
        if draw.random() < 0.4:
            parts.append(f"(when (and (on ?x) {comparison()}) (not (on ?x)))")
        else:
            parts.append(draw.choice(["(on ?x)", "(not (on ?x))"]))
        if draw.random() < 0.5:
            needs += f" (not (and (on ?x) {comparison()} (not (= (has ?x) {draw.randint(0, 6)}))))"
        actions.append(
            f"(:action a{number_} :parameters (?x - thing) :precondition (and {needs}) "
            f":effect (and {' '.join(parts)}))"
        )
    domain = (
        "(define (domain d) (:requirements :adl :typing :numeric-fluents) (:types thing) "
        "(:predicates (on ?x - thing)) (:functions (total) (has ?x - thing) (size ?x - thing)) "
        f"{' '.join(actions)})"
    )
    values = {f"({name} {each})": draw.randint(0, 6) for name in ("has", "size") for each in "pq"}
    said = " ".join(f"(= {name} {value})" for name, value in {**values, "(total)": 3}.items())
    goal = "(and (on p) (>= (total) 9))"
    problem = (
        f"(define (problem r) (:domain d) (:objects p q - thing) (:init (on q) {said}) "
        f"(:goal {goal}))"
    )
    return domain, problem


DOMAIN = (ROVER / "domain.pddl").read_text()
PROBLEM = (ROVER / "problem.pddl").read_text()


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("(>= (battery) (way ?a ?b))", "(>= (batery) (way ?a ?b))", "Did you mean 'battery'"),
        ("(>= (battery) (way ?a ?b))", "(>= (battery) (way ?a))", "way takes 2 arguments, got 1"),
        (
            "(>= (battery) (way ?a ?b))",
            "(>= (battery) (way ?a ?c))",
            "there is no variable '?c'. Known: ?a, ?b, base, flint, hill, lake, mud.",
        ),
        ("(weight ?s - sample)", "(weight ?s - stone)", "the type 'stone' of '?s' is not declared"),
        ("(capacity)", "(capacity) (capacity)", "two functions of the name 'capacity'"),
        ("(assign (battery) 100)", "(assign 100 (battery))", "is no function whose value"),
        ("(:predicates", "(:derived (far) (> (way base lake) 3)) (:predicates", "(:derived …)"),
        ("(= (load) 0)", "", "(load) has no value at first, though collect"),
        ("(= (load) 0)", "(= (load) none)", "gives no number"),
        ("(= (load) 0)", "(= (load) 0) (= (load) 5)", "it has the value 0 already"),
        ("(:functions", "(:functions (+ ?s - sample)", "a function is called '+'"),
        ("(= (weight flint) 2)", "(= (weight stone) 2)", "there is no object 'stone'"),
        (
            "(= (weight flint) 2)",
            "(= (weight hill) 2)",
            "hill is of the type place, but ?s of weight",
        ),
        (
            "(decrease (battery) (way ?a ?b))",
            "(decrease (battery) (weight ?a))",
            "?a is of the type",
        ),
        ("(= (load) 0)", "(= (load) 1e1)", "gives no number; expected one as 2, -2 or 0.5"),
        ("(:goal", "(:metric shrink (battery)) (:goal", "(:metric minimize (total-cost))"),
        ("(decrease (battery) (way ?a ?b))", "(decrease (battery))", "is no change of a number"),
    ],
)
def test_what_cannot_be_read_is_told_with_its_line(old: str, new: str, says: str) -> None:
    assert old in DOMAIN + PROBLEM
    with pytest.raises(PDDLError) as caught:
        task_from_text(DOMAIN.replace(old, new, 1), PROBLEM.replace(old, new, 1))
    assert says in str(caught.value)


def test_a_function_without_arguments_may_stand_bare() -> None:
    domain, problem = (text.replace("(battery)", "battery") for text in (DOMAIN, PROBLEM))
    domain = domain.replace("(:functions\n    battery", "(:functions\n    (battery)")
    task = task_from_text(domain, problem)
    assert task.ground_actions() == rover().ground_actions()
    assert (task.init, task.goal) == (rover().init, rover().goal)


def test_an_action_whose_numbers_cannot_be_worked_out_cannot_be_done() -> None:
    """Where it is done all the same, as a skill may be, numbers stay as they are."""
    each = "(/ (way ?a ?b) (- (battery) 60))"
    text = DOMAIN.replace("(decrease (battery) (way ?a ?b))", f"(decrease (battery) {each})")
    task = task_from_text(text, PROBLEM)
    drive = task.action("drive", ["base", "hill"])
    assert not task.applicable(task.init, drive)
    assert values_in(task.apply(task.init, drive)) == values_in(task.init)
    assert str(validate(task, [drive])).endswith("needs a number that cannot be worked out")
    assert task.applicable(with_values(task.init, {("battery",): Fraction(61)}), drive)


def test_two_numbers_that_change_may_be_equal() -> None:
    equal, unequal = "(= (load) (battery))", "(not (= (load) (battery)))"
    task = task_from_text(DOMAIN, PROBLEM.replace("(>= (battery) 20)", equal))
    level = task.init | {Atom("stored", ("flint",)), Atom("stored", ("mud",))}
    level = with_values(level, {("load",): Fraction(3), ("battery",): Fraction(3)})
    assert task.goal_holds(level)
    assert not task.goal_holds(with_values(level, {("load",): Fraction(2)}))
    other = task_from_text(DOMAIN, PROBLEM.replace("(>= (battery) 20)", unequal))
    assert not other.goal_holds(level)


def test_a_sum_may_have_many_parts() -> None:
    many = f"(+ (load) {'(weight mud) ' * 2000})"
    task = task_from_text(DOMAIN, PROBLEM.replace("(>= (battery) 20)", f"(<= {many} 3000)"))
    assert str(task.goal).count("load") == 1


@pytest.mark.parametrize(
    "text", ["1e9", "1e999999999", "1_0", "+1", " 1", "nan", "\u0663", "1/0", ""]
)
def test_what_is_no_number(text: str) -> None:
    with pytest.raises(ValueError, match="is no number"):
        number(text)


def test_an_expression_that_is_nested_without_end_is_refused() -> None:
    with pytest.raises(ValueError, match="nested more than"):
        parsed("(" * 5000)


def test_a_value_is_read_as_values_are_written() -> None:
    assert Atom.parse("(= (battery) 60.0)") == Atom("=", ("battery", "60"))
    assert Atom.parse("(= (battery) .5)") == Atom("=", ("battery", "0.5"))


def test_a_predicate_may_be_called_as_what_is_known_of_numbers() -> None:
    domain = DOMAIN.replace("(aboard ?s", "(assign ?s").replace("lying", "number-0")
    problem = PROBLEM.replace("lying", "number-0")
    task = task_from_text(domain, problem)
    assert Atom("assign", ("flint",)) in task.reachable_atoms
    assert Atom("number-0", ("flint", "hill")) in task.init


def test_a_function_of_costs_alone_is_no_number() -> None:
    domain = (
        "(define (domain d) (:requirements :strips :fluents) (:predicates (p)) (:functions "
        "(total-cost) - number) (:action a :parameters () :precondition () :effect (and (p) "
        "(increase (total-cost) 3))))"
    )
    problem = (
        "(define (problem x) (:domain d) (:init (= (total-cost) 0)) (:goal (p)) "
        "(:metric minimize (total-cost)))"
    )
    task = task_from_text(domain, problem)
    assert task.numeric is None
    assert task.action("a").cost == 3


def test_a_type_may_be_written_onto_its_hyphen() -> None:
    task = task_from_text(DOMAIN.replace(" - ", " -"), PROBLEM.replace(" - ", " -"))
    assert task.numeric == rover().numeric
    assert task.ground_actions() == rover().ground_actions()


def test_a_metric_of_a_number_is_passed_over() -> None:
    metric = "(:metric minimize (+ (battery) (* 2 (total-time))))"
    task = task_from_text(DOMAIN, PROBLEM.replace("(:goal", f"{metric} (:goal"))
    assert task.metric is not None
    assert "(* 2 (total-time))" in task.metric
    assert rover().metric is None
