"""Bad input: file, line, what is wrong and what was expected."""

import os
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.pddl.feature_domains import SAMPLES
from tpvqa.errors import PDDLError, UnknownNameError
from tpvqa.pddl import load_task, task_from_text
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward

DOMAIN = """(define (domain lamps)
  (:requirements :typing :negative-preconditions)
  (:types lamp)
  (:predicates (lit ?l - lamp) (mended ?l - lamp))
  (:action switch_on
    :parameters (?l - lamp)
    :precondition (not (lit ?l))
    :effect (lit ?l)))
"""
PROBLEM = """(define (problem night)
  (:domain lamps)
  (:objects a b - lamp)
  (:init (lit a))
  (:goal (and (lit a)
              (lit b))))
"""

BROKEN_DOMAINS = [
    ("(lit ?l)))", "(lit ?l))", 1, r"a '\)' is missing.*\(define"),
    ("(lit ?l)))", "(lit ?l))))", 8, r"'\)' stands after the end.*too many"),
    ("(:action", "(:actoin", 5, "':actoin' is none of .*Did you mean ':action'"),
    (":parameters", ":parameter", 6, "':parameter' is none of .*Did you mean ':parameters'"),
    (":precondition", ":precond", 7, "':precond' is none of .*Did you mean ':precondition'"),
    (":effect", ":efect", 8, "':efect' is none of .*Did you mean ':effect'"),
    ("(:predicates", "(:predicate", 4, "':predicate' is none .*Did you mean ':predicates'"),
    ("(not (lit ?l))", "(not (lid ?l))", 7, "lid.*Did you mean 'lit'"),
    ("(not (lit ?l))", "(not (lit ?l ?l))", 7, "arity 1 used with 2 arguments"),
    ("(not (lit ?l))", "(not (lit ?k))", 7, "Undefined variable"),
    ("(not (lit ?l))", "(not)", 7, "'not' expects exactly one argument"),
    ("(?l - lamp)\n", "(?l - lamb)\n", 6, "type 'lamb'.*not declared.*Did you mean 'lamp'"),
    (":negative-preconditions", ":negative", 2, "requirement.*:negative-preconditions"),
    (":effect (lit ?l)", ":effects (lit ?l)", 8, "':effect'"),
    (":effect (lit ?l)", ":effect (increase (fuel) 1)", 8, "the function .fuel., which"),
    ("(:predicates", "(:predicatez", 4, ":predicates"),
    ("(lit ?l - lamp)", "(lit l - lamp)", 4, "variable.*'?'"),
    ("(define (domain lamps)", "(domain lamps)", 1, "define"),
    ("(:predicates", "(:functions (total-cost) - thing)\n  (:predicates", 4, "'thing'.*- number"),
    ("(not (lit ?l))", "(not (lit (?l)))", 7, r"cannot be read: '\(lit \(\?l\)\)' .*switch_on"),
    ("(not (lit ?l))", "(not ((lit) ?l))", 7, "predicate name.*switch_on"),
    ("(?l - lamp)\n", "((?l) - lamp)\n", 6, "cannot be read.*switch_on"),
    ("(?l - lamp)\n", "(?l - (either lamp tv))\n", 6, "either lamp tv.*declare a type above"),
    (
        ":effect (lit ?l)",
        ":effect (and (lit ?l)\n(= ?l ?l))",
        9,
        r"'\(= \?l \?l\)'.*leave",
    ),
    (":effect (lit ?l)", ":effect (not (= ?l ?l))", 8, "is an equality"),
    ("(:action", "(:derived (= ?a ?b - lamp) (lit ?a))\n(:action", 5, "derives an equality"),
    *(
        (":effect (lit ?l)", f":effect (and (lit ?l)\n(when (lit ?l)\n{effect}))", 10, outside)
        for outside in (r"write it outside.*\(forall \(\?k - lamp\) \(when \(lit \?l\) …\)\)",)
        for effect in (
            "(and (forall (?k - lamp) (lit ?k)))",
            "(forall (?k - lamp) (and (lit ?k) (mended ?k)))",
        )
    ),
    (
        ":precondition (not",
        ":precondition (and (not",
        7,
        r"missing in the action 'switch_on' .*':effect' of line 8 .* '\(and'",
    ),
    (
        "(lit ?l)))",
        "(lit ?l)\n  (:action b :parameters () :effect (and)))",
        5,
        r"missing in the action 'switch_on' .*'\(:action' of line 9",
    ),
    (
        "(lit ?l)))",
        "(lit ?l))))\n  (:action b :parameters () :effect (and)))",
        8,
        "too many before it, in the action 'switch_on'",
    ),
    ("(lit ?l)))", "(lit ?l)", 5, "missing.*in the action 'switch_on'"),
    ("lit ", "l" * 1_000_000 + " ", 4, "has 1,000,000 letters; expected 255"),
    ("(:predicates", "(:predicates (lit ?x)", 4, "two predicates of the name 'lit'"),
    ("(:predicates", "(:constants ?c - lamp)\n  (:predicates", 4, r"an object is called '\?c'"),
    ("(?l - lamp)\n", "(?l ?l - lamp)\n", 6, "two parameters of the action 'switch_on'"),
    ("(lit ?l)))", f"(and (lit ?l) (increase (total-cost) {'9' * 200}))))", 5, "larger unit"),
    *(
        (
            "(lit ?l)))",
            f"(and (lit ?l) (increase (total-cost) {cost}))))",
            8,
            f"cost of the action 'switch_on' is {said}",
        )
        for cost, said in (
            ("1e3", "'1e3', which is no whole number and no function"),
            ("(price)", "'price', which is no whole number and no function"),
            ("(total-cost)", "the total cost itself"),
        )
    ),
    (DOMAIN, PROBLEM, 1, "this file is a problem, where the domain is expected"),
    (DOMAIN, "\0\1\2ELF", 1, "outside a comment"),
    ("lit ?l))", "lit ?l) ü)", 7, "'ü'.*ASCII"),
    (
        "    :effect (lit ?l)))",
        "    :effect (lit ?l))\n  (:action switch_on :parameters () :effect (and)))",
        9,
        "two actions of the name 'switch_on'",
    ),
    (
        "(lit ?l - lamp)",
        "(lit ?l - lamp)\n    (lit)",
        5,
        "two predicates of the name 'lit'",
    ),
]
BROKEN_PROBLEMS = [
    ("(:init (lit a))", "(:goal (lit b)) (:init (lit a))", 4, "before .:init"),
    (PROBLEM, DOMAIN, 1, "this file is a domain, where the problem is expected"),
    ("(:init (lit a)", "(:init ((lit) a)", 4, "Undefined predicate"),
    ("(:init (lit a)", "(:init (lit (a))", 4, "cannot be read"),
    ("(:domain lamps)", "", 1, r"no \(:domain"),
    ("(:objects", "(:object", 3, "':object' is none of .*Did you mean ':objects'"),
    ("(:goal", "(:gaol", 1, r"no \(:goal"),
    ("(lit b))))", "(lit c))))", 6, "Undefined object.*'c'.*Known: a, b"),
    ("(:init (lit a))", "(:init (lit a b))", 4, "arity 1 used with 2 arguments"),
    ("(:init (lit a))", "(:init (lit lamp1))", 4, "Undefined object.*'lamp1'"),
    ("(:init (lit a))", "(:init (lit a) (not (lit a)))", 4, "true and false"),
    ("(:domain lamps)", "(:domain lamp)", 2, "lamp.*does not match"),
    ("a b - lamp", "a b - lump", 3, "type 'lump'.*not declared.*'lamp'"),
    ("a b - lamp", "a a b - lamp", 3, "'a' is declared twice"),
    ("a b - lamp", "a b\n ?x - lamp", 4, r"an object is called '\?x', as only variables are"),
    ("(:goal (and (lit a)\n              (lit b)))", "", 1, r"no \(:goal"),
    ("(lit b))))", "(lit b)))\n  (:metric maximize (total-cost)))", 7, "minimize"),
]


@pytest.mark.parametrize(("old", "new", "line", "message"), BROKEN_DOMAINS)
def test_a_broken_domain(
    tmp_path: Path, old: str, new: str, line: int | None, message: str
) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    assert old in DOMAIN
    domain.write_text(DOMAIN.replace(old, new))
    problem.write_text(PROBLEM)
    with pytest.raises(PDDLError, match=message) as caught:
        load_task(domain, problem)
    assert caught.value.file == domain
    assert caught.value.line == line
    assert str(caught.value).startswith(f"{domain}:{line}: ")
    assert len(str(caught.value)) < 1500


def test_a_cost_without_a_value_is_told_before_there_seems_to_be_no_plan(tmp_path: Path) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain.write_text(
        DOMAIN.replace("(:action", "(:functions (total-cost) (price)) (:action").replace(
            "(lit ?l)))", "(and (lit ?l) (increase (total-cost) (price)))))"
        )
    )
    counted = PROBLEM.replace("(lit b))))", "(lit b))) (:metric minimize (total-cost)))")
    problem.write_text(counted)
    with pytest.raises(PDDLError, match=r"'price' has no value.*give it one in \(:init"):
        load_task(domain, problem)
    problem.write_text(counted.replace("(:init", "(:init (= (total-cost) 0) (= (price) 2)"))
    assert {action.cost for action in load_task(domain, problem).ground_actions()} == {2}


def test_a_type_misspelt_where_it_is_declared_is_told_in_the_file_whose_line_is_named(
    tmp_path: Path,
) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain.write_text(DOMAIN.replace("(:types lamp)", "(:types lmap)"))
    problem.write_text(PROBLEM.replace("(:objects", "\n\n\n(:objects"))
    with pytest.raises(PDDLError, match="the type 'lamp' of 'a' is not declared") as caught:
        load_task(domain, problem)
    assert (caught.value.file, caught.value.line) == (problem, 6)


@pytest.mark.parametrize(("old", "new", "line", "message"), BROKEN_PROBLEMS)
def test_a_broken_problem(
    tmp_path: Path, old: str, new: str, line: int | None, message: str
) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    assert old in PROBLEM
    domain.write_text(DOMAIN)
    problem.write_text(PROBLEM.replace(old, new))
    with pytest.raises(PDDLError, match=message) as caught:
        load_task(domain, problem)
    assert caught.value.file == problem
    if line is not None:
        assert caught.value.line == line


@pytest.mark.parametrize(
    ("more", "message"),
    [
        (
            "(:action switch_on :parameters () :effect (lit a))",
            "Undefined object",
        ),
        (
            "(:action switch_on :parameters (?l - lamp) :effect (lit ?l))",
            "two actions of the name 'switch_on'",
        ),
        ("(:derived (lit ?l - lamp) (mended ?l))", "changes the derived predicate 'lit'"),
        ("(:derived (shining ?l - lamp) (lit ?l))", "'shining' is not declared"),
        (
            "(:derived (mended ?l - lamp) (not (mended ?l)))",
            "depends on its own negation",
        ),
    ],
)
def test_definitions_that_contradict_each_other(more: str, message: str) -> None:
    domain = DOMAIN.rstrip().removesuffix(")") + f"\n  {more})"
    with pytest.raises(PDDLError, match=message):
        task_from_text(domain, PROBLEM.replace("(lit b))))", "(mended b))))"))


TYPED_DOMAIN = """(define (domain yard)
  (:requirements :typing :adl)
  (:types car lorry - vehicle gate person)
  (:constants main - gate)
  (:predicates (at ?v - vehicle ?g - gate) (seen ?x) (busy ?x - (either car person)))
  (:action drive :parameters (?v - vehicle ?g - gate)
    :precondition (not (at ?v ?g)) :effect (and (at ?v ?g) (seen ?v) (seen ?g))))
"""
TYPED_PROBLEM = """(define (problem evening) (:domain yard)
  (:objects beetle - car tipper - lorry ann - person)
  (:init (at beetle main) (seen ann) (seen beetle) (busy ann) (busy beetle))
  (:goal (and (at tipper main)
              (forall (?v - vehicle) (or (seen ?v) (busy beetle) (= ?v tipper))))))
"""


def test_objects_of_subtypes_and_of_either_type_fit() -> None:
    """`vehicle` is no subtype of `object` here, and (seen ?x) takes it all the same."""
    task = task_from_text(TYPED_DOMAIN, TYPED_PROBLEM)
    task.check_state(task.init)
    assert isinstance(FastDownward().plan(task, task.init), Plan)


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        (
            "(at tipper main)",
            "(at main main)",
            4,
            r"in the goal: main is of the type gate, but \?v",
        ),
        ("(at beetle main)", "(at ann main)", 3, r"in the initial state: ann .* person.* vehicle"),
        ("(?v - vehicle) (or (seen ?v)", "(?v - gate) (or (at ?v main)", 5, "in the goal: .v"),
        (":effect (and (at ?v ?g)", ":effect (and (at ?g ?v)", 7, "in an effect of .*'drive'"),
        ("(not (at ?v ?g))", "(not (at ?g ?v))", 7, "the precondition of the action 'drive'"),
    ],
)
def test_arguments_that_no_object_could_fit(old: str, new: str, line: int, message: str) -> None:
    assert old in TYPED_DOMAIN + TYPED_PROBLEM
    with pytest.raises(PDDLError, match=message) as caught:
        task_from_text(TYPED_DOMAIN.replace(old, new), TYPED_PROBLEM.replace(old, new))
    assert caught.value.line == line


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("?v - vehicle ?g - gate)\n", "?v - object ?g - gate)\n"),  # wider than declared
        ("(busy ?x - (either car person))", "(busy ?x - (either vehicle person))"),
        ("(seen ?x)", "(seen ?x - (either vehicle gate person))"),
        ("tipper - lorry", "tipper - vehicle"),
    ],
)
def test_loose_types_are_read(old: str, new: str) -> None:
    """Published domains are loose, and Fast Downward takes them."""
    domain = TYPED_DOMAIN.replace(old, new)
    problem = TYPED_PROBLEM.replace(old, new)
    assert (domain, problem) != (TYPED_DOMAIN, TYPED_PROBLEM)
    task_from_text(domain, problem)


def test_what_the_domain_itself_makes_true_is_no_error_later() -> None:
    """An action may be declared wider than the predicate that it changes."""
    loose = TYPED_DOMAIN.replace("(?v - vehicle ?g - gate)\n", "(?v - object ?g - gate)\n")
    task = task_from_text(loose, TYPED_PROBLEM)
    state = task.apply(task.init, task.action("drive", ("main", "main")))
    task.check_state(state)


def test_a_derived_fact_in_the_initial_state() -> None:
    domain = DOMAIN.rstrip().removesuffix(")") + "(:derived (mended ?l - lamp) (lit ?l)))"
    with pytest.raises(PDDLError, match="derived fact 'mended'"):
        task_from_text(domain, PROBLEM.replace("(:init", "(:init (mended a)"))


def test_empty_and_missing_files(tmp_path: Path) -> None:
    there = tmp_path / "there.pddl"
    there.write_text("; nothing\n")
    with pytest.raises(PDDLError, match="the file is empty"):
        load_task(there, there)
    with pytest.raises(PDDLError, match="no such domain file"):
        load_task(tmp_path / "gone.pddl", there)
    with pytest.raises(PDDLError, match="no such problem file"):
        load_task(there, tmp_path / "gone.pddl")
    with pytest.raises(PDDLError, match="folder"):
        load_task(tmp_path, there)
    with pytest.raises(PDDLError, match="name its problem too"):
        load_task(there)


def test_files_without_an_end(tmp_path: Path) -> None:
    with pytest.raises(
        PDDLError, match="a link, a pipe or a device, where a plain file is expected"
    ):
        load_task(Path("/dev/zero"), tmp_path)


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    with (tmp_path / "domain.pddl").open("wb") as file:
        file.truncate((16 << 20) + 1)
    with pytest.raises(PDDLError, match="larger than 16 MB, as no domain file is"):
        load_task(tmp_path / "domain.pddl", tmp_path)


def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "domain.pddl")
    with pytest.raises(PDDLError, match="a pipe or a device"):
        load_task(tmp_path / "domain.pddl", tmp_path)


def test_an_unknown_task_is_told_the_nearest() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'eat_apple'"):
        load_task("eat_aple")


def test_blocks_nested_without_end() -> None:
    deep = "(and " * 5000 + "(lit a)" + ")" * 5000
    with pytest.raises(PDDLError, match="nested more than"):
        task_from_text(DOMAIN, PROBLEM.replace("(and (lit a)\n              (lit b))", deep))


def test_comments_may_hold_anything_and_a_byte_order_mark_is_skipped(tmp_path: Path) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    domain.write_bytes(b"\xef\xbb\xbf; k\xc3\xbcche\r\n" + DOMAIN.encode())
    problem.write_bytes(b"; \xfc latin\n" + PROBLEM.encode())
    assert load_task(domain, problem).name == "night"


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-be"])
def test_utf_16_is_called_that(tmp_path: Path, encoding: str) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    text = f"\ufeff{DOMAIN}" if encoding == "utf-16-be" else DOMAIN
    domain.write_bytes(text.encode(encoding))
    problem.write_text(PROBLEM)
    with pytest.raises(PDDLError, match=r"domain.pddl: .*not UTF-8 text; save the file as UTF-8"):
        load_task(domain, problem)


@pytest.mark.parametrize("mark", ["\x0b", "\x0c", "\x1c", "\x85", "\u2028", "\u2029"])
def test_a_comment_ends_at_the_end_of_its_line_only(tmp_path: Path, mark: str) -> None:
    domain, problem = tmp_path / "domain.pddl", tmp_path / "problem.pddl"
    comment = f"; lamps{mark}(and more\r\n;{mark})\r;{mark}(\n"
    domain.write_text(comment + DOMAIN, encoding="utf-8", newline="")
    problem.write_text(comment + PROBLEM, encoding="utf-8", newline="")
    assert load_task(domain, problem).name == "night"
    broken = PROBLEM.replace("(lit b)", "(lit c)")
    problem.write_text(comment + broken, encoding="utf-8", newline="")
    with pytest.raises(PDDLError) as caught:
        load_task(domain, problem)
    assert caught.value.line == 3 + 6


@st.composite
def damaged(draw: st.DrawFn) -> tuple[str, str]:
    """A task with some words of its text removed, doubled or swapped for others."""
    sample = draw(st.sampled_from(SAMPLES))
    texts = [sample.domain, sample.problem]
    which = draw(st.integers(0, 1))
    words = texts[which].replace("(", " ( ").replace(")", " ) ").split()
    for _ in range(draw(st.integers(1, 3))):
        at = draw(st.integers(0, len(words) - 1))
        other = draw(st.sampled_from([[], [words[at]] * 2, [draw(st.sampled_from(words))]]))
        words[at : at + 1] = other
    texts[which] = " ".join(words)
    return texts[0], texts[1]


@settings(max_examples=300, deadline=None)
@given(damaged())
def test_damaged_text_is_read_or_refused_with_a_reason(texts: tuple[str, str]) -> None:
    try:
        task_from_text(*texts)
    except PDDLError as error:
        assert len(str(error)) > 20  # noqa: PT017  either outcome is fine


@pytest.mark.parametrize(
    ("types", "told"),
    [
        ("lamp - lamp", "a 'lamp'"),
        ("lamp - thing thing - lamp", "a 'thing', which is a 'lamp'"),
    ],
)
def test_a_type_that_is_a_kind_of_itself_is_told(types: str, told: str) -> None:
    """The translator takes it in silence, and objects of it are then of no type or of all."""
    assert "(:types lamp)" in DOMAIN
    with pytest.raises(PDDLError, match=f"kind of itself: it is {told}"):
        task_from_text(DOMAIN.replace("(:types lamp)", f"(:types {types})"), PROBLEM)
