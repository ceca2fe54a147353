"""Tasks whose actions last, as an engine is given them, and what comes back as a `Plan`."""

import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby, permutations
from typing import Any

from tpvqa.errors import PDDLError, PlannerError
from tpvqa.pddl import Action, Conjunction, Literal, State, Task, holds
from tpvqa.pddl.lasting import Phase, Running, without
from tpvqa.pddl.outside.engines import taken
from tpvqa.planning.propositional import Propositional, propositional
from tpvqa.planning.protocol import Crashed, Plan, PlanningResult, TimedOut, Unfit, Unsolvable

_MOST_AT_ONCE = 6
_MOST_TRIED = 20
SOON = 0.01
"""The time that is left to an action whose time is over and that has not been ended yet."""


def no_time(task: Task, planner: str) -> Crashed:
    """Why a planner that knows no time does not plan a task whose actions last."""
    names = "" if task.lasting is None else ", ".join(sorted(task.lasting.variables))
    reason = f"actions last here ({names}), which {planner} does not know; {taken('time')}"
    return Unfit(reason, planner, 0.0)


class Schedule:
    """A task with durative actions from a state in which some may be running.

    Args:
        task: The task.
        state: The atoms that hold.
        running: What is running, and how much longer. Of an action that runs in the state and is
            not named, its least duration is left.

    Raises:
        PDDLError: The state speaks of unknown things, or a duration of no number.
        PlannerError: The task could not be grounded.
    """

    def __init__(self, task: Task, state: State, running: Sequence[Running] = ()):
        assert task.lasting is not None
        self.task, self.state, self._lasting = task, state, task.lasting
        left = {each.action: max(each.left, SOON) for each in running}
        self.running = tuple(
            Running(action, left.get(action) or self._lasting.duration(action)[0])
            for action in self._lasting.under_way(task, state)
        )
        self._untimed: dict[Action, str] = {}
        ground = propositional(task, state, may=self._may)
        ends = [Literal(self._lasting.running(each.action), False) for each in self.running]
        self.ground: Propositional = replace(
            ground,
            goal=Conjunction((ground.goal, *ends)),
            actions=tuple(map(self._stripped, ground.actions)),
        )

    def _own(self, number: int) -> Action:
        """An action as its author wrote it."""
        action = self.ground.actions[number]
        return self.task.action(action.name, action.arguments)

    def _stripped(self, action: Action) -> Action:
        """A part of a durative action without what holds anyhow where it comes."""
        if self._lasting.phase_of(action.name) in (Phase.WHILE, Phase.END):
            running = self._lasting.running(action)
            return replace(action, precondition=without(action.precondition, running))
        return action

    def request(self) -> dict[str, Any]:
        """The task in lists and numbers: `Propositional.numbered`, and beside it

        - "instant": the numbers of the actions that take no time,
        - "lasting": those that do, as the numbers of their start, of what must hold meanwhile and
          of their end, and least and greatest duration,
        - "running": the numbers of the last two of what is running, and the time that is left,
        - "quickest": whether the quickest plan is asked for.
        """
        number = {(a.name, a.arguments): n for n, a in enumerate(self.ground.actions)}
        phase_of = self._lasting.phase_of

        def parts(action: Action) -> list[int | None]:
            name = self._lasting.name_of(action.name)
            wanted = (Phase.WHILE, Phase.END)
            return [number.get((f"{phase}-{name}", action.arguments)) for phase in wanted]

        running = []
        for each in self.running:
            if None in parts(each.action):
                raise PlannerError(f"{each.action} is running, and can never end from here")
            running.append([*parts(each.action), each.left])
        return {
            **self.ground.numbered(),
            "instant": [n for (name, _), n in number.items() if phase_of(name) is None],
            "lasting": [
                [start, *parts(action), *self._lasting.duration(action)]
                for start, action in enumerate(self.ground.actions)
                if phase_of(action.name) is Phase.START and None not in parts(action)
            ],
            "running": running,
            "quickest": self._lasting.quickest,
        }

    def _may(self, action: Action) -> bool:
        """Whether an action that is to be begun has a duration.

        Some arguments have none, as the way from a place to itself: with those it is not begun.
        """
        if self._lasting.phase_of(action.name) is Phase.START:
            try:
                self._lasting.duration(action)
            except PDDLError as error:
                self._untimed[action] = str(error)
                return False
        return True

    @property
    def out_of_reach(self) -> str | None:
        """What keeps the goal out of reach: actions that have no duration; None where nothing, or
        where it is not reached with them either."""
        if self.ground.in_reach or not self._untimed:
            return None
        if not propositional(self.task, self.state).in_reach:
            return None
        reason = self._why_untimed(
            lambda each: (
                propositional(
                    self.task, self.state, may=lambda one: one == each or one not in self._untimed
                ).in_reach
            )
        )
        return f"the goal is out of reach without what has no duration: {reason}"

    def _why_untimed(self, would_do: Callable[[Action], bool]) -> str:
        """Why the first action has no duration that would do; of those that speak of a thing twice,
        as a way from a place to itself, last."""
        first = sorted(self._untimed, key=lambda each: len(each.arguments) - len({*each.arguments}))
        found = next((each for each in first[:_MOST_TRIED] if would_do(each)), first[0])
        return self._untimed[found]

    def result(
        self, reply: dict[str, Any], limit: float | None, name: str, start: float
    ) -> PlanningResult:
        """What came of a call; every plan is replayed before it is believed.

        Args:
            reply: What the engine said.
            limit: The time limit, in seconds.
            name: The planner's.
            start: When it was called, by `time.perf_counter`.
        """
        seconds = time.perf_counter() - start
        match reply["kind"]:
            case "plan":
                happenings = [(float(at), number) for at, number in reply["happenings"]]
                steps = [(at, self._own(number)) for at, number in happenings]
                actions = in_order(self.task, steps, self.state)
                wrong = flaw(self.task, actions, self.state)
                if wrong is not None:
                    reason = f"the plan that came back does not work: {wrong}"
                    return Crashed(reason, name, seconds)
                times = tuple(at for at, _ in steps)
                return Plan(actions, sum(a.cost for a in actions), name, seconds, times)
            case "timeout":
                return TimedOut(limit or 0.0, name, seconds)
            case "unsolvable" if self._untimed:
                reason = self._why_untimed(lambda _: True)
                reason = f"no plan without what has no duration: {reason}"
                return Crashed(reason, name, seconds)
            case "unsolvable" if self.ground.whole:
                return Unsolvable(reply["reason"], name, seconds)
        return Crashed(reply.get("reason", reply["kind"]), name, seconds)


def in_order(task: Task, steps: Sequence[tuple[float, Action]], state: State) -> tuple[Action, ...]:
    """Actions with their times in an order in which they can be done one after the other.

    What comes at one time may come in any order for an engine, unless it bears on each other; but
    one may begin what another has to hold for meanwhile.
    """
    found: list[Action] = []
    for _, group in groupby(steps, key=lambda step: step[0]):
        actions = [action for _, action in group]
        orders = permutations(actions) if len(actions) <= _MOST_AT_ONCE else [tuple(actions)]
        order = next((o for o in orders if misstep(task, o, state) is None), tuple(actions))
        for action in order:
            state = task.apply(state, action)
        found += order
    return tuple(found)


def misstep(task: Task, actions: Sequence[Action], state: State) -> str | None:
    """What cannot be done of some parts of actions that last, or breaks what runs; None if nothing.

    What must hold while an action runs has to hold after everything that comes until its end.
    """
    lasting = task.lasting
    assert lasting is not None
    for place, action in enumerate(actions, start=1):
        if not task.applicable(state, action):
            return f"step {place}, {action}, cannot be done"
        state = task.apply(state, action)
        extended = task.extend(state)
        for running in lasting.under_way(task, state):
            if not holds(lasting.meanwhile(task, running), extended):
                name = lasting.name_of(running.name)
                return f"after step {place}, {action}, {name} lacks what must hold meanwhile"
    return None


def flaw(task: Task, actions: Sequence[Action], state: State) -> str | None:
    """Why parts of actions that last, in their order, do not lead to the goal; None if they do.

    All actions have to have ended then.
    """
    wrong = misstep(task, actions, state)
    if wrong is not None:
        return wrong
    for action in actions:
        state = task.apply(state, action)
    if not task.goal_holds(state):
        return "the goal does not hold at its end"
    if task.lasting is not None and task.lasting.under_way(task, state):
        return "an action is still running at its end"
    return None
