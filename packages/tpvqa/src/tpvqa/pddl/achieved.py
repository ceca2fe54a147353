"""Whether an action has nothing left to do."""

from tpvqa.pddl.arithmetic import VALUE
from tpvqa.pddl.atoms import State
from tpvqa.pddl.ground import Action
from tpvqa.pddl.task import Task


def achieved(task: Task, state: State, action: Action) -> bool:
    """Whether all effects of an action hold already.

    What it adds to numbers or takes from them leaves no trace, so that its facts and what it sets
    numbers to tell; an action that only adds is never achieved.

    Args:
        task: The task.
        state: The state.
        action: The action.
    """
    after = task.apply(state, action)
    if not action.changes or not action.effects:
        return after == state
    relative = {each.function for each in action.changes if each.kind != "assign"}
    return all(
        atom.predicate == VALUE and atom.arguments[:-1] in relative for atom in state ^ after
    )
