"""`tpvqa plan` and `tpvqa tasks`."""

import json
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tpvqa.cli.notices import about_start
from tpvqa.cli.options import task_config
from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.planning import PlanningResult

UNSOLVABLE, TIMED_OUT, CRASHED = 3, 4, 5
OPTIMAL = "fast-downward:optimal"

_EXIT = (
    "Exit codes: 0 a plan was found, 2 bad input, or a task that is not for this planner, "
    "3 no plan exists, 4 timed out, 5 the planner crashed (or ran out of memory), 130 interrupted."
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    app.command(epilog=_EXIT)(plan)
    app.command()(tasks)


Task = Annotated[
    str | None,
    typer.Argument(
        help="A shipped task (see `tpvqa tasks`), a folder with your own, your own domain file, or "
        "a logic program (.lp)."
    ),
]
Problem = Annotated[
    Path | None, typer.Argument(metavar="[PROBLEM]", help="Your problem, after a domain file.")
]
Domain = Annotated[Path | None, typer.Option(help="Your own domain, or a logic program (.lp).")]
OwnProblem = Annotated[Path | None, typer.Option("--problem", help="Your own problem.")]
PlannerName = Annotated[
    str | None,
    typer.Option(
        "--planner",
        help="fast-downward, fast-downward:optimal, :lama or :anytime, clingo, up:NAME (an "
        "engine of unified-planning) or a plug-in; see docs/planners.md.",
        show_default="fast-downward",
    ),
]


def plan(
    task: Task = None,
    problem_file: Problem = None,
    *,
    domain: Domain = None,
    problem: OwnProblem = None,
    from_state: Annotated[
        Path | None,
        typer.Option(
            help="Plan from this state instead: a file with one atom a line, (on plate table), "
            "or a JSON list of atoms. Facts that no action changes may be left out."
        ),
    ] = None,
    planner: PlannerName = None,
    optimal: Annotated[
        bool,
        typer.Option(
            "--optimal", help="A plan of least cost; short for --planner fast-downward:optimal."
        ),
    ] = False,
    timeout: Annotated[
        float,
        typer.Option(
            help="Seconds for reading, grounding and search; inf for no limit.",
            min=0.001,
        ),
    ] = 60.0,
    as_json: Annotated[bool, typer.Option("--json", help="Print the result as JSON.")] = False,
) -> None:
    """Plan a task and print the plan."""
    from tpvqa.drivers.plugged import planned
    from tpvqa.errors import GroundingTimedOut, PlannerError
    from tpvqa.pddl import load_task
    from tpvqa.pddl.state_file import read_state
    from tpvqa.planning import Crashed, TimedOut
    from tpvqa.planning.making import make_planner

    start = time.perf_counter()
    wanted, _ = task_config(task, problem_file, domain, problem)
    chosen = make_planner(_spec(planner, optimal=optimal))
    result: PlanningResult
    try:
        loaded = load_task(wanted.name or wanted.domain or "", wanted.problem, timeout=timeout)
        state = None if from_state is None else read_state(from_state, loaded)
        for notice in about_start(loaded) if state is None else ():
            tell(f"note: {notice}", error=True)
        left = max(0.0, timeout - (time.perf_counter() - start))
        result = planned(chosen, loaded, state, timeout=left)
    except GroundingTimedOut:
        result = TimedOut(timeout, chosen.name, time.perf_counter() - start)
    except PlannerError as error:
        result = Crashed(str(error), chosen.name, time.perf_counter() - start)
    if isinstance(result, TimedOut):  # the limit that the user gave, not what was left of it
        result = replace(result, limit=timeout)
    chosen.close()
    code = _exit_code(result)
    if as_json:
        print(json.dumps(_as_json(result), indent=2))
    else:
        for line in _as_text(result).split("\n"):
            tell(line, error=bool(code))
    raise typer.Exit(code)


def _spec(planner: str | None, *, optimal: bool) -> str:
    """The planner that is asked for."""
    from tpvqa.errors import TpvqaError

    if planner is not None and not planner.strip():
        raise TpvqaError("--planner must not be empty.")
    if not optimal:
        return planner or "fast-downward"
    if planner not in (None, OPTIMAL):
        raise TpvqaError(f"--optimal is short for --planner {OPTIMAL}, not {planner}. Give one.")
    return OPTIMAL


def _exit_code(result: "PlanningResult") -> int:
    from tpvqa.planning import Plan, TimedOut, Unfit, Unsolvable

    match result:
        case Plan():
            return 0
        case Unfit():
            return 2
        case Unsolvable():
            return UNSOLVABLE
        case TimedOut():
            return TIMED_OUT
        case _:
            return CRASHED


def _as_json(result: "PlanningResult") -> dict[str, Any]:
    from tpvqa.planning import Plan, TimedOut, Unfit, Unsolvable

    who = {"planner": result.planner, "seconds": round(result.seconds, 6)}
    match result:
        case Plan(actions, cost):
            steps = [{"name": step.name, "arguments": list(step.arguments)} for step in actions]
            timed = {"times": list(result.times)} if result.times else {}
            return {"plan": steps, "cost": cost, **timed, **who}
        case TimedOut(limit):
            return {"plan": None, "result": "timed out", "limit": limit, **who}
        case Unsolvable(reason):
            return {"plan": None, "result": "unsolvable", "reason": reason, **who}
        case Unfit(reason):
            return {"plan": None, "result": "cannot be planned", "reason": reason, **who}
        case _:
            return {"plan": None, "result": "crashed", "reason": result.reason, **who}


def _as_text(result: "PlanningResult") -> str:
    from tpvqa.planning import Plan, TimedOut, Unfit, Unsolvable

    match result:
        case Plan(actions, cost):
            lines = [f"{number:3d}. {step}" for number, step in enumerate(actions, start=1)]
            if result.times:
                width = max(len(f"{at:g}") for at in result.times)
                lines = [
                    f"{at:>{width}g}  {line}" for at, line in zip(result.times, lines, strict=True)
                ]
            lines = lines or ["The goal already holds: there is nothing to do."]
            took = f"{result.seconds * 1000:.0f} ms"
            return "\n".join([*lines, f"cost {cost}, {result.planner}, {took}"])
        case TimedOut(limit):
            return f"Timed out after {limit:g} s. Give it more time with --timeout."
        case Unsolvable(reason):
            return f"There is no plan: {reason}."
        case Unfit(reason):
            return f"This task cannot be planned with {result.planner}: {reason}."
        case _:
            return f"The planner crashed: {result.reason}."


def tasks(
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print the list as JSON.")] = False,
) -> None:
    """List the shipped tasks with their goals and objects."""
    from tpvqa.pddl import load_task
    from tpvqa.pddl.conditions import literals, said
    from tpvqa.planning.fast_downward import FastDownward
    from tpvqa.tasks import shipped_tasks

    loaded = [(files, load_task(files.name)) for files in shipped_tasks()]
    FastDownward().close()
    if as_json:
        entries = [
            {
                "name": files.name,
                "domain": str(files.domain),
                "problem": str(files.problem),
                "goal": [str(literal) for literal in literals(task.goal)],
                "objects": dict(task.objects),
            }
            for files, task in loaded
        ]
        print(json.dumps(entries, indent=2))
        return
    for files, task in loaded:
        tell(f"{files.name}  ({task.domain_name})")
        tell(f"  goal     {said(task.goal)}")
        tell(f"  objects  {', '.join(task.objects)}")
