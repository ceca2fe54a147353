"""A whole seeded trial with every planner, as a user types it."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run

pytest.importorskip("up_aries")
pytest.importorskip("up_pyperplan")


@pytest.mark.parametrize("spec", ["up:pyperplan-opt", "up:aries", "fast-downward:anytime:0.5"])
def test_a_trial_with_a_planner_by_name(spec: str, tpvqa: Run) -> None:
    words = ["run", "clean_dishes", "--planner", spec, "--vlm", "oracle:0.95", "--seed", "5"]
    code, out, err = tpvqa(*words, "--world", "symbolic", "--out", "trial")
    assert code == 0, err
    assert "goal reached" in out
    assert spec in tpvqa("show", "trial")[1]


@pytest.mark.parametrize(("monitor", "code"), [("tpvqa", 0), ("none", 1)])
def test_a_trial_in_which_something_fails_while_it_runs(
    monitor: str, code: int, tpvqa: Run
) -> None:
    files = Path(__file__).parents[2] / "examples/timed/laboratory"
    words = ["run", "--domain", files / "domain.pddl", "--problem", files / "problem.pddl"]
    words += ["--planner", "up:aries", "--vlm", "oracle:1.0", "--failure", "0", "--seed", "7"]
    done, out, err = tpvqa(*words, "--monitor", monitor, "--out", "trial")
    assert done == code, err
    assert "it slips back into the store" in out
    assert ("cancel: fetch the steel tray" in out) == (monitor == "tpvqa")
    if monitor == "none":
        return
    done, _, err = tpvqa("report", "trial")
    assert done == 0, err


@pytest.mark.parametrize("planner", [[], ["--planner", "clingo"]], ids=["default", "clingo"])
def test_a_planner_that_knows_no_numbers_begins_no_trial_of_them(
    planner: list[str], tpvqa: Run
) -> None:
    files = Path(__file__).parents[2] / "examples/numbers/rover"
    words = ["run", files / "domain.pddl", files / "problem.pddl", "--monitor", "tpvqa", *planner]
    code, _, err = tpvqa(*words, "--vlm", "oracle:1.0", "--out", "trial")
    assert (code, Path("trial").exists()) == (2, False)
    assert "In this domain actions change numbers (battery" in err
    assert "does not know. As --planner take up:enhsp" in err
