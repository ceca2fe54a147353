"""A number that nobody can be asked about, where an action that needs it fails again and again."""

from collections.abc import Iterator

from tpvqa.events.decision import Decision
from tpvqa.monitors.measuring import is_of_number
from tpvqa.monitors.memory import FactMemory
from tpvqa.monitors.protocol import Step
from tpvqa.monitors.verdict import Verdict
from tpvqa.pddl import Literal
from tpvqa.pddl.arithmetic import VALUE
from tpvqa.pddl.conditions import supporting
from tpvqa.pddl.numeric import functions_of, numbers_of
from tpvqa.planning.propositional import propositional

AGAIN = 2
"""Repeats after which an action that fails once more is no longer bad luck."""


def doubted(step: Step, verdict: Verdict, memory: FactMemory) -> Verdict:
    """A verdict after an action that has failed again and again, for want of a number perhaps.

    An aircraft that does not take off may have no fuel, though the tank was believed full when
    nobody saw that filling it failed. Comparisons that are never asked, of numbers that are not
    measured, are then believed to be wrong by as little as possible, and there is a new plan; but
    not where there can be none.

    Args:
        step: The step.
        verdict: What is decided without this.
        memory: Corrects the state.
    """
    if verdict.decision is not Decision.REPEAT or step.attempt < AGAIN:
        return verdict
    needed = list(_unseen(step))
    state = memory.take_out(step.state, needed)
    if state == step.state or not propositional(step.task, state).in_reach:
        return verdict
    told = ", ".join(map(str, sorted(numbers_of(state) - step.state)))
    reason = f"{verdict.reason}; failed {step.attempt + 1} times, of what is never asked {told}"
    return Verdict(Decision.REPLAN, f"{reason} is believed instead", state)


def _unseen(step: Step) -> Iterator[Literal]:
    """The comparisons that an action rests on and nobody has seen to hold."""
    measured = {fact.atom.arguments[:-1] for fact in step.sensed if fact.atom.predicate == VALUE}
    for literal in supporting(step.action.precondition, step.state):
        if not is_of_number(literal.atom) or step.book.asked(literal, step.action):
            continue
        if measured.isdisjoint(functions_of(literal)):
            yield literal
