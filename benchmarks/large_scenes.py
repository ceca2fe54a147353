"""Large tasks with what cannot matter left out, and in whole, side by side.

Each task is loaded, planned for and replanned for from states in which one thing is elsewhere; then
a worker is asked for the same with nothing left out. Run it from the repository:

    python benchmarks/large_scenes.py [--objects N …] [--seeds N] [--whole SECONDS] [--json]
"""

import argparse
import json
import os
import statistics
import sys
import time
from collections.abc import Iterator
from random import Random
from typing import Any

from large_problems import (  # type: ignore[import-not-found]
    BLOCKS,
    LOGISTICS,
    SCENE,
    blocks_problem,
    logistics_problem,
    scene_problem,
)

from tpvqa.pddl import Atom, State, Task, task_from_text, validate
from tpvqa.pddl.description import MEMORY, to_lists
from tpvqa.pddl.processes import WORKERS, WorkerTimedOut, ask_worker
from tpvqa.planning import Plan
from tpvqa.planning.fast_downward import FastDownward

KINDS = {
    "scene": (SCENE, scene_problem),
    "logistics": (LOGISTICS, logistics_problem),
    "blocks": (BLOCKS, blocks_problem),
}
FIRST, AGAIN = 2.0, 0.2  # seconds: the targets for a plan, loading included, and for a replan
_SEARCH = "let(h,ff(),lazy_greedy([h],preferred=[h]))"


def states(kind: str, task: Task, plan: Plan, *, seed: int, count: int) -> Iterator[State]:
    """States on the way of a plan; in every other one of a scene or of logistics a thing moved."""
    random = Random(seed)
    way = validate(task, plan.actions).states
    for number in range(count):
        state = random.choice(way)
        where = {"scene": "ontop", "logistics": "at"}.get(kind)
        moved = [atom for atom in sorted(state) if atom.predicate == where]
        mine = [atom for atom in moved if atom.arguments[0] in ("plate", "soap", "parcel0")]
        if number % 2 and mine:
            other = random.choice([atom.arguments[1] for atom in moved])
            state = (state - {mine[0]}) | {Atom(mine[0].predicate, (mine[0].arguments[0], other))}
        yield state


def whole(task: Task, state: State, seconds: float) -> tuple[float, str]:
    """Seconds, and what came of it, with nothing left out."""
    start = time.perf_counter()
    request = {
        "do": "plan",
        "state": to_lists(state),
        "searches": {"simple": _SEARCH, "other": _SEARCH},
        "seconds": seconds,
        "memory": MEMORY,
        "grounding_memory": MEMORY,
        "leaving": None,
    }
    try:
        texts = {"key": task.key, "domain": task.domain_text, "problem": task.problem_text}
        reply = ask_worker(request, **texts, seconds=seconds + 1)
        kind = reply["outcome"]["kind"]
    except WorkerTimedOut:
        kind = "timeout"
    return time.perf_counter() - start, kind


def measured(kind: str, objects: int, seed: int, *, limit: float) -> dict[str, Any]:
    """One task: seconds for loading, the first plan and replans, each way."""
    domain, problem = KINDS[kind]
    text = problem(objects, seed=seed)
    planner = FastDownward()
    start = time.perf_counter()
    task = task_from_text(domain, text)
    loaded = time.perf_counter()
    plan = planner.plan(task)
    first = time.perf_counter() - loaded
    assert isinstance(plan, Plan), plan
    again, lost = [], 0
    for state in states(kind, task, plan, seed=seed, count=10):
        result = planner.plan(task, state)
        again.append(result_seconds(result))
        lost += not isinstance(result, Plan)
    WORKERS.close()
    row = {
        "load": loaded - start,
        "plan": first,
        "steps": len(plan.actions),
        "again": again,
        "lost": lost,
        "objects": len(task.objects),
        "left_out": len(task.left_out),
    }
    if limit:
        row["whole_plan"], row["whole_kind"] = whole(task, task.init, limit)
        row["whole_again"] = None
        if row["whole_kind"] == "plan":
            row["whole_again"] = whole(task, task.init, limit)[0]
        WORKERS.close()
    return row


def result_seconds(result: Any) -> float:
    """Wall seconds of a planner's result."""
    return float(result.seconds)


def main() -> int:
    """Print the table; the exit code says whether the targets are reached at the largest size."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--objects", nargs="+", type=int, default=[50, 100, 300])
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--whole", type=float, default=20, help="seconds for it; 0 leaves it out")
    parser.add_argument("--json", action="store_true", help="print JSON")
    options = parser.parse_args()
    os.chdir("/")
    reached, rows = True, []
    if not options.json:
        print(
            f"{'task':15}{'left out':>10}{'load':>8}{'plan':>8}{'replan':>8}{'at 95%':>8}", end=""
        )
        print(f"{'steps':>7}{'no plan':>9}{'whole: plan':>16}{'replan':>8}{'ratio':>8}")
    for kind in options.kinds:
        for objects in options.objects:
            found = [
                measured(kind, objects, seed, limit=options.whole) for seed in range(options.seeds)
            ]
            row = summary(kind, objects, found)
            rows.append(row)
            if objects == max(options.objects):
                reached &= row["load"] + row["plan"] <= FIRST and row["again"] <= AGAIN
            if not options.json:
                print(line(row), flush=True)
    if options.json:
        print(json.dumps(rows, indent=2))
    else:
        print("Seconds; medians. `whole` grounds and searches the task with nothing left out.")
    return 0 if reached else 1


def summary(kind: str, objects: int, found: list[dict[str, Any]]) -> dict[str, Any]:
    """Medians over seeds."""
    again = sorted(seconds for each in found for seconds in each["again"])
    row = {
        "task": f"{kind}_{objects}",
        "again": statistics.median(again),
        "again_95": again[int(len(again) * 0.95)],
        "lost": sum(each["lost"] for each in found),
        "objects": found[0]["objects"],
    }
    for name in ("load", "plan", "steps", "left_out"):
        row[name] = statistics.median(each[name] for each in found)
    if "whole_plan" in found[0]:
        row["whole_plan"] = statistics.median(each["whole_plan"] for each in found)
        row["whole_kinds"] = [each["whole_kind"] for each in found]
        done = [each["whole_again"] for each in found if each["whole_again"] is not None]
        row["whole_again"] = statistics.median(done) if done else None
    return row


def line(row: dict[str, Any]) -> str:
    """A row of the table."""
    text = (
        f"{row['task']:15}{row['left_out']:>6.0f}/{row['objects']:<3}{row['load']:8.2f}"
        f"{row['plan']:8.2f}{row['again']:8.3f}{row['again_95']:8.3f}{row['steps']:7.0f}"
        f"{row['lost']:9}"
    )
    if "whole_plan" in row:
        lacking = sum(kind != "plan" for kind in row["whole_kinds"])
        said = f"{row['whole_plan']:.2f}" + (f" ({lacking} none)" if lacking else "")
        again = "–" if row["whole_again"] is None else f"{row['whole_again']:.3f}"
        ratio = row["whole_plan"] / (row["load"] + row["plan"])
        text += f"{said:>16}{again:>8}{ratio:7.1f}×"
    return text


if __name__ == "__main__":
    sys.exit(main())
