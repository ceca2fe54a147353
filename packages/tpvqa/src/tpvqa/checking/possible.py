"""What can never be: actions without a way to their preconditions, goals out of reach."""

from collections.abc import Iterator, Mapping
from itertools import combinations

from tpvqa.belief.states.mutexes import Mutexes, h2_mutexes
from tpvqa.checking.finding import Finding, Severity, named
from tpvqa.checking.idle_effects import unmet
from tpvqa.checking.never_ended import never_ended
from tpvqa.checking.places import line_of_action, line_of_goal, line_of_predicate
from tpvqa.pddl import Action, Atom, Task, literals
from tpvqa.pddl.conditions import required_of
from tpvqa.pddl.lasting import Phase
from tpvqa.pddl.schema import (
    ActionSchema,
    ConditionSchema,
    Junction,
    LiteralSchema,
    Quantified,
)
from tpvqa.planning import Plan, Planner, TimedOut, Unsolvable
from tpvqa.planning.obstacles import obstacle
from tpvqa.planning.protocol import TemporalPlanner

UNMET = "no objects meet its whole precondition, even where nothing is ever undone"


def of_actions(task: Task, undone: frozenset[str] = frozenset()) -> Iterator[Finding]:
    """Actions that can never be done, with what keeps them from it; and such as change nothing.

    Args:
        task: The task.
        undone: The predicates of facts that disturbances bring about: what needs them, and what
            comes of that, may come to be possible.
    """
    if task.left_out:
        return  # what is left out may make them possible
    undone = _following(task, undone)
    reached = {words[0] for words in task.reachable_actions}
    proved = h2_mutexes(task)
    by_name: dict[str, list[Action]] = {}
    for action in task.ground_actions():
        by_name.setdefault(action.name, []).append(action)
    for schema in task.schemas:
        why = ""
        if _unplanned(task, schema):
            continue
        if schema.name not in reached or schema.name not in by_name:
            why = _never(task, schema, undone)
            if why == UNMET and (idle := _idle(task, schema)):
                yield Finding(
                    "action-without-effect",
                    Severity.WARNING,
                    f"the action {schema.name} changes nothing in this problem: {idle}",
                    "Mend its effect; if other problems need it, leave it.",
                    named(task.domain_path),
                    line_of_action(task, schema.name),
                )
                continue
        elif all(_excluded(action, proved, undone) for action in by_name[schema.name]):
            why = _excluded(by_name[schema.name][0], proved, undone)
        if why:
            yield Finding(
                "action-never-possible",
                Severity.WARNING,
                f"the action {schema.name} can never be done in this problem: {why}",
                "Mend its precondition or the initial state; if other problems need it, leave it.",
                named(task.domain_path),
                line_of_action(task, schema.name),
            )


def _following(task: Task, undone: frozenset[str]) -> frozenset[str]:
    """Those predicates, and all that actions may bring about which need one of them."""
    while True:
        more = {
            effect.literal.predicate
            for schema in task.schemas
            if undone & set(_predicates(schema.precondition))
            for effect in schema.effects
        }
        if more <= undone:
            return undone
        undone |= more


def _unplanned(task: Task, schema: ActionSchema) -> bool:
    """Whether no plan of a planner has an action: a part of one that lasts which changes nothing,
    or takes it back."""
    phase = None if task.lasting is None else task.lasting.phase_of(schema.name)
    return phase not in (None, Phase.START, Phase.END)


def _never(task: Task, schema: ActionSchema, undone: frozenset[str]) -> str:
    """Why no ground action of a schema is reachable; empty where a disturbance may change that."""
    for parameter in schema.parameters:
        if not task.objects_by_type.get(parameter.type):
            return f"there is no object of the type {parameter.type} for {parameter.name}"
    if said := unmet(task, schema.precondition, schema.parameters, undone):
        return said
    if undone & set(_predicates(schema.precondition)):
        return ""
    return UNMET


def _idle(task: Task, schema: ActionSchema) -> str:
    """Why an action has no effect: it only ends what never holds; empty where that is not so."""
    holding = {atom.predicate for atom in task.reachable_atoms | task.init}
    ended = [effect.literal for effect in schema.effects]
    if not ended or any(each.positive or each.predicate in holding for each in ended):
        return ""
    said = " and ".join(f"({' '.join((each.predicate, *each.arguments))})" for each in ended)
    return f"it ends {said}, which never holds"


def _excluded(action: Action, proved: Mutexes, undone: frozenset[str]) -> str:
    """Why a ground action is never possible although each of its preconditions may hold."""
    needed = (literal.atom for literal in required_of(action.precondition) if literal.positive)
    atoms = [atom for atom in needed if atom.predicate not in undone]
    for atom in atoms:
        if atom in proved.never:
            return f"it needs {atom.pddl()}, which never holds"
    for one, other in combinations(atoms, 2):
        if frozenset((one, other)) in proved.pairs:
            return f"it needs {one.pddl()} and {other.pddl()}, which never hold together"
    return ""


def of_goal(task: Task, planner: Planner, timeout: float) -> Iterator[Finding]:
    """A goal that holds at first, cannot be reached, or for which no plan is found in time."""
    file, line = named(task.problem_path), line_of_goal(task)
    demanded = dict.fromkeys(each.atom for each in required_of(task.goal) if each.positive)
    for one, other in combinations(demanded, 2):
        if any({one, other} <= group.atoms for group in task.mutex_groups):
            yield Finding(
                "goal-unreachable",
                Severity.ERROR,
                f"the goal wants {one.pddl()} and {other.pddl()}, which never hold together",
                "Leave one of them out.",
                file,
                line,
            )
            return
    if not task.left_open and task.goal_holds(task.init):
        yield Finding(
            "goal-holds",
            Severity.WARNING,
            "the goal holds already: the plan is empty",
            "Mend the goal or the initial state, unless there is to be nothing to do.",
            file,
            line,
        )
        return
    if task.lasting is not None and not isinstance(planner, TemporalPlanner):
        yield Finding(
            "plan-not-sought",
            Severity.NOTE,
            f"whether there is a plan was not tried: {planner.name} does not know what lasts",
            "Run `tpvqa plan --planner up:aries` on the same files.",
            file,
            line,
        )
        return
    result = planner.plan(task, timeout=timeout)
    match result:
        case Plan():
            return
        case Unsolvable(reason):
            why = (
                obstacle(task, task.init)
                or never_ended(task, planner, timeout)
                or f"there is no plan: {reason}"
            )
            yield Finding(
                "goal-unreachable",
                Severity.ERROR,
                why,
                "Mend the goal, the initial state, or the action that is to bring it about.",
                file,
                line,
            )
        case TimedOut(limit):
            yield Finding(
                "plan-not-found",
                Severity.WARNING,
                f"no plan was found in {limit:g} s",
                "Give it more time with --timeout, or try `tpvqa plan --planner "
                "fast-downward:lama`.",
                file,
                line,
            )
        case _ if task.numeric is not None:
            yield Finding(
                "plan-not-sought",
                Severity.NOTE,
                f"whether there is a plan is not known: {result.reason}",
                "Run `tpvqa plan --planner up:aries` on the same files.",
                file,
                line,
            )
        case _:
            yield Finding(
                "planner-failed",
                Severity.ERROR,
                f"the planner failed: {result.reason}",
                "Run `tpvqa plan` on the same files.",
                file,
                line,
            )


def of_metric(task: Task) -> Iterator[Finding]:
    """A metric by which no plan is chosen."""
    if task.metric is not None:
        yield Finding(
            "metric-passed-over",
            Severity.NOTE,
            f"plans are not chosen by {task.metric}",
            "Give actions a total-cost where the price of a plan matters.",
            named(task.problem_path),
        )


def of_predicates(task: Task) -> Iterator[Finding]:
    """Predicates that are declared and play no part."""
    spoken = _spoken_of(task)
    for name in task.predicates:
        if name not in spoken:
            yield Finding(
                "predicate-unused",
                Severity.WARNING,
                f"the predicate {name} stands in no action, in no axiom and not in the goal",
                "Leave it out, or mend the name where it was meant.",
                named(task.domain_path),
                line_of_predicate(task, name),
            )


def _spoken_of(task: Task) -> set[str]:
    found = {literal.atom.predicate for literal in literals(task.goal)}
    for axiom in task.axioms:
        found |= {axiom.predicate, *_predicates(axiom.condition)}
    for schema in task.schemas:
        found.update(_predicates(schema.precondition))
        for effect in schema.effects:
            found |= {effect.literal.predicate, *_predicates(effect.condition)}
    return found


def _predicates(condition: ConditionSchema) -> Iterator[str]:
    match condition:
        case LiteralSchema():
            yield condition.predicate
        case Junction():
            for part in condition.parts:
                yield from _predicates(part)
        case Quantified():
            yield from _predicates(condition.part)


def needed_predicates(task: Task) -> Mapping[str, str]:
    """The predicates that the goal, a precondition or an effect's condition rests on, each with who
    needs it."""
    found: dict[str, str] = {}
    for literal in literals(task.goal):
        found.setdefault(literal.atom.predicate, "the goal")
    running = frozenset[str]() if task.lasting is None else task.lasting.predicates
    for schema in task.schemas:
        conditions = (effect.condition for effect in schema.effects)
        for condition in (schema.precondition, *conditions):
            for predicate in _predicates(condition):
                if predicate not in running:
                    found.setdefault(predicate, f"the action {schema.name}")
    return found


def atoms_of(task: Task, predicate: str) -> list[Atom]:
    """The atoms of a predicate that may hold."""
    return sorted(a for a in task.reachable_atoms | task.init if a.predicate == predicate)
