"""An engine's reply → a planner's result; every plan is replayed before it is believed."""

import time
from typing import Any

from tpvqa.pddl import State, Task, validate
from tpvqa.planning.propositional import Propositional
from tpvqa.planning.protocol import Crashed, Plan, PlanningResult, TimedOut, Unsolvable


def result_of(
    reply: dict[str, Any],
    task: Task,
    state: State,
    ground: Propositional,
    limit: float | None,
    name: str,
    start: float,
) -> PlanningResult:
    """What came of a call.

    Args:
        reply: What `ask_engine` gave; the "steps" of a plan are numbers of `ground`'s actions.
        task: The task that was to be planned.
        state: The state from which.
        ground: What the engine was given.
        limit: The time limit, in seconds.
        name: The planner's.
        start: When it was called, by `time.perf_counter`.
    """
    seconds = time.perf_counter() - start
    match reply["kind"]:
        case "plan":
            chosen = (ground.actions[number] for number in reply["steps"])
            actions = tuple(task.action(each.name, each.arguments) for each in chosen)
            replay = validate(task, actions, state)
            if not replay.valid:
                reason = f"the plan that came back does not work: {replay}"
                return Crashed(reason, name, seconds)
            return Plan(actions, sum(action.cost for action in actions), name, seconds)
        case "timeout":
            return TimedOut(limit or 0.0, name, seconds)
        case "unsolvable" if ground.whole:
            return Unsolvable(reply["reason"], name, seconds)
        case "unsolvable":
            reason = (
                "there is no plan with the things that seem to matter, and this planner does not "
                "look at the others; try fast-downward"
            )
            return Crashed(reason, name, seconds)
    return Crashed(reply["reason"], name, seconds)
