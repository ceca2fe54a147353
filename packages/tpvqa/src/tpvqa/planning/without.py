"""Planning as if some actions could not be done, for any planner: by what the task says."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import lru_cache

from tpvqa.pddl import Action, Atom, State, Task, task_from_text
from tpvqa.planning.protocol import Plan, Planner, PlanningResult
from tpvqa.planning.text import end_of, uncommented


def plan_without(
    planner: Planner,
    task: Task,
    state: State,
    actions: Iterable[Action],
    *,
    timeout: float | None = None,
) -> PlanningResult:
    """A plan from a state in which some ground actions do not occur.

    Args:
        planner: Any planner.
        task: The task.
        state: The atoms that hold.
        actions: What must not be in the plan.
        timeout: Seconds; None for the planner's default.

    Raises:
        PlannerError: The task could not be grounded.
    """
    barring, barred = _barring(task, frozenset(actions))
    result = planner.plan(barring, state | barred, timeout=timeout)
    if not isinstance(result, Plan):
        return result
    own = (task.action(action.name, action.arguments) for action in result.actions)
    return replace(result, actions=tuple(own))


@lru_cache(maxsize=16)
def _barring(task: Task, actions: frozenset[Action]) -> tuple[Task, State]:
    """The task with a static fact against each of some actions, and these facts."""
    names = {action.name for action in actions}
    predicates = {name: _free(f"not-{name}", task.predicates) for name in names}
    domain = uncommented(task.domain_text)
    for schema in task.schemas:
        if schema.name in names:
            variables = " ".join(part.name for part in schema.parameters)
            fact = f"({predicates[schema.name]} {variables})"
            domain = _declared(_needing(domain, schema.name, f"(not {fact})"), fact)
    barred = frozenset(Atom(predicates[each.name], each.arguments) for each in actions)
    said = " ".join(atom.pddl() for atom in sorted(barred))
    problem = uncommented(task.problem_text)
    problem = re.sub(r"\(\s*:init\b", lambda init: f"{init[0]} {said}", problem, flags=re.I)
    return task_from_text(domain, problem), barred


def _free(name: str, taken: Mapping[str, object]) -> str:
    while name in taken:
        name += "-"
    return name


def _declared(domain: str, fact: str) -> str:
    return re.sub(
        r"\(\s*:predicates\b", lambda begin: f"{begin[0]} {fact}", domain, count=1, flags=re.I
    )


def _needing(domain: str, name: str, condition: str) -> str:
    """A domain in which an action needs something more."""
    begin = re.search(rf"\(\s*:action\s+{re.escape(name)}(?=[\s()])", domain, re.I)
    assert begin is not None  # it was read from there
    body = domain[begin.start() : end_of(domain, begin.start())]
    needs = re.search(r":precondition\s*(?=\()", body, re.I)
    if needs is None:
        place = re.search(r":effect\b", body, re.I)
        assert place is not None
        longer = f"{body[: place.start()]}:precondition {condition} {body[place.start() :]}"
    else:
        end = end_of(body, needs.end())
        before = body[needs.end() : end]
        both = condition if not before.strip("() \t\r\n") else f"(and {condition} {before})"
        longer = body[: needs.end()] + both + body[end:]
    return domain[: begin.start()] + longer + domain[begin.start() + len(body) :]
