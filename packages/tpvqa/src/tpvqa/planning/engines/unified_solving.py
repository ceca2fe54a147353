"""An engine of unified-planning, given a numbered task as a `Problem` without variables."""

import warnings
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from unified_planning import shortcuts as up
from unified_planning.engines import OptimalityGuarantee, PlanGenerationResultStatus
from unified_planning.environment import get_environment
from unified_planning.plans import PlanKind

from tpvqa.pddl.outside.serving import Serving
from tpvqa.planning.engines.numbered import Numbered, compiled_for

MET = {PlanGenerationResultStatus.SOLVED_SATISFICING, PlanGenerationResultStatus.SOLVED_OPTIMALLY}
WHY = {
    PlanGenerationResultStatus.UNSOLVABLE_INCOMPLETELY: "it found no plan, and no proof that "
    "there is none",
    PlanGenerationResultStatus.INTERNAL_ERROR: "it failed with an error of its own",
    PlanGenerationResultStatus.UNSUPPORTED_PROBLEM: "it does not take this problem",
    PlanGenerationResultStatus.INTERMEDIATE: "it ended before its search did",
}


def engines() -> list[str]:
    """The engines that are installed and plan in one go."""
    factory = get_environment().factory
    return [
        name
        for name in factory.engines
        if "[" not in name and factory.engine(name).is_oneshot_planner()
    ]


def without_spaces(engine: Any, folder: Path) -> None:
    """Aries takes its program's path apart at every space."""
    program = getattr(engine, "_executable", None)
    if isinstance(program, str) and " " in program and " " not in str(folder):
        link = folder / Path(program).name
        link.symlink_to(program)
        engine._executable = str(link)


def solve(request: dict[str, Any]) -> dict[str, Any]:
    """Let an engine plan."""
    task, name = request["task"], request["engine"]
    if name not in get_environment().factory.engines:
        reason = "unified-planning cannot load this engine; importing its package says why"
        return {"kind": "crash", "reason": reason}
    numbered = Numbered(task)
    for number in range(len(task["actions"])):
        numbered.add_instantaneous(number)
    problem = numbered.problem
    with up.OneshotPlanner(name=name) as engine, TemporaryDirectory() as folder:
        without_spaces(engine, Path(folder))
        _measure(problem, task, engine)
        problem, back = compiled_for(engine, problem)
        missing = problem.kind.features - engine.supported_kind().features
        if missing:
            said = ", ".join(sorted(each.lower().replace("_", " ") for each in missing))
            return {"kind": "crash", "reason": f"the engine does not know {said}"}
        result = engine.solve(problem, timeout=request["seconds"])
    plan = result.plan
    if plan is not None and result.status in MET:
        if plan.kind == PlanKind.TIME_TRIGGERED_PLAN and not plan.timed_actions:
            return {"kind": "plan", "steps": []}  # as aries says that nothing is to be done
        if not hasattr(plan, "actions"):  # partly ordered, or with times
            plan = plan.convert_to(PlanKind.SEQUENTIAL_PLAN, problem)
        for convert in reversed(back):
            plan = plan.replace_action_instances(convert)
        return {"kind": "plan", "steps": [int(each.action.name[1:]) for each in plan.actions]}
    if result.status == PlanGenerationResultStatus.UNSOLVABLE_PROVEN:
        return {"kind": "unsolvable", "reason": "the engine proved it"}
    if result.status == PlanGenerationResultStatus.TIMEOUT:
        return {"kind": "timeout"}
    if result.status == PlanGenerationResultStatus.MEMOUT:
        return {"kind": "memory"}
    logged = [" ".join(each.message.split()) for each in result.log_messages or ()]
    told = f" ({logged[-1][-200:]})" if logged and logged[-1] else ""
    return {"kind": "crash", "reason": WHY.get(result.status, str(result.status)) + told}


def _measure(problem: Any, task: dict[str, Any], engine: Any) -> None:
    """State what is to be small, as far as the engine understands it."""
    known = engine.supported_kind().features
    costs = [cost for _, _, cost in task["actions"]]
    if len(set(costs)) > 1 and {"ACTIONS_COST", "INT_NUMBERS_IN_ACTIONS_COST"} <= known:
        by_action = {problem.action(f"a{n}"): up.Int(cost) for n, cost in enumerate(costs)}
        problem.add_quality_metric(up.MinimizeActionCosts(by_action))
    elif engine.satisfies(OptimalityGuarantee.SOLVED_OPTIMALLY) and "PLAN_LENGTH" in known:
        problem.add_quality_metric(up.MinimizeSequentialPlanLength())


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """What a request asks for: the engines, or a plan."""
    match request["do"]:
        case "list":
            return {"kind": "engines", "names": engines()}
        case "schedule":
            from tpvqa.planning.engines import temporal_solving

            return temporal_solving.solve(request)
    return solve(request)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    get_environment().credits_stream = None
    Serving(answer).run()
