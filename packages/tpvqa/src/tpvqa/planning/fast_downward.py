"""Fast Downward as the planner: replans on kept grounding, in worker processes."""

import time
from typing import Any

from tpvqa.errors import PDDLError, PlannerError
from tpvqa.pddl import State, Task, literals, validate
from tpvqa.pddl.loading import to_lists
from tpvqa.pddl.processes import WORKERS, WorkerTimedOut, ask_worker
from tpvqa.pddl.time_limit import limit_of
from tpvqa.planning.obstacles import obstacle
from tpvqa.planning.protocol import Crashed, Plan, PlanningResult, TimedOut, Unsolvable

SATISFICING = "let(h,ff(),lazy_greedy([h],preferred=[h]))"
OPTIMAL = "astar(lmcut())"
OPTIMAL_GENERAL = "astar(hmax())"  # lmcut knows neither axioms nor conditional effects

_GRACE = 1.0  # seconds that the worker gets to say itself that the time is over


class FastDownward:
    """Plans with Fast Downward (Helmert 2006). Safe to call from several threads.

    The first plan of a task grounds it; later ones only rewrite the initial state, wherever that
    is sound (see `tpvqa.pddl.worker.grounding`), and take a few milliseconds.

    Args:
        optimal: Seek a plan of least cost (A* with LM-cut, or with hmax where the task has axioms
            or conditional effects) instead of any plan (lazy greedy search with FF).
        timeout: Seconds for a call; None for no limit.
        memory: The limit of the search's memory in MiB; None for none.
    """

    def __init__(
        self, *, optimal: bool = False, timeout: float | None = 60.0, memory: int | None = 4096
    ):
        self.optimal, self.timeout, self.memory = optimal, timeout, memory
        self._searches = (
            {"simple": OPTIMAL, "other": OPTIMAL_GENERAL}
            if optimal
            else {"simple": SATISFICING, "other": SATISFICING}
        )

    @property
    def name(self) -> str:
        """What the log calls it."""
        return "fast-downward-optimal" if self.optimal else "fast-downward"

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state (the task's initial state by default) to the task's goal.

        Args:
            task: The task.
            state: The atoms that hold; all others do not. Derived atoms are ignored.
            timeout: Seconds, `math.inf` for no limit; None for the planner's own limit.

        Raises:
            PDDLError: The state speaks of unknown predicates or objects, or of ill-fitting types.
            PlannerError: The time limit is negative or not a number.
        """
        start = time.perf_counter()
        limit = limit_of(self.timeout if timeout is None else timeout)
        if state is None:
            state = task.init
        else:
            task.check_state(state)
        request = {
            "do": "plan",
            "state": to_lists(state),
            "searches": self._searches,
            "seconds": limit,
            "memory": self.memory,
        }
        try:
            reply = ask_worker(
                request,
                key=task.key,
                domain=task.domain_text,
                problem=task.problem_text,
                seconds=None if limit is None else limit + _GRACE,
            )
        except WorkerTimedOut:
            reply = {"outcome": {"kind": "timeout"}}
        except PlannerError as error:
            reply = {"outcome": {"kind": "crash", "reason": str(error)}}
        return self._result(task, state, reply, limit, start)

    def _result(
        self, task: Task, state: State, reply: dict[str, Any], limit: float | None, start: float
    ) -> PlanningResult:
        if "error" in reply:
            raise PDDLError(reply["error"][0], line=reply["error"][2])
        outcome = reply["outcome"]
        if outcome["kind"] == "plan":
            actions = tuple(task.action(words[0], words[1:]) for words in outcome["steps"])
            cost = sum(action.cost for action in actions)
            replay = validate(task, actions, state)
            if not replay.valid:
                reason = f"the plan that came back does not work: {replay}"
                return Crashed(reason, self.name, time.perf_counter() - start)
            return Plan(actions, cost, self.name, time.perf_counter() - start)
        seconds = time.perf_counter() - start
        if outcome["kind"] == "timeout":
            return TimedOut(limit or 0.0, self.name, seconds)
        if outcome["kind"] == "unsolvable":
            return Unsolvable(outcome["reason"] + _hint(task, state), self.name, seconds)
        return Crashed(outcome["reason"], self.name, seconds)

    def close(self) -> None:
        """End the idle worker processes. Planning again starts new ones."""
        WORKERS.close()


def _hint(task: Task, state: State) -> str:
    """What may be wrong with a goal that cannot be reached."""
    for literal in literals(task.goal):
        try:
            task.check_atom(literal.atom)
        except PDDLError as error:
            return f". In the goal, {error}"
    found = obstacle(task, state)
    return found and f": {found}"
