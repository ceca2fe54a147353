"""The closed loop: plan, check, act, check; repeat or replan where the monitor says so."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from threading import Event as Flag
from typing import Literal, TypeVar

from tpvqa.episodes import Ended, Event, Limits, Parts, Recorder, Started
from tpvqa.episodes.events import Believed, Decided, EndedBecause
from tpvqa.episodes.perform import perform
from tpvqa.episodes.recorder import Lost, Writer
from tpvqa.episodes.records import atoms
from tpvqa.monitors import Check, Decision, Monitor, Step, Verdict
from tpvqa.pddl import State
from tpvqa.planning import Crashed, Plan, TimedOut
from tpvqa.worlds import Report
from tpvqa.worlds.truth import goal_holds

T = TypeVar("T")


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during an episode, whose log has its end: what runs many ends with it.

    Attributes:
        ended: The last event.
    """

    def __init__(self, ended: Ended):
        super().__init__("interrupted")
        self.ended = ended


@dataclass
class _Trial:
    """Where a running trial stands."""

    state: State
    plan: Plan | None = None
    index: int = 0
    attempt: int = 0
    repeats: int = 0
    replans: int = 0
    believes_goal: bool = False
    message: str = ""
    cancel: Flag = field(default_factory=Flag)


def run_episode(
    parts: Parts,
    monitor: Monitor,
    writer: Writer,
    started: Started,
    *,
    recorded: Sequence[Event] = (),
    folder: Path | None = None,
    listeners: Sequence[Callable[[Event], None]] = (),
    planning_timeout: float | None = None,
    action_deadline: float | None = None,
    cancel: Flag | None = None,
) -> Ended:
    """Run one trial to its end.

    Args:
        parts: Task, questions, planner, world and VLM.
        monitor: Decides before and after every action; a fresh one for every trial.
        writer: Where events go, each before the next thing happens.
        started: The first event; its limits hold.
        recorded: Events of an unfinished episode that is to be gone on with.
        folder: Where that episode's pictures lie.
        listeners: Told of every event.
        planning_timeout: Seconds for one call of the planner.
        action_deadline: Seconds for one action.
        cancel: Set from another thread to end the trial.

    Returns:
        The last event. `completed` means that all goals hold in truth and that the trial ended
        believing so.

    Raises:
        Interrupted: Ctrl-C. The log is ended first, and can be gone on with.
    """
    recorder = Recorder(parts, writer, recorded=recorded, folder=folder, listeners=listeners)
    trial = _Trial(parts.task.init, cancel=cancel or Flag())
    recorder.emit(started)
    interrupted = False
    try:
        because = _run(recorder, monitor, trial, started.limits, planning_timeout, action_deadline)
    except KeyboardInterrupt:
        if recorder.replaying:  # the log is right as it is
            raise
        because, trial.message, interrupted = "cancelled", "interrupted by the user", True
    recorder.settle()
    goal = goal_holds(parts.world, parts.task.goal)
    ended = recorder.end(
        Ended(
            because=because,
            message=trial.message,
            believed_goal=trial.believes_goal,
            goal_holds=goal,
            completed=None if goal is None else goal and trial.believes_goal,
            actions=recorder.actions,
            questions=recorder.questions,
            looks=recorder.looks,
            repeats=trial.repeats,
            replans=trial.replans,
        )
    )
    if interrupted:
        raise Interrupted(ended)
    return ended


def _run(
    recorder: Recorder,
    monitor: Monitor,
    trial: _Trial,
    limits: Limits,
    planning_timeout: float | None,
    action_deadline: float | None,
) -> EndedBecause:
    def check(of: Callable[[Step], Check], when: Literal["before", "after"]) -> Verdict:
        verdict = _again(recorder, lambda: perform(recorder, of(step), timeout=planning_timeout))
        action, decision = step.action.pddl(), verdict.decision
        recorder.emit(
            Decided(
                when=when,
                step=trial.index,
                action=action,
                decision=decision,
                reason=verdict.reason,
                onto=verdict.step,
                belief={atom.pddl(): round(p, 4) for atom, p in verdict.belief.items()},
            )
        )
        _believe(recorder, trial, verdict.state)
        return verdict

    parts, failed = recorder.parts, _replan(recorder, trial, planning_timeout)
    while failed is None and trial.plan is not None and trial.index < len(trial.plan.actions):
        if trial.cancel.is_set():
            return "cancelled"
        step = Step(parts.task, parts.book, trial.plan, trial.index, trial.state, trial.attempt)
        verdict = check(monitor.before, "before")
        if verdict.decision is Decision.GO_ON and verdict.step in (None, trial.index):
            if recorder.actions >= limits.actions:
                return "limit of actions"
            try:
                execution = recorder.act(
                    step.action,
                    step=trial.index,
                    attempt=trial.attempt,
                    deadline=action_deadline,
                    cancel=trial.cancel,
                )
            except Lost:
                _again(recorder, lambda: recorder.look(None))
                continue
            if trial.cancel.is_set():
                return "cancelled"
            if execution.report is Report.UNAVAILABLE:
                trial.message = execution.message
                return "world refused"
            if execution.report is not Report.DONE:
                step = replace(step, trouble=execution.message or execution.report.value)
            verdict = check(monitor.after, "after")
            if verdict.decision is Decision.GO_ON:
                trial.index, trial.attempt = _or(verdict.step, trial.index + 1), 0
                continue
        match verdict.decision:
            case Decision.GO_ON:
                trial.index, trial.attempt = _or(verdict.step, trial.index), 0
            case Decision.REPEAT:
                if trial.attempt >= limits.repeats:
                    return "limit of repeats"
                trial.attempt, trial.repeats = trial.attempt + 1, trial.repeats + 1
            case Decision.REPLAN:
                if trial.replans >= limits.replans:
                    return "limit of replans"
                trial.replans += 1
                failed = _replan(recorder, trial, planning_timeout)
            case Decision.DONE:
                break
            case Decision.GIVE_UP:
                trial.message = verdict.reason
                return "gave up"
    trial.believes_goal = failed is None
    return failed or "goal"


def _again(recorder: Recorder, do: Callable[[], T]) -> T:
    """Do something; where a trial came back to a world that may have changed, look first."""
    lost = False
    while True:
        try:
            if lost:
                recorder.look(None)
            return do()
        except Lost:
            lost = True


def _replan(recorder: Recorder, trial: _Trial, timeout: float | None) -> EndedBecause | None:
    """A new plan from what is believed; why there is none, where there is none."""
    result = _again(recorder, lambda: recorder.plan(trial.state, timeout=timeout))
    if isinstance(result, Plan):
        trial.plan, trial.index, trial.attempt = result, 0, 0
        return None
    if isinstance(result, TimedOut):
        trial.message = f"the planner found no plan within {result.limit:g} s"
        return "planner timed out"
    trial.message = result.reason
    return "planner crashed" if isinstance(result, Crashed) else "no plan"


def _believe(recorder: Recorder, trial: _Trial, state: State | None) -> None:
    if state is not None and state != trial.state:
        recorder.emit(
            Believed(added=atoms(state - trial.state), removed=atoms(trial.state - state))
        )
        trial.state = state


def _or(value: int | None, default: int) -> int:
    return default if value is None else value
