"""An engine of unified-planning, given a numbered task whose actions last."""

import contextlib
import math
import time
from fractions import Fraction
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from unified_planning import shortcuts as up
from unified_planning.engines import PlanGenerationResult, PlanGenerationResultStatus

from tpvqa.planning.engines.numbered import Numbered, compiled_for
from tpvqa.planning.engines.unified_solving import MET, WHY, without_spaces

BETTERING = 1.0
"""Seconds in which a quicker plan is sought where the problem asks for the quickest."""

_GRID = 1000
"""Into so many parts the unit of time is divided where durations have no common divisor."""


def scale_of(task: dict[str, Any]) -> int:
    """What makes whole numbers of all durations, which some engines want.

    It stays small, as engines take long over great numbers: what is left to actions that run is
    any number by the world's clock, and is rounded, as are durations that would ask for more.
    """
    times = [time for *_, least, most in task["lasting"] for time in (least, most)]
    times += [left for *_, left in task["running"]]
    near = [_near(each) for each in times]
    exact = math.lcm(*(each.denominator for each in near))
    if exact <= _GRID and all(abs(n - t) <= t / _GRID for n, t in zip(near, times, strict=True)):
        return exact
    return max(_GRID, int(10.0 ** math.ceil(math.log10(10 / min(times)))))


def problem_of(task: dict[str, Any], scale: int = 1) -> Any:
    """A numbered task as a problem: fluents f0, f1, …; actions a0, a1, … by their first number.

    Args:
        task: What `planning.temporal.Schedule.request` gives.
        scale: What all durations are multiplied by.
    """
    numbered = Numbered(task)
    problem, needs_of, effects_of = numbered.problem, numbered.needs, numbered.effects
    for number in task["instant"]:
        numbered.add_instantaneous(number)
    begin, finish = up.StartTiming(), up.EndTiming()
    between = up.OpenTimeInterval(begin, finish)
    for start, meanwhile, end, least, most in task["lasting"]:
        action = up.DurativeAction(f"a{start}")
        action.set_closed_duration_interval(_ticks(least, scale), _ticks(most, scale))
        lasts = needs_of(meanwhile)
        for part in needs_of(start):
            action.add_condition(begin, part)
        for part in lasts:
            action.add_condition(between, part)
        for part in needs_of(end):
            if part not in lasts:  # at its end it holds as it does until then
                action.add_condition(finish, part)
        for effect in effects_of(start):
            action.add_effect(begin, *effect)
        for effect in effects_of(end):
            action.add_effect(finish, *effect)
        problem.add_action(action)
    for meanwhile, end, left in task["running"]:
        over = up.GlobalStartTiming(_ticks(left, scale))
        until = up.ClosedTimeInterval(up.GlobalStartTiming(), over)
        for part in needs_of(meanwhile):
            problem.add_timed_goal(until, part)
        for part in needs_of(end):
            problem.add_timed_goal(up.TimePointInterval(over), part)
        for effect in effects_of(end):
            problem.add_timed_effect(over, *effect)
    return problem


def _near(number: float) -> Fraction:
    return Fraction(number).limit_denominator(_GRID)


def _ticks(number: float, scale: int) -> int:
    return round(Fraction(number) * scale)


def solve(request: dict[str, Any]) -> dict[str, Any]:
    """Let an engine plan: when what begins and ends, as `[time, number of the action]`."""
    task = request["task"]
    scale = scale_of(task)
    problem = problem_of(task, scale)
    with up.OneshotPlanner(name=request["engine"]) as engine, TemporaryDirectory() as folder:
        without_spaces(engine, Path(folder))
        known = engine.supported_kind().features
        better = bool(task["quickest"]) and "MAKESPAN" in known and engine.is_anytime_planner()
        if better:
            problem.add_quality_metric(up.MinimizeMakespan())
        problem, back = compiled_for(engine, problem)
        missing = problem.kind.features - known
        if missing:
            said = ", ".join(sorted(each.lower().replace("_", " ") for each in missing))
            reason = f"the engine does not know {said}; aries and tamer know actions that last"
            return {"kind": "crash", "reason": reason}
        result = _solved(engine, problem, request["seconds"], better=better)
    plan = result.plan
    if plan is not None and result.status in MET:
        for convert in reversed(back):
            plan = plan.replace_action_instances(convert)
        return {"kind": "plan", "happenings": _happenings(task, plan, scale)}
    if result.status == PlanGenerationResultStatus.UNSOLVABLE_PROVEN:
        return {"kind": "unsolvable", "reason": "the engine proved it"}
    if result.status == PlanGenerationResultStatus.TIMEOUT:
        return {"kind": "timeout"}
    if result.status == PlanGenerationResultStatus.MEMOUT:
        return {"kind": "memory"}
    logged = [" ".join(each.message.split()) for each in result.log_messages or ()]
    told = f" ({logged[-1][-200:]})" if logged and logged[-1] else ""
    return {"kind": "crash", "reason": WHY.get(result.status, str(result.status)) + told}


def _solved(engine: Any, problem: Any, seconds: float | None, *, better: bool) -> Any:
    """A plan; the quickest that is found in a short time where a better one is sought."""
    began, best = time.monotonic(), None
    if better:
        short = BETTERING if seconds is None else min(BETTERING, seconds / 2)
        # the server of aries may end over it; a plan that is not the quickest is a plan, too
        with contextlib.suppress(Exception):
            for result in engine.get_solutions(problem, timeout=short):
                best = result if result.plan is not None else best
        if best is not None:
            return PlanGenerationResult(
                PlanGenerationResultStatus.SOLVED_SATISFICING, best.plan, ""
            )
    left = None if seconds is None else max(0.1, seconds - (time.monotonic() - began))
    return engine.solve(problem, timeout=left)


def _happenings(task: dict[str, Any], plan: Any, scale: int) -> list[list[float | int]]:
    """What begins and ends, in order. At one time ends come first: what overlaps there does not
    bear on each other, or the plan would be none."""
    ends = {start: end for start, _, end, _, _ in task["lasting"]}
    found: list[tuple[Fraction, int, int]] = [
        (Fraction(_ticks(left, scale), scale), 0, end) for _, end, left in task["running"]
    ]
    if hasattr(plan, "timed_actions"):
        for at, instance, lasts in plan.timed_actions:
            number, at = int(instance.action.name[1:]), at / scale
            if number in ends:
                found += [(at, 2, number), (at + lasts / scale, 0, ends[number])]
            else:
                found.append((at, 1, number))
    else:  # nothing in it lasts
        found += [(Fraction(n + 1), 1, int(a.action.name[1:])) for n, a in enumerate(plan.actions)]
    return [[math.floor(at * 1_000_000) / 1_000_000, number] for at, _, number in sorted(found)]
