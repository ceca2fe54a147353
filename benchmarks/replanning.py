"""Our replanning against a plain unified-planning + Fast Downward call, side by side.

Both get the same task and the same state and hand back a plan; the calls take turns, so that
whatever else the machine does weighs on both alike. Run it from the repository:

    python benchmarks/replanning.py [--calls N] [--json]
"""

import argparse
import contextlib
import io
import json
import os
import statistics
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from household_problems import household_problem  # type: ignore[import-not-found]

from tpvqa.pddl import Task, load_task, task_from_text
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.tasks import find_task

TARGETS = {"eat_apple": 15.0, "household_60": 20.0}


def unified_planning_call(domain: str, problem: str, folder: Path) -> Callable[[], int]:
    """A plain call: the problem is already in memory; it is written, translated and searched."""
    from unified_planning.environment import get_environment
    from unified_planning.io import PDDLReader
    from unified_planning.shortcuts import OneshotPlanner

    environment = get_environment()
    environment.credits_stream = None
    environment.error_used_name = False  # the household has a sink of the type sink
    (folder / "domain.pddl").write_text(domain)
    (folder / "problem.pddl").write_text(problem)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        parsed = PDDLReader().parse_problem(
            str(folder / "domain.pddl"), str(folder / "problem.pddl")
        )

    def call() -> int:
        with OneshotPlanner(name="fast-downward") as planner:
            result = planner.solve(parsed)
        return len(result.plan.actions)

    return call


def our_call(task: Task, planner: FastDownward) -> Callable[[], int]:
    """A replan from a state, on the kept grounding."""

    def call() -> int:
        result = planner.plan(task, task.init)
        assert isinstance(result, Plan), result
        return len(result.actions)

    return call


def timed(call: Callable[[], int]) -> tuple[float, int]:
    """Milliseconds and the length of the plan."""
    start = time.perf_counter()
    with contextlib.redirect_stdout(io.StringIO()):
        length = call()
    return (time.perf_counter() - start) * 1000, length


def compare(name: str, task: Task, *, calls: int, folder: Path) -> dict[str, Any]:
    """Medians and their ratio over calls that take turns; the first of each is not counted."""
    planner = FastDownward()
    start = time.perf_counter()
    ours = our_call(task, planner)
    theirs = unified_planning_call(task.domain_text, task.problem_text, folder)
    first, length = timed(ours)
    _, their_length = timed(theirs)
    mine, other = [], []
    for _ in range(calls):
        mine.append(timed(ours)[0])
        other.append(timed(theirs)[0])
    planner.close()
    return {
        "task": name,
        "objects": len(task.objects),
        "ground_actions": len(task.reachable_actions),
        "calls": calls,
        "ours_ms": statistics.median(mine),
        "ours_first_ms": first,
        "ours_steps": length,
        "unified_planning_ms": statistics.median(other),
        "unified_planning_steps": their_length,
        "ratio": statistics.median(other) / statistics.median(mine),
        "target": TARGETS[name],
        "seconds": time.perf_counter() - start,
    }


def main() -> int:
    """Print the table; the exit code says whether the targets are reached."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--calls", type=int, default=15, help="calls of each side per task")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    household = find_task("eat_apple").domain.read_text()
    big = household_problem(60)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        os.chdir(folder)  # unified-planning's Fast Downward writes output.sas where it stands
        rows = [
            compare("eat_apple", load_task("eat_apple"), calls=options.calls, folder=folder),
            compare(
                "household_60",
                task_from_text(household, big),
                calls=max(3, options.calls // 3),
                folder=folder,
            ),
        ]
        os.chdir("/")
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print(f"{'task':14}{'ours':>10}{'u-planning':>12}{'ratio':>8}{'target':>8}{'first':>10}")
        for row in rows:
            print(
                f"{row['task']:14}{row['ours_ms']:7.1f} ms{row['unified_planning_ms']:9.1f} ms"
                f"{row['ratio']:7.1f}×{row['target']:7.0f}×{row['ours_first_ms']:7.1f} ms"
            )
        print("Medians; `first` is the first call, which grounds the task.")
    return 0 if all(row["ratio"] >= row["target"] for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main())
