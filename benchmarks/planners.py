"""Planners side by side, and what a second search is for. Run it from the repository:

    python benchmarks/planners.py [--planners A,B,…] [--timeout S] [--searches] [--json]

Each planner plans the shipped tasks; the first call, in which its process starts, and the median of
three more. With `--searches`: generated problems that FF alone is slow in, planned with FF alone,
as `fast-downward:lama`, and as the default.
"""

import argparse
import json
import statistics
import sys
from pathlib import Path
from typing import Any

from tpvqa.errors import TpvqaError
from tpvqa.pddl import Task, load_task, task_from_text
from tpvqa.planning import Plan, Planner, PlanningResult, fast_downward
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.making import make_planner

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests.planning.families import OPENSTACKS, PRINTER, VISIT, openstacks, printer, visit

PLANNERS = (
    "fast-downward",
    "fast-downward:optimal",
    "clingo",
    "up:pyperplan",
    "up:pyperplan-opt",
    "up:aries",
    "up:symk-opt",
    "up:tamer",
    "up:enhsp",
    "up:fast-downward",
)
TASKS = ("clean_dishes", "serve_breakfast", "eat_apple", "build_tower")


def said(result: PlanningResult) -> str:
    """The length of a plan, or how the call ended."""
    return str(len(result.actions)) if isinstance(result, Plan) else type(result).__name__


def engines(names: list[str], timeout: float) -> list[dict[str, Any]]:
    """A row for each planner and task."""
    rows: list[dict[str, Any]] = []
    for spec in names:
        for name in TASKS:
            try:
                planner: Planner = make_planner(spec)
            except TpvqaError as error:
                rows.append({"planner": spec, "task": name, "result": str(error)})
                break
            task = load_task(name)
            first = planner.plan(task, timeout=timeout)
            later = [planner.plan(task, timeout=timeout) for _ in range(3)]
            row = {
                "planner": spec,
                "task": name,
                "result": said(first),
                "first_ms": first.seconds * 1000,
                "ms": statistics.median(each.seconds for each in later) * 1000,
            }
            rows.append(row)
            planner.close()
    return rows


def searches(timeout: float) -> list[dict[str, Any]]:
    """A row for each generated problem."""
    own = fast_downward._searches
    alone = {"simple": fast_downward._FF, "other": fast_downward._FF}
    ways: list[tuple[str, str | None]] = [("FF alone", None), ("lama", "lama"), ("default", None)]
    problems = [
        *((f"openstacks, {n} orders", OPENSTACKS, openstacks(n)) for n in (10, 20, 40)),
        *(
            (f"printer, {n} sheets, seed {seed}", PRINTER, printer(n, seed=seed))
            for n, seed in ((6, 0), (8, 1), (12, 1), (12, 0))
        ),
        *((f"square of {n}", VISIT, visit(n)) for n in (12, 16, 20, 30)),
    ]
    rows: list[dict[str, Any]] = []
    for name, domain, problem in problems:
        task: Task = task_from_text(domain, problem)
        row: dict[str, Any] = {"task": name, "actions": len(task.reachable_actions)}
        for way, search in ways:
            fast_downward._searches = (lambda *_: alone) if way == "FF alone" else own
            result = FastDownward(search=search).plan(task, timeout=timeout)
            row[way] = f"{result.seconds:.2f} s, {said(result)}"
        rows.append(row)
    fast_downward._searches = own
    return rows


def main() -> int:
    """Print the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--planners", default=",".join(PLANNERS))
    parser.add_argument("--timeout", type=float, default=20.0)
    parser.add_argument("--searches", action="store_true")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    if options.searches:
        rows = searches(options.timeout)
    else:
        rows = engines(options.planners.split(","), options.timeout)
    if options.json:
        print(json.dumps(rows, indent=2))
        return 0
    for row in rows:
        values = (f"{each:.0f}" if isinstance(each, float) else str(each) for each in row.values())
        print(" | ".join(values))
    return 0


if __name__ == "__main__":
    sys.exit(main())
