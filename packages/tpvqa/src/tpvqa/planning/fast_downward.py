"""Fast Downward as the planner: replans on kept grounding, in worker processes."""

import re
import time
from typing import Any

from tpvqa.errors import PDDLError, PlannerError, PluginError, suggestion
from tpvqa.pddl import State, Task, literals, validate
from tpvqa.pddl.description import MEMORY, to_lists
from tpvqa.pddl.processes import WORKERS, WorkerTimedOut, ask_worker
from tpvqa.pddl.time_limit import limit_of
from tpvqa.pddl.validation import Validation
from tpvqa.planning.numbers import no_numbers
from tpvqa.planning.obstacles import obstacle
from tpvqa.planning.protocol import (
    Crashed,
    Numberless,
    Plan,
    PlanningResult,
    TimedOut,
    Unsolvable,
)
from tpvqa.planning.temporal import no_time
from tpvqa.plugins import PlainArguments

SEARCHES = ("optimal", "lama", "anytime")
"""What can be asked for beside the default."""

_FF = "let(h,ff(),lazy_greedy([h],preferred=[h]))"
# LAMA's first search (Richter and Westphal 2010), but that FF counts costs, too. Landmarks count
# steps: where both counted costs, it found no plan in time for some tasks.
_BOTH = (
    "let(s,eval_modify_costs(landmark_sum(lm_reasonable_orders_hps(lm_rhw()),pref=false),"
    "cost_type=one),let(h,eval_modify_costs(ff(),cost_type=plusone),%s))"
)
_GREEDY = "lazy_greedy([h,s],preferred=[h,s],reopen_closed=%s)"
_FF_AND_LANDMARKS = _BOTH % (_GREEDY % "false")
# Its later searches: each for less cost than the plan that is there. As they come back to states
# that are reached at less cost, one that ends by itself proves that there is no cheaper plan.
_BETTER = (
    _BOTH % (_GREEDY % "true,bound={bound}"),
    *(
        _BOTH % f"lazy_wastar([h,s],preferred=[h,s],w={weight},bound={{bound}})"
        for weight in (5, 3, 2, 1)
    ),
)
IMPROVING = 5.0
"""Seconds that "anytime" gives to better plans, where it is not told otherwise."""
_LMCUT = "astar(lmcut())"
_HMAX = "astar(hmax())"

_TIMED = re.compile(r"anytime:([0-9]{1,6}(?:\.[0-9]{1,6})?)")

_EFFORTS = 2
"""The number of the last effort of `tpvqa.pddl.worker.relevance`."""
_BLAMED = 12
"""Of more objects that a plan failed at it is not said that they matter."""
_GRACE = 1.0  # seconds that the worker gets to say itself that the time is over


class FastDownward(PlainArguments, Numberless):
    """Plans with Fast Downward (Helmert 2006). Safe to call from several threads.

    The first plan of a task grounds it; later ones only rewrite the initial state, wherever that
    is sound (see `tpvqa.pddl.worker.grounding`), and take a few milliseconds.

    Where the problem asks for plans of small cost, costs count in every search, though only
    "optimal" proves that none is smaller.

    Args:
        search: "optimal" for a plan of least cost (A* with LM-cut, or with hmax where the task has
            axioms or conditional effects); "lama" for lazy greedy search with FF and landmarks,
            which finds plans in some large tasks where FF alone finds none; "anytime" for plans
            that get better until `improving` is over or none is. By default lazy greedy search with
            FF where every action costs 1, and where that finds nothing in its share of the time (a
            tenth) as "lama" for half of what is left, then FF again; else as "lama" at once.
        timeout: Seconds for a call; None for no limit.
        memory: The limit of the search's memory in MiB; None for none.
        grounding_memory: The same of grounding's, see also `load_task`.
        improving: Seconds that "anytime" gives to better plans once it has one.

    Raises:
        PluginError: There is no such search.

    Example:
        >>> FastDownward.from_spec("optimal").name
        'fast-downward:optimal'
    """

    def __init__(
        self,
        *,
        search: str | None = None,
        timeout: float | None = 60.0,
        memory: int | None = MEMORY,
        grounding_memory: int | None = MEMORY,
        improving: float = IMPROVING,
    ):
        if search is not None and search not in SEARCHES:
            raise PluginError(
                f"'fast-downward:{search}' is not understood{suggestion(search, SEARCHES)} Write "
                f"fast-downward, or {' or '.join(f'fast-downward:{each}' for each in SEARCHES)} "
                "(or fast-downward:anytime:SECONDS)."
            )
        self.search, self.timeout, self.memory = search, timeout, memory
        self.grounding_memory, self.improving = grounding_memory, improving

    @classmethod
    def from_spec(cls, arguments: str = "") -> "FastDownward":
        """Make it from `fast-downward`, `fast-downward:optimal`, `fast-downward:lama`,
        `fast-downward:anytime` or `fast-downward:anytime:SECONDS`.

        Raises:
            PluginError: There is no such search.
        """
        timed = _TIMED.fullmatch(arguments)
        if timed is None:
            return cls(search=arguments or None)
        return cls(search="anytime", improving=float(timed[1]))

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        if self.search == "anytime" and self.improving != IMPROVING:
            return f"fast-downward:anytime:{self.improving:g}"
        return "fast-downward" if self.search is None else f"fast-downward:{self.search}"

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
        if task.lasting is not None:
            return no_time(task, self.name)
        if task.numeric is not None:
            return no_numbers(task, self.name)
        leaving: dict[str, Any] | None = None
        if self.search != "optimal":
            leaving = {"keep": [], "effort": 0}
        while True:
            left = None if limit is None else max(0.0, limit - (time.perf_counter() - start))
            reply = self._reply(task, state, left, leaving)
            result = self._result(task, state, reply, limit, start)
            if not isinstance(result, Validation):
                return result
            if leaving is None or not reply["outcome"].get("left_out"):
                reason = f"the plan that came back does not work: {result}"
                return Crashed(reason, self.name, time.perf_counter() - start)
            leaving = _leaving_less(leaving, result)

    def _reply(
        self, task: Task, state: State, seconds: float | None, leaving: dict[str, Any] | None
    ) -> dict[str, Any]:
        """What a worker says, `leaving` being what it may leave out of a large task."""
        request = {
            "do": "plan",
            "state": to_lists(state),
            "searches": _searches(self.search, task, self.improving),
            "seconds": seconds,
            "memory": self.memory,
            "grounding_memory": self.grounding_memory,
            "leaving": leaving,
        }
        try:
            return ask_worker(
                request,
                key=task.key,
                domain=task.domain_text,
                problem=task.problem_text,
                seconds=None if seconds is None else seconds + _GRACE,
            )
        except WorkerTimedOut:
            return {"outcome": {"kind": "timeout"}}
        except PlannerError as error:
            return {"outcome": {"kind": "crash", "reason": str(error)}}

    def _result(
        self, task: Task, state: State, reply: dict[str, Any], limit: float | None, start: float
    ) -> PlanningResult | Validation:
        """What came of a call, or how a plan fails in the task."""
        if "error" in reply:
            raise PDDLError(reply["error"][0], line=reply["error"][2])
        outcome = reply["outcome"]
        if outcome["kind"] == "plan":
            actions = tuple(task.action(words[0], words[1:]) for words in outcome["steps"])
            cost = sum(action.cost for action in actions)
            replay = validate(task, actions, state)
            if not replay.valid:
                return replay
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


def _searches(search: str | None, task: Task, improving: float) -> dict[str, Any]:
    """Searches for tasks that have neither axioms nor conditional effects, and for others.

    See `tpvqa.pddl.worker.seeking` for what else stands there.
    """
    if search == "optimal":
        return {"simple": _LMCUT, "other": _HMAX}  # LM-cut knows neither
    unit_cost = all(schema.cost == 1 for schema in task.schemas)
    if search == "lama" or (not unit_cost and search is None):
        return {"simple": _FF_AND_LANDMARKS, "other": _FF_AND_LANDMARKS}
    quick = {"simple": _FF, "other": _FF, "quick": True, "then": _FF_AND_LANDMARKS}
    return quick if search is None else {**quick, "better": _BETTER, "improve": improving}


def _leaving_less(leaving: dict[str, Any], replay: Validation) -> dict[str, Any] | None:
    """What may be left out after a plan that fails in the whole task; None for nothing.

    What the plan failed at is kept, if that is little and new; else more is kept from the start.
    """
    named = {name for literal in replay.failed for name in literal.atom.arguments}
    new = named.difference(leaving["keep"])
    if new and len(named) <= _BLAMED:
        return {**leaving, "keep": sorted(named.union(leaving["keep"]))}
    if leaving["effort"] < _EFFORTS:
        return {**leaving, "effort": leaving["effort"] + 1}
    return None


def _hint(task: Task, state: State) -> str:
    """What may be wrong with a goal that cannot be reached."""
    for literal in literals(task.goal):
        try:
            task.check_atom(literal.atom)
        except PDDLError as error:
            return f". In the goal, {error}"
    found = obstacle(task, state)
    return found and f": {found}"
