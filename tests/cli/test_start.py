"""Trials that begin unsure, from the command line."""

import json
from pathlib import Path

import pytest

from tests import ward
from tests.cli.conftest import Run
from tpvqa.bench.cell import Cell
from tpvqa.config import TrialConfig


@pytest.fixture
def night(tmp_path: Path) -> tuple[str, ...]:
    (tmp_path / "domain.pddl").write_text(ward.DOMAIN)
    (tmp_path / "problem.pddl").write_text(ward.PROBLEM)
    return (
        *("--domain", str(tmp_path / "domain.pddl"), "--problem", str(tmp_path / "problem.pddl")),
        *("--world", "symbolic", "--vlm", "oracle:0.9"),
    )


def test_a_problem_that_leaves_facts_open_is_run_and_read_again(
    tpvqa: Run, night: tuple[str, ...]
) -> None:
    code, out, _ = tpvqa("run", *night, "--out", "night")
    assert code == 0
    assert "12 initial states are possible" in out
    assert out.index("initial states are possible") < out.index("plan ") < out.index("▶")
    assert tpvqa("show", "night")[0] == 0
    assert tpvqa("report", "night")[0] == 0
    assert "before the first plan" in Path("night/report.html").read_text(encoding="utf-8")


def test_who_cannot_weigh_what_is_open_says_so(tpvqa: Run, night: tuple[str, ...]) -> None:
    code, _, err = tpvqa("plan", *night[:4])
    assert code == 0
    assert "the problem leaves 7 facts open; the plan is one from a state that may be" in err
    _, _, err = tpvqa("run", *night, "--monitor", "tpvqa")
    assert "this monitor knows no probabilities" in err
    _, _, err = tpvqa("run", "build_tower", *night[4:], "--monitor", "tpvqa")
    assert "probabilities" not in err


def test_nothing_known_and_a_file_of_priors(
    tpvqa: Run, night: tuple[str, ...], tmp_path: Path
) -> None:
    priors = tmp_path / "priors.yaml"
    priors.write_text("(needs anna pump): 0.9\n")
    code, out, _ = tpvqa("run", *night, "--priors", priors, "--start", "unknown", "--json")
    assert code == 0
    assert json.loads(out)["completed"] is True


def test_what_is_wrong_is_told_before_anything_runs(
    tpvqa: Run, night: tuple[str, ...], tmp_path: Path
) -> None:
    priors = tmp_path / "priors.yaml"
    priors.write_text("elswhere: 0.1\n")
    code, _, err = tpvqa("run", *night, "--priors", priors)
    assert code == 2
    assert f"{priors}:1: 'elswhere' is not known here" in err
    code, _, err = tpvqa("run", *night, "--priors", tmp_path / "none.yaml")
    assert code == 2
    assert "none.yaml" in err
    code, _, err = tpvqa("run", *night, "--start", "half")
    assert code == 2
    assert "must be 'known' or 'unknown', got half" in err
    assert not Path("episodes").exists()


def test_what_says_nothing_is_told_and_the_trial_runs(
    tpvqa: Run, night: tuple[str, ...], tmp_path: Path
) -> None:
    priors, empty = tmp_path / "priors.yaml", tmp_path / "empty.yaml"
    priors.write_text("elsewhere: 0.1\n(at hall): 0.3\n")
    empty.touch()
    code, _, err = tpvqa("run", *night, "--priors", priors, "--questions", empty)
    assert code in (0, 1)
    assert f"note: {priors}:2: (at hall): 0.3 has no effect: with all that" in err
    assert f"note: {empty}: the file is empty" in err
    code, _, err = tpvqa("run", *night, "--priors", empty)
    assert f"note: {empty}: the file says nothing of how probable facts are. Leave it out" in err


def test_a_condition_of_a_bench_says_what_is_known() -> None:
    cell = Cell("build_tower", "belief", "oracle:0.9", "symbolic", "start=unknown,priors=mine.yaml")
    start = cell.config(TrialConfig(), 0).start
    assert (start.what, start.priors) == ("unknown", "mine.yaml")
    assert Cell("build_tower", "belief", "oracle", "symbolic").config(TrialConfig(), 0).start == (
        TrialConfig().start
    )


def test_one_fact_that_is_open_is_said_as_one(tpvqa: Run, tmp_path: Path) -> None:
    domain = "(define (domain d) (:predicates (lit) (off)) (:action on :effect (lit)))"
    start = "(:init (unknown (off)))"
    problem = f"(define (problem p) (:domain d) {start} (:goal (lit)))"
    for name, text in (("domain", domain), ("problem", problem)):
        (tmp_path / f"{name}.pddl").write_text(text)
    code, _, err = tpvqa("plan", tmp_path / "domain.pddl", tmp_path / "problem.pddl")
    assert code == 0, err
    assert "the problem leaves 1 fact open" in err
