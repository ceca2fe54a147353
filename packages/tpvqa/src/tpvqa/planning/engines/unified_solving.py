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

COMPILERS = (
    ("DISJUNCTIVE_CONDITIONS", up.CompilationKind.DISJUNCTIVE_CONDITIONS_REMOVING),
    ("CONDITIONAL_EFFECTS", up.CompilationKind.CONDITIONAL_EFFECTS_REMOVING),
    ("NEGATIVE_CONDITIONS", up.CompilationKind.NEGATIVE_CONDITIONS_REMOVING),
)
"""What is compiled away for engines that do not know it, in this order."""

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


def problem_of(task: dict[str, Any]) -> Any:
    """A numbered task as a problem: fluents f0, f1, …, actions a0, a1, …"""
    problem = up.Problem("task")
    fluents = [up.Fluent(f"f{n}", up.BoolType()) for n in range(task["atoms"])]
    for fluent in fluents:
        problem.add_fluent(fluent, default_initial_value=False)
    for atom in task["init"]:
        problem.set_initial_value(fluents[atom], True)

    def said(condition: list[Any]) -> Any:
        head, *parts = condition
        if head == "and":
            return up.And(*map(said, parts))
        if head == "or":
            return up.Or(*map(said, parts))
        return up.FluentExp(fluents[head]) if parts[0] else up.Not(fluents[head])

    for number, (needs, effects, _) in enumerate(task["actions"]):
        action = up.InstantaneousAction(f"a{number}")
        for part in needs[1:] if needs[0] == "and" else [needs]:
            action.add_precondition(said(part))
        adding = {repr(condition) + str(atom) for condition, atom, holds in effects if holds}
        for condition, atom, holds in effects:
            if not holds and repr(condition) + str(atom) in adding:
                continue  # what is both added and deleted holds
            action.add_effect(
                fluents[atom], holds, up.TRUE() if condition == ["and"] else said(condition)
            )
        problem.add_action(action)
    problem.add_goal(said(task["goal"]))
    return problem


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
    problem = problem_of(task)
    with up.OneshotPlanner(name=name) as engine, TemporaryDirectory() as folder:
        without_spaces(engine, Path(folder))
        _measure(problem, task, engine)
        back = []
        for feature, kind in COMPILERS:
            kinds = problem.kind
            if feature in kinds.features and feature not in engine.supported_kind().features:
                with up.Compiler(problem_kind=kinds, compilation_kind=kind) as compiler:
                    compiled = compiler.compile(problem, kind)
                problem = compiled.problem
                back.append(compiled.map_back_action_instance)
        missing = problem.kind.features - engine.supported_kind().features
        if missing:
            said = ", ".join(sorted(each.lower().replace("_", " ") for each in missing))
            return {"kind": "crash", "reason": f"the engine does not know {said}"}
        result = engine.solve(problem, timeout=request["seconds"])
    plan = result.plan
    if plan is not None and result.status in MET:
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
