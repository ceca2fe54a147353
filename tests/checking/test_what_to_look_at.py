"""What `tpvqa check` tells of drafted words: which are guesses, and where they are to go."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run, tpvqa

__all__ = ["tpvqa"]
DOMAIN = """(define (domain evidence) (:requirements :typing) (:types bag shoe room - object)
  (:predicates (sealed ?b - bag) (kept ?s - shoe))
  (:action seal :parameters (?b - bag ?s - shoe) :effect (and (sealed ?b) (kept ?s))))"""
PROBLEM = """(define (problem p) (:domain evidence) (:objects sack - bag sandal - shoe)
  (:init) (:goal (and (sealed sack) (kept sandal))))"""


@pytest.fixture
def task(tmp_path: Path, tpvqa: Run) -> list[str]:
    (Path.cwd() / "scene").mkdir()
    Path("scene/domain.pddl").write_text(DOMAIN)
    Path("scene/problem.pddl").write_text(PROBLEM)
    return ["scene/domain.pddl", "scene/problem.pddl"]


def test_lines_that_are_still_marked_are_told_until_somebody_has_read_them(
    task: list[str], tpvqa: Run
) -> None:
    assert tpvqa("questions", *task, "--draft")[0] == 0
    code, out, _ = tpvqa("check", *task)
    assert code == 0
    assert "seal is marked LOOK" in out
    file = Path("scene/questions.yaml")
    file.write_text(file.read_text().replace("# LOOK", "# read"))
    assert "LOOK" not in tpvqa("check", *task)[1]


@pytest.mark.parametrize("lines", [1, 300_000])
def test_a_file_that_was_refused_is_not_read_for_marks(
    lines: int, task: list[str], tpvqa: Run
) -> None:
    Path("scene/questions.yaml").write_text("predicates: [\n" + "seal: # LOOK: a guess\n" * lines)
    code, out, err = tpvqa("check", *task)
    assert code != 0
    assert "questions.yaml" in out
    assert "is marked LOOK" not in out
    assert "Traceback" not in out + err


def test_words_to_paste_are_marked_too_and_go_where_the_task_lies(
    task: list[str], tpvqa: Run
) -> None:
    Path("scene/questions.yaml").write_text('predicates: {sealed: "Is the {b} sealed?"}\n')
    out = tpvqa("check", *task)[1]
    (line,) = [line for line in out.splitlines() if line.lstrip().startswith("seal:")]
    assert "# LOOK" in line
    assert "in scene/questions.yaml:" in out


def test_a_world_file_that_is_not_there_is_named_with_its_folder(
    task: list[str], tpvqa: Run
) -> None:
    Path("scene/questions.yaml").write_text(
        'never_asked: [{fact: "(sealed ?b)"}, {fact: "(kept ?s)"}]\n'
    )
    out = tpvqa("check", *task)[1]
    assert "in scene/world.yaml:" in out
