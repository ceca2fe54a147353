"""What the loop keeps of actions that last: when the next thing is due, and what is running."""

from collections.abc import Generator
from dataclasses import replace

from tpvqa.events import Decision, TrialState
from tpvqa.monitors import Step, Verdict
from tpvqa.pddl import Action, Task
from tpvqa.pddl.lasting import Phase, Running
from tpvqa.planning import Plan
from tpvqa.trial.pending import Wait

_DUE = 0.01
"""The time that is left to what should have ended by now, and has not been tried to be ended."""


class Clockwork:
    """Begins and ends actions at their times. In a task in which nothing lasts it does nothing.

    Times are by the world's clock, as far as events have told it.

    Args:
        task: The task.
    """

    def __init__(self, task: Task):
        self._task, self._lasting = task, task.lasting
        self._ends: dict[Action, float] = {}
        self._failed: Action | None = None

    def due(self, plan: Plan, state: TrialState) -> Generator[Wait, TrialState, None]:
        """Wait until the plan's step is due.

        Yields:
            What to wait for; it is sent where the trial stands then.
        """
        if not plan.times:
            return
        if state.began is None:  # a new plan
            self._failed = None
            state = yield Wait()
        assert state.began is not None
        assert state.clock is not None
        due = state.began + plan.times[state.index]
        if due > state.clock:
            yield Wait(due)

    def begun(self, step: Step, state: TrialState) -> None:
        """Note when what is begun now is to end."""
        if self._lasting is None or state.began is None:
            return
        if self._lasting.phase_of(step.action.name) is Phase.START:
            end = self._lasting.part(self._task, step.action, Phase.END)
            later = step.plan.actions[step.index :]
            if end in later:
                at = step.plan.times[step.index + later.index(end)]
                self._ends[step.action] = state.began + at

    def judged(self, verdict: Verdict, step: Step) -> Verdict:
        """A verdict that an action which lasts has ended without its effects leads to a new plan:
        its end cannot be repeated alone."""
        lasting = self._lasting
        if lasting is None or verdict.decision is not Decision.REPEAT:
            return verdict
        if lasting.phase_of(step.action.name) is not Phase.END:
            return verdict
        self._failed = lasting.part(self._task, step.action, Phase.START)
        return replace(verdict, decision=Decision.REPLAN, reason=f"{verdict.reason}; cancelled")

    def running(self, state: TrialState) -> tuple[Running, ...]:
        """What is believed to be running, and how much longer; nothing is left to what failed."""
        if self._lasting is None:
            return ()
        return tuple(
            Running(action, 0.0 if action == self._failed else self._left(action, state))
            for action in self._lasting.under_way(self._task, state.believed)
        )

    def _left(self, action: Action, state: TrialState) -> float:
        end = self._ends.get(action)
        if end is None or state.clock is None:  # it ran before the trial began
            assert self._lasting is not None
            return self._lasting.duration(action)[0]
        return max(end - state.clock, _DUE)
