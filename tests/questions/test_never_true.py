"""Facts that can never hold are not asked about: a domain without types speaks of everything."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from tests.cli.conftest import Run, tpvqa
from tpvqa.assembly import Trial
from tpvqa.assembly.reach import asking
from tpvqa.belief.filtering.priors import Priors
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events.events import Asked
from tpvqa.pddl import Atom, Literal, task_from_text
from tpvqa.questions import QuestionBook
from tpvqa.worlds.world_file import WorldRules

__all__ = ["tpvqa"]
DOMAIN = """(define (domain scene) (:requirements :strips :negative-preconditions)
  (:predicates (exhibit ?x) (room ?r) (in ?x ?r) (gripped ?x) (gloved))
  (:action grip :parameters (?x ?r)
    :precondition (and (exhibit ?x) (room ?r) (in ?x ?r) (forall (?y) (not (gripped ?y))))
    :effect (and (gripped ?x) (not (in ?x ?r))))
  (:action drop :parameters (?x ?r) :precondition (and (gripped ?x) (room ?r))
    :effect (and (in ?x ?r) (not (gripped ?x))))
  (:action glove :precondition (forall (?x) (not (gripped ?x))) :effect (gloved)))"""
PROBLEM = """(define (problem p) (:domain scene) (:objects knife hall van)
  (:init (exhibit knife) (room hall) (room van) (in knife hall))
  (:goal (and (gloved) (in knife van))))"""
UNDO = """undo:
  - fact: (gloved)
    outcomes: [{add: ["(gripped hall)"]}]
"""


DOORS = """(define (domain doors) (:requirements :strips :negative-preconditions)
  (:predicates (door ?d) (key ?k ?d) (locked ?d) (opened ?d))
  (:action unlock :parameters (?k ?d) :precondition (and (key ?k ?d) (locked ?d))
    :effect (not (locked ?d)))
  (:action open-one :parameters (?d) :precondition (and (door ?d) (forall (?x) (not (locked ?x))))
    :effect (opened ?d)))"""
HOUSE = """(define (problem p) (:domain doors) (:objects front back hall brass)
  (:init (door front) (door back) (key brass front)) (:goal (opened front)))"""


@pytest.fixture
def files(tmp_path: Path) -> dict[str, str]:
    (tmp_path / "domain.pddl").write_text(DOMAIN)
    (tmp_path / "problem.pddl").write_text(PROBLEM)
    return {name: str(tmp_path / f"{name}.pddl") for name in ("domain", "problem")}


def asked(files: dict[str, str], monitor: str = "tpvqa", **more: Any) -> set[str]:
    """What was asked about in a trial in which nothing goes wrong."""
    config = TrialConfig.model_validate(
        {"task": files, "world": "symbolic", "vlm": "oracle:1", "monitor": monitor, **more}
    )
    writer = MemoryWriter()
    with Trial(config) as trial:
        assert trial.run(writer).completed
    found = (each for each in writer.events if isinstance(each, Asked))
    return {question.atom for each in found for question in each.questions if question.atom}


@pytest.mark.parametrize("monitor", ["tpvqa", "vote:3", "lead:2", "effectvqa", "belief"])
def test_nobody_asks_whether_the_robot_grips_the_hall(files: dict[str, str], monitor: str) -> None:
    found = asked(files, monitor)
    assert not {atom for atom in found if "gripped hall" in atom or "gripped van" in atom}
    assert monitor == "belief" or any("gripped knife" in atom for atom in found)


def test_what_mishaps_or_the_start_may_bring_about_is_asked(
    files: dict[str, str], tmp_path: Path
) -> None:
    world, priors = tmp_path / "world.yaml", tmp_path / "priors.yaml"
    world.write_text(UNDO)
    found = asked({**files, "world_file": str(world)})
    assert any("gripped hall" in atom for atom in found)
    assert any("gripped van" in atom for atom in found)  # its predicate is named
    priors.write_text("(gripped hall): 0.01\n")
    found = asked(files, start={"what": "known", "priors": str(priors)})
    assert any("gripped hall" in atom for atom in found)
    found = asked(files, start={"what": "unknown"})
    assert any("gripped van" in atom for atom in found)


@pytest.mark.parametrize("monitor", ["tpvqa", "lead:2"])
def test_what_actions_end_and_none_brings_about_is_asked(
    monitor: str, files: dict[str, str]
) -> None:
    """Somebody locked the door before; that the problem does not say so is no proof."""
    Path(files["domain"]).write_text(DOORS)
    Path(files["problem"]).write_text(HOUSE)
    about = {atom for atom in asked(files, monitor) if "locked" in atom}
    assert about == {"(locked front)"}  # no key fits the others, and the hall is no door


def test_where_objects_were_left_out_all_is_asked_that_they_may_bring_about() -> None:
    task = replace(task_from_text(DOMAIN, PROBLEM), left_out=frozenset({"glove-box"}))
    book = QuestionBook(task)
    assert asking(book, task, WorldRules(), Priors()).asked(Literal(Atom("gripped", ("hall",))))


def test_the_list_of_questions_leaves_them_out_too(files: dict[str, str], tpvqa: Run) -> None:
    code, out, _ = tpvqa("questions", files["domain"], files["problem"])
    assert code == 0
    assert "gripped" in out
    assert "gripped the hall" not in out
    assert not any("hall gripped" in line for line in out.splitlines())
