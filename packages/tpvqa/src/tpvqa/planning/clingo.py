"""Answer set programming as the planner: clingo over the ground task."""

import time
from importlib.util import find_spec

from tpvqa.errors import MissingExtraError, PlannerError, PluginError
from tpvqa.pddl import State, Task
from tpvqa.pddl.description import MEMORY
from tpvqa.pddl.outside.asking import ask_engine, end_engines
from tpvqa.pddl.time_limit import limit_of
from tpvqa.planning.engines.results import result_of
from tpvqa.planning.numbers import no_numbers
from tpvqa.planning.propositional import propositional
from tpvqa.planning.protocol import Crashed, Numberless, PlanningResult, Unsolvable
from tpvqa.planning.temporal import no_time
from tpvqa.plugins import PlainArguments

_MODULE = "tpvqa.planning.engines.clingo_solving"


class ClingoPlanner(PlainArguments, Numberless):
    """Plans with clingo. Safe to call from several threads.

    Its plans have the fewest steps that there are, and among those the least cost; a longer plan
    may be cheaper. That there is none is proved where the goal is out of reach even if nothing
    were ever undone, or no sequence of actions is left that comes to no state twice; where the
    longest of those is long, the time is over before that.

    Args:
        timeout: Seconds for a call; None for no limit.
        memory: What its process may hold in MiB; None for no limit.

    Raises:
        MissingExtraError: clingo is not installed.
    """

    name = "clingo"

    def __init__(self, *, timeout: float | None = 60.0, memory: int | None = MEMORY):
        if find_spec("clingo") is None:
            raise MissingExtraError("clingo", "asp", "The planner 'clingo'")
        self.timeout, self.memory = timeout, memory

    @classmethod
    def from_spec(cls, arguments: str = "") -> "ClingoPlanner":
        """Make it from `clingo`.

        Raises:
            PluginError: Anything follows.
        """
        if arguments:
            raise PluginError(f"'clingo:{arguments}' is not understood. Write clingo alone.")
        return cls()

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A shortest plan from a state (the task's initial state by default) to the task's goal.

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
        state = task.init if state is None else state
        task.check_state(state)
        if task.lasting is not None:
            return no_time(task, self.name)
        if task.numeric is not None:
            return no_numbers(task, self.name)
        try:
            ground = propositional(task, state)
        except PlannerError as error:
            return Crashed(str(error), self.name, time.perf_counter() - start)
        if not ground.in_reach and ground.whole:
            reason = "the goal is out of reach even where nothing is ever undone"
            return Unsolvable(reason, self.name, time.perf_counter() - start)
        left = None if limit is None else max(0.0, limit - (time.perf_counter() - start))
        reply = ask_engine(_MODULE, {"task": ground.numbered()}, seconds=left, memory=self.memory)
        if reply["kind"] == "unsolvable":
            reply["reason"] = (
                f"no {reply['horizon'] + 1} actions follow one another without coming to a state "
                "twice, and none of fewer reach the goal"
            )
        return result_of(reply, task, state, ground, limit, self.name, start)

    def close(self) -> None:
        """End its idle processes. Planning again starts new ones."""
        end_engines(_MODULE)
