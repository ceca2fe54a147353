"""A task that is too large to be grounded: in what time that is told, and by which option."""

import time
from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tpvqa.assembly.grounding import grounded
from tpvqa.config import PlannerConfig

PARAMETERS = " ".join(f"?x{n} - room" for n in range(60))
DOMAIN = f"""(define (domain lamps)
 (:requirements :strips :typing)
 (:types lamp room)
 (:predicates (lit ?l - lamp) (in ?l - lamp ?r - room))
 (:action light :parameters (?l - lamp ?r - room {PARAMETERS})
  :precondition (in ?l ?r) :effect (lit ?l)))
"""
PROBLEM = """(define (problem one) (:domain lamps)
 (:objects l - lamp r1 r2 - room) (:init (in l r1)) (:goal (lit l)))
"""


@pytest.mark.parametrize(
    ("command", "option", "code"),
    [
        (("run", "--vlm", "oracle:0.9", "--out", "episode"), "--planning-timeout", 2),
        (("config", "--vlm", "oracle:0.9"), "--planning-timeout", 2),
        (("check",), "--timeout", 2),
        (("questions",), "--timeout", 4),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else None,
)
def test_grounding_ends_in_time_and_names_the_option(
    command: tuple[str, ...], option: str, code: int, tpvqa: Run, tmp_path: Path
) -> None:
    (tmp_path / "d.pddl").write_text(DOMAIN)
    (tmp_path / "p.pddl").write_text(PROBLEM)
    name, *rest = command
    began = time.monotonic()
    found, _, err = tpvqa(name, tmp_path / "d.pddl", tmp_path / "p.pddl", *rest, option, 1)
    assert time.monotonic() - began < 20
    assert found == code
    said = " ".join(err.split())
    assert "grounding the task took more than 1 s" in said
    assert f"give it more time by {option}" in said
    assert "=…" not in said


def test_what_a_planner_is_allowed_by_default_does_not_bound_grounding(tmp_path: Path) -> None:
    (tmp_path / "d.pddl").write_text(DOMAIN)
    (tmp_path / "p.pddl").write_text(PROBLEM)
    allowed: list[float | None] = []

    def load(*_: Path | str, timeout: float | None) -> None:
        allowed.append(timeout)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tpvqa.assembly.grounding.load_task", load)
        for planner in (PlannerConfig(), PlannerConfig(timeout=7.0)):
            grounded(tmp_path / "d.pddl", tmp_path / "p.pddl", planner)
    assert allowed == [300.0, 7.0]
