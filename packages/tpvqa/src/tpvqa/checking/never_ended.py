"""Why there is no plan: the goal wants a fact not to hold, and no action ends it."""

from tpvqa.pddl import Atom, State, Task, holds
from tpvqa.pddl.conditions import required_of
from tpvqa.planning import Plan, Planner
from tpvqa.planning.towards import plan_towards


def never_ended(task: Task, planner: Planner, timeout: float) -> str:
    """What the goal wants to have ended, in words; empty where that is not what is wrong.

    Args:
        task: A task without a plan.
        planner: Says how the rest of the goal would be reached.
        timeout: Seconds for that.
    """
    lasting = frozenset[Atom]() if task.left_out else _lasting(task)
    if held := sorted(lasting & task.init):
        return f"the goal wants (not {held[0].pddl()}), which holds, and no action ends it"
    if not lasting:
        return ""
    state = _reached(task, planner, timeout)
    begun = sorted(lasting & state)
    if not begun or not holds(task.goal, task.extend(state) - lasting):
        return ""
    facts = " or ".join(atom.pddl() for atom in begun)
    return (
        f"the goal wants (not {begun[0].pddl()}), but every way to the rest of it brings about "
        f"{facts}, which no action ends"
    )


def _lasting(task: Task) -> frozenset[Atom]:
    """What the goal wants not to hold, and no action ends."""
    effects = (each.literal for action in task.ground_actions() for each in action.effects)
    ended = {each.atom for each in effects if not each.positive}
    unwanted = {each.atom for each in required_of(task.goal) if not each.positive}
    stated = task.predicates.keys() - task.derived
    return frozenset(each for each in unwanted - ended if each.predicate in stated)


def _reached(task: Task, planner: Planner, timeout: float) -> State:
    """Where a plan leads to what the goal wants to hold; nowhere without one."""
    wanted = frozenset(each.atom for each in required_of(task.goal) if each.positive)
    result = plan_towards(planner, task, task.init, wanted, timeout=timeout)
    state = task.init
    for action in result.actions if isinstance(result, Plan) else ():
        state = task.apply(state, action)
    return state
