"""Every engine of unified-planning as the planner: `up:NAME`."""

import time
from collections.abc import Sequence
from importlib.util import find_spec

from tpvqa.errors import MissingExtraError, PDDLError, PlannerError, PluginError, suggestion_or_list
from tpvqa.pddl import State, Task
from tpvqa.pddl.description import MEMORY
from tpvqa.pddl.lasting import Running
from tpvqa.pddl.outside.asking import ask_engine, end_engines
from tpvqa.pddl.outside.engines import PACKAGES, is_there
from tpvqa.pddl.time_limit import limit_of
from tpvqa.planning.engines.results import result_of
from tpvqa.planning.propositional import propositional
from tpvqa.planning.protocol import Crashed, PlanningResult, Unfit, Unsolvable
from tpvqa.planning.temporal import Schedule
from tpvqa.plugins import PlainArguments

_MODULE = "tpvqa.planning.engines.unified_solving"


class UnifiedEngine(PlainArguments):
    """Plans with an engine of unified-planning (Micheli et al. 2025), in a process of its own.

    The engine is given the ground task from the state at hand; disjunctions, conditional effects
    and negative conditions are compiled away where it does not know them. What it hands back is
    replayed; a crash, a hang or too much memory ends the engine alone. Safe to call from several
    threads.

    Whether plans are of least cost, and whether "no plan" is proved, is the engine's business: what
    it does not prove is not called unsolvable.

    Args:
        engine: The engine, as unified-planning calls it.
        timeout: Seconds for a call; None for no limit.
        memory: What the engine and all that it starts may hold in MiB; None for no limit.

    Raises:
        MissingExtraError: unified-planning is not installed.
        PluginError: The engine is not installed, or there is none of that name.
    """

    def __init__(self, engine: str, *, timeout: float | None = 60.0, memory: int | None = MEMORY):
        if find_spec("unified_planning") is None:
            raise MissingExtraError("unified-planning", "up", f"The planner 'up:{engine}'")
        _check(engine)
        self.engine, self.timeout, self.memory = engine, timeout, memory

    @classmethod
    def from_spec(cls, arguments: str = "") -> "UnifiedEngine":
        """Make it from `up:NAME`.

        Raises:
            MissingExtraError: unified-planning is not installed.
            PluginError: There is no such engine, or none is named.
        """
        if not arguments:
            raise PluginError(f"Write up:NAME, NAME being one of {', '.join(sorted(PACKAGES))}.")
        return cls(arguments)

    @property
    def name(self) -> str:
        """The specification it can be made from again."""
        return f"up:{self.engine}"

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state (the task's initial state by default) to the task's goal.

        Args:
            task: The task.
            state: The atoms that hold; all others do not.
            timeout: Seconds, `math.inf` for no limit; None for the planner's own limit.

        Raises:
            PDDLError: The state speaks of unknown predicates or objects, or of ill-fitting types.
            PlannerError: The time limit is negative or not a number.
        """
        start = time.perf_counter()
        limit = limit_of(self.timeout if timeout is None else timeout)
        state = task.init if state is None else state
        task.check_state(state)
        if task.lasting is not None:
            return self.plan_meanwhile(task, state, (), timeout=timeout)
        try:
            ground = propositional(task, state)
        except PlannerError as error:
            return Crashed(str(error), self.name, time.perf_counter() - start)
        if not ground.in_reach and ground.whole:
            reason = "the goal is out of reach even where nothing is ever undone"
            return Unsolvable(reason, self.name, time.perf_counter() - start)
        if ground.rules:
            reason = (
                "engines of unified-planning are not given derived predicates "
                f"({', '.join(sorted({rule.head.predicate for rule in ground.rules}))}); "
                "fast-downward and clingo know them"
            )
            return Unfit(reason, self.name, time.perf_counter() - start)
        left = None if limit is None else max(0.0, limit - (time.perf_counter() - start))
        request = {"do": "plan", "engine": self.engine, "task": ground.numbered()}
        reply = ask_engine(_MODULE, request, seconds=left, memory=self.memory)
        return result_of(reply, task, state, ground, limit, self.name, start)

    def plan_meanwhile(
        self,
        task: Task,
        state: State,
        running: Sequence[Running],
        *,
        timeout: float | None = None,
    ) -> PlanningResult:
        """A plan of a task whose actions last, from a state in which some are running.

        Args:
            task: The task; it has durative actions.
            state: The atoms that hold.
            running: What is running, and how much longer.
            timeout: As of `plan`.
        """
        start = time.perf_counter()
        limit = limit_of(self.timeout if timeout is None else timeout)
        try:
            schedule = Schedule(task, state, running)
            request = {"do": "schedule", "engine": self.engine, "task": schedule.request()}
        except (PDDLError, PlannerError) as error:
            return Crashed(str(error), self.name, time.perf_counter() - start)
        ground = schedule.ground
        if schedule.out_of_reach is not None:
            return Crashed(schedule.out_of_reach, self.name, time.perf_counter() - start)
        if not ground.in_reach and ground.whole:
            reason = "the goal is out of reach even where nothing is ever undone"
            return Unsolvable(reason, self.name, time.perf_counter() - start)
        if ground.rules:
            reason = "durative actions are not planned together with derived predicates"
            return Unfit(reason, self.name, time.perf_counter() - start)
        left = None if limit is None else max(0.0, limit - (time.perf_counter() - start))
        reply = ask_engine(_MODULE, request, seconds=left, memory=self.memory)
        return schedule.result(reply, limit, self.name, start)

    def close(self) -> None:
        """End its idle processes. Planning again starts new ones."""
        end_engines(_MODULE)


def _check(engine: str) -> None:
    """See that an engine is there; unified-planning itself is asked about those it may know."""
    package = PACKAGES.get(engine)
    if package is not None:
        if not is_there(engine):
            raise PluginError(
                f"The engine {engine!r} of unified-planning is not installed. "
                f"Install it: pip install {package}"
            )
        return
    reply = ask_engine(_MODULE, {"do": "list"}, seconds=60)
    known = {*PACKAGES, *reply.get("names", ())}
    if engine not in reply.get("names", ()):
        raise PluginError(
            f"There is no engine {engine!r} of unified-planning" + suggestion_or_list(engine, known)
        )
