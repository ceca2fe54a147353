"""What becomes of numbers where facts change by themselves as some action changes them."""

from fractions import Fraction

from tpvqa.pddl.arithmetic import COMPARISONS, evaluated, values_in
from tpvqa.pddl.atoms import State
from tpvqa.pddl.conditions import holds, supporting
from tpvqa.pddl.ground import Action
from tpvqa.pddl.numeric import numbers_of, with_values
from tpvqa.pddl.task import Task


def numbers_likewise(task: Task, before: State, after: State) -> State | None:
    """The numbers with which some facts go that nobody changed on purpose.

    Where a passenger is no longer aboard, there is one fewer, as after the action by which they
    leave; where the aircraft is back where it came from, it has flown back. Where numbers let no
    action do that, what the one that brought the facts about has added is taken away again; what it
    has used up is gone.

    Args:
        task: The task.
        before: What held.
        after: What holds now; numbers do not count.

    Returns:
        The state with these numbers; None where no action tells of any.
    """
    facts, changing = after - numbers_of(after), [a for a in task.ground_actions() if a.changes]
    for action in changing:
        if _numbers_allow(action, before):
            found = task.apply(before, action)
            if found - numbers_of(found) == facts:
                return with_values(after, values_in(found))
    gone, back = before - numbers_of(before) - facts, facts - before
    for action in changing:
        effects = {effect.literal for effect in action.effects}
        added = {each.atom for each in effects if each.positive}
        deleted = {each.atom for each in effects if not each.positive}
        if gone <= added and back and back <= deleted:
            return with_values(after, _without_gains(action, before))
    return None


def _numbers_allow(action: Action, state: State) -> bool:
    """Whether an action could be taken as far as numbers go."""
    return all(
        literal.holds(state)
        for literal in supporting(action.precondition, state)
        if literal.atom.predicate in COMPARISONS
    )


def _without_gains(action: Action, state: State) -> dict[tuple[str, ...], Fraction]:
    """The numbers without what an action has added to them."""
    values = dict(values_in(state))
    for change in action.changes:
        by = evaluated(change.by, values)
        if change.kind == "increase" and by is not None and holds(change.condition, state):
            values[change.function] -= by
    return values
