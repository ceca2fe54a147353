"""A whole seeded trial with every planner, as a user types it."""

import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("up_aries")
pytest.importorskip("up_pyperplan")


@pytest.mark.parametrize("spec", ["up:pyperplan-opt", "up:aries", "fast-downward:anytime:0.5"])
def test_a_trial_with_a_planner_by_name(spec: str, tmp_path: Path) -> None:
    words = ["run", "clean_dishes", "--planner", spec, "--vlm", "oracle:0.95", "--seed", "5"]
    done = subprocess.run(
        [sys.executable, "-m", "tpvqa", *words, "--world", "symbolic", "--out", "trial"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "goal reached" in done.stdout
    shown = subprocess.run(
        [sys.executable, "-m", "tpvqa", "show", "trial"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert spec in shown.stdout


@pytest.mark.parametrize(("monitor", "code"), [("tpvqa", 0), ("none", 1)])
def test_a_trial_in_which_something_fails_while_it_runs(
    monitor: str, code: int, tmp_path: Path
) -> None:
    files = Path(__file__).parents[2] / "examples/timed/laboratory"
    words: list[str | Path] = [
        "run",
        "--domain",
        files / "domain.pddl",
        "--problem",
        files / "problem.pddl",
    ]
    words += ["--planner", "up:aries", "--vlm", "oracle:1.0", "--failure", "0", "--seed", "7"]
    done = subprocess.run(
        [sys.executable, "-m", "tpvqa", *words, "--monitor", monitor, "--out", "trial"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == code, done.stderr
    assert "it slips back into the store" in done.stdout
    assert ("cancel: fetch the steel tray" in done.stdout) == (monitor == "tpvqa")
    if monitor == "none":
        return
    report = subprocess.run(
        [sys.executable, "-m", "tpvqa", "report", "trial"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert report.returncode == 0, report.stderr
