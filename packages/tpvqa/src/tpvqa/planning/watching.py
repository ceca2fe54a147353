"""Plans of what lasts, with looks at what must hold meanwhile, and without what has failed."""

from collections.abc import Sequence
from dataclasses import replace

from tpvqa.pddl import Action, State, Task, holds
from tpvqa.pddl.lasting import Phase, Running, says_something
from tpvqa.planning.protocol import Plan, PlanningResult, TemporalPlanner

QUARTERS = 4
"""Into so many parts looks divide an action's time where no period is given."""


class Watching:
    """Plans with another planner, and puts into its plans what a trial does besides.

    While an action runs a look at what must hold meanwhile is put in, once in every period, where
    anything must. An action that is running where that does not hold any more, or to which no time
    is left, is cancelled first; it is planned from there.

    Args:
        planner: Plans; not closed here.
        every: The period, in the domain's units of time; None for a quarter of each action's time.
    """

    def __init__(self, planner: TemporalPlanner, *, every: float | None = None):
        self._planner, self._every = planner, every

    @property
    def name(self) -> str:
        """The name of the planner behind it."""
        return self._planner.name

    def plan(
        self, task: Task, state: State | None = None, *, timeout: float | None = None
    ) -> PlanningResult:
        """A plan from a state in which all that runs has its least duration before it."""
        state = task.init if state is None else state
        assert task.lasting is not None
        lasting = task.lasting
        running = [Running(a, lasting.duration(a)[0]) for a in lasting.under_way(task, state)]
        return self.plan_meanwhile(task, state, running, timeout=timeout)

    def plan_meanwhile(
        self,
        task: Task,
        state: State,
        running: Sequence[Running],
        *,
        timeout: float | None = None,
    ) -> PlanningResult:
        """A plan with its looks; see `TemporalPlanner.plan_meanwhile`."""
        assert task.lasting is not None
        lasting, before = task.lasting, task.extend(state)
        cancelled = [
            lasting.part(task, each.action, Phase.CANCEL)
            for each in running
            if each.left <= 0 or not holds(lasting.meanwhile(task, each.action), before)
        ]
        over = {lasting.running(action) for action in cancelled}
        for action in cancelled:
            state = task.apply(state, action)
        kept = [each for each in running if lasting.running(each.action) not in over]
        result = self._planner.plan_meanwhile(task, state, kept, timeout=timeout)
        if not isinstance(result, Plan):
            return result
        steps = [(0.0, action) for action in cancelled]
        steps += self._with_looks(task, [*zip(result.times, result.actions, strict=True)])
        return replace(
            result,
            actions=tuple(action for _, action in steps),
            times=tuple(at for at, _ in steps),
        )

    def _with_looks(
        self, task: Task, steps: list[tuple[float, Action]]
    ) -> list[tuple[float, Action]]:
        assert task.lasting is not None
        lasting, begun = task.lasting, dict[tuple[str, tuple[str, ...]], float]()
        looks: list[tuple[float, Action]] = []
        for at, action in steps:
            key = (lasting.name_of(action.name) or "", action.arguments)
            phase = lasting.phase_of(action.name)
            if phase is Phase.START:
                begun[key] = at
            elif phase is Phase.END and says_something(lasting.meanwhile(task, action)):
                look = lasting.part(task, action, Phase.WHILE)
                looks += [(time, look) for time in self._times(begun.pop(key, 0.0), at)]
        # the sort is stable: of what comes at one time looks are first
        return sorted([*looks, *steps], key=lambda step: step[0])

    def _times(self, start: float, end: float) -> list[float]:
        """When to look; so long before its end that it is not the look at its end."""
        period = (end - start) / QUARTERS if self._every is None else self._every
        count = int((end - start) / period + 1e-9) if period > 0 else 0
        times = [start + period * (n + 1) for n in range(count)]
        return [time for time in times if time < end - period * 1e-6]

    def close(self) -> None:
        """The planner behind it is closed by who made it."""
