"""Objects that play no part are told, and only where that is certain."""

from pathlib import Path

import pytest

from tests.checking.test_check import Files

UNUSED = ("out_tray spare_tray - tray", "out_tray spare_tray\n  third_tray - tray bolt nut - part")

CONSTANTS = "(:constants in_tray out_tray - tray) (:predicates"


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path).change("problem.pddl", *UNUSED)


def _told(files: Files) -> list[str]:
    return [each.says for each in files.found() if each.kind == "object-unused"]


def test_objects_that_stand_nowhere_are_told_with_their_line(files: Files) -> None:
    (found,) = (each for each in files.found() if each.kind == "object-unused")
    assert found.says.startswith("no fact and no goal of the problem names third_tray, bolt, nut,")
    assert found.line == files.line("problem.pddl", "third_tray")


@pytest.mark.parametrize(
    ("file", "old", "new"),
    [
        ("problem.pddl", "(free)", "(free) (pressed bolt) (pressed nut) (empty third_tray)"),
        ("problem.pddl", "(free)", "(free) (unknown (lies bolt third_tray)) (pressed nut)"),
        ("problem.pddl", "(and (pressed lid)", "(and (not (held bolt)) (not (held nut)) (lies lid "
         "out_tray) (not (empty third_tray))"),
        ("world.yaml", '"(lies ?p spare_tray)"', '"(lies nut third_tray)", "(pressed bolt)"'),
        ("world.yaml", "(held ?p)", "(helt ?p)"),
        ("questions.yaml", "  held:", "  helt:"),
        ("questions.yaml", "never_asked:", 'in_doubt: ["(lies ?p ?t)"]\nnever_asked:'),
    ],
)  # fmt: skip
def test_what_is_named_or_in_doubt_or_may_be_plays_a_part(
    files: Files, file: str, old: str, new: str
) -> None:
    assert not _told(files.change(file, old, new))


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        (":precondition (held ?p)\n", ":precondition (not (held ?p))\n", "names third_tray,"),
        ("(and (held ?p) (empty ?t))", "(and (held ?p))", "names bolt, nut,"),
        (":precondition (held ?p)\n", ":precondition (and (held ?p) (forall (?o - part) (or "
         "(lies ?o in_tray) (pressed ?o) (held ?p))))\n", "names third_tray,"),
        (":effect (pressed ?p)", ":effect (forall (?o - part) (pressed ?o))", "third_tray,"),
        (":effect (pressed ?p)", ":effect (forall (?o - part) (when (lies ?o out_tray) "
         "(pressed ?o)))", "third_tray, bolt, nut,"),
    ],
)  # fmt: skip
def test_what_an_action_may_take_without_a_fact_about_it_plays_a_part(
    files: Files, old: str, new: str, told: str
) -> None:
    files.change("problem.pddl", "in_tray out_tray", "out_tray in_tray")
    if "in_tray" in new or "out_tray" in new:
        files.change("domain.pddl", "(:predicates", CONSTANTS)
        files.change("problem.pddl", "out_tray in_tray spare", "spare")
    (said,) = _told(files.change("domain.pddl", old, new))
    assert told in said
