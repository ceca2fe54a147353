"""Domains that ask for what Fast Downward does not know."""

import pytest

from tpvqa.errors import PDDLError
from tpvqa.pddl import task_from_text
from tpvqa.pddl.outside import engines

PROBLEM = "(define (problem x) (:domain d) (:init) (:goal (p)))"


def domain(
    requirement: str, *, needs: str = "()", effect: str = "(p)", word: str = ":action"
) -> str:
    return (
        f"(define (domain d)\n (:requirements :strips\n   {requirement})\n (:predicates (p) (q))\n"
        f" (:functions (battery))\n ({word} a :parameters ()\n :precondition {needs}\n"
        f" :effect {effect}))"
    )


@pytest.mark.parametrize(
    ("text", "line", "says"),
    [
        (domain(":timed-initial-literals"), 3, "tamer"),
        (domain(":preferences"), 3, "None of unified-planning's engines is known to"),
        (domain(":probabilistic-effects"), 3, "effects by chance"),
        (domain(":non-deterministic"), 3, "effects by chance"),
        (domain(":hierarchy"), 3, "tpvqa's loop reads no task networks"),
        (domain(":typign"), 3, "Did you mean ':typing'"),
        (domain("", word=":process"), 6, "processes and events"),
        (domain("", effect="(probabilistic 0.5 (p))"), 8, "effects by chance"),
    ],
)
def test_which_requirement_and_who_knows_it(text: str, line: int, says: str) -> None:
    with pytest.raises(PDDLError) as caught:
        task_from_text(text, PROBLEM)
    assert says in str(caught.value)
    assert caught.value.line == line


def test_a_requirement_that_is_like_none_suggests_none() -> None:
    with pytest.raises(PDDLError) as caught:
        task_from_text(domain(":teleportation"), PROBLEM)
    assert "Did you mean" not in str(caught.value)
    assert ":durative-actions" in str(caught.value)
    assert ":numeric-fluents" in str(caught.value)


@pytest.mark.parametrize(
    ("text", "problem", "says"),
    [
        (domain("").replace("(battery)", "(place) - object"), PROBLEM, ":object-fluents"),
        (domain(""), PROBLEM.replace("(:init)", "(:init (at 5 (p)))"), ":timed-initial-literals"),
        (domain(""), PROBLEM.replace("(p)))", "(preference x (p))))"), ":preferences"),
        (domain(""), PROBLEM[:-1] + "(:constraints (always (p))))", ":constraints"),
    ],
)
def test_what_needs_a_requirement_names_it(text: str, problem: str, says: str) -> None:
    with pytest.raises(PDDLError, match="needs the requirement") as caught:
        task_from_text(text, problem)
    assert f"needs the requirement {says}" in str(caught.value)
    assert "nified-planning" in str(caught.value)


def test_a_metric_of_a_fact_is_refused() -> None:
    problem = PROBLEM[:-1] + "(:metric maximize (p)))"
    with pytest.raises(PDDLError, match="is no number; expected a function"):
        task_from_text(domain(""), problem)


def test_an_engine_that_is_not_there_names_its_package(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engines, "is_there", lambda engine: engine == "aries")
    said = engines.where_known("time")
    assert "aries (installed)" in said
    assert "tamer (pip install up-tamer)" in said


def test_a_predicate_may_be_called_as_what_is_not_known() -> None:
    text = domain("").replace("(q)", "(assign)").replace("()\n :effect", "(not (assign))\n :effect")
    assert task_from_text(text.replace(" (:functions (battery))\n", ""), PROBLEM).goal is not None


def test_what_is_declared_as_numeric_in_unified_planning() -> None:
    """What is said of the engines is what they declare, of those that are installed."""
    shortcuts = pytest.importorskip("unified_planning.shortcuts")
    features = {"numbers": "INT_FLUENTS", "time": "CONTINUOUS_TIME", "objects": "OBJECT_FLUENTS"}
    features["hierarchy"] = "HIERARCHICAL"
    factory = shortcuts.get_environment().factory
    for feature, name in features.items():
        for engine in engines.KNOWS[feature]:
            if engine in factory.engines:
                assert name in factory.engine(engine).supported_kind().features
