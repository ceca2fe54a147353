"""Numbers that the robot measures itself take the place of those that were worked out."""

from dataclasses import replace

from tpvqa.events.decision import Decision
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Atom, State, validate
from tpvqa.pddl.arithmetic import COMPARISONS, VALUE, number
from tpvqa.pddl.numeric import numbers_of, with_values

_BELIEVED = 0.5


def measured(step: Step, verdict: Verdict) -> Verdict:
    """A verdict after an action, with the numbers that were measured then.

    Where the rest of the plan does not go with them, there is a new one.

    Args:
        step: The step, with what was sensed.
        verdict: What is decided without them.
    """
    if step.task.numeric is None or verdict.decision not in (Decision.GO_ON, Decision.REPEAT):
        return verdict
    believed = step.state if verdict.state is None else verdict.state
    state = _with_measured(step, believed)
    if state == believed:
        return verdict
    told = ", ".join(map(str, sorted(numbers_of(state) - believed)))
    on = step.index + (verdict.decision is Decision.GO_ON)
    left = validate(step.task, step.plan.actions[on:], state)
    if not left.valid:
        reason = f"{verdict.reason}; measured: {told}; {left}"
        return Verdict(Decision.REPLAN, reason, state)
    return replace(verdict, reason=f"{verdict.reason}; measured: {told}", state=state)


def is_of_number(atom: Atom) -> bool:
    """Whether an atom compares a number."""
    return atom.predicate in COMPARISONS


def _with_measured(step: Step, state: State) -> State:
    values = {
        fact.atom.arguments[:-1]: number(fact.atom.arguments[-1])
        for fact in step.sensed
        if fact.atom.predicate == VALUE and fact.probability > _BELIEVED
    }
    return with_values(state, values) if values else state
