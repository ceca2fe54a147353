"""The paper's closed loop: plan, check, act, check; repeat or replan where the monitor says so."""

from collections.abc import Callable, Generator
from dataclasses import replace
from functools import partial
from typing import Any, Literal

from tpvqa.errors import PluginError
from tpvqa.events import Decision, Event, Started, TrialState
from tpvqa.events.events import Acted, Acting, Asked, Believed, Decided, QuestionRecord
from tpvqa.events.records import action_record, atoms, plan_record, question_record
from tpvqa.monitors import Ask, AskPerson, Check, Look, Monitor, PlanFrom, Request, Step, Verdict
from tpvqa.monitors.capabilities import LooksFirst
from tpvqa.observation import Observation
from tpvqa.pddl import State, Task
from tpvqa.planning import Crashed, Plan, TimedOut
from tpvqa.questions import Question, QuestionBook, Way
from tpvqa.trial.clockwork import Clockwork
from tpvqa.trial.pending import Act, Conclusion, Pending, Result, Steps, Unwatched, Wait
from tpvqa.worlds import Execution, Report

INTERRUPTED = "interrupted"
"""What is reported of a skill in whose middle the program was killed."""


def trial(task: Task, book: QuestionBook, monitor: Monitor, started: Started) -> Steps:
    """One trial, from its first event to why it ended.

    Args:
        task: What is to be done.
        book: Turns facts and actions into questions.
        monitor: Decides before and after every action; a fresh one for every trial.
        started: The first event; its limits hold.
    """
    loop = _Loop(task, book, monitor)
    try:
        yield from loop.emit(started)
        return (yield from loop.run())
    except _Over:
        limit = loop.state.over
        assert limit is not None
        return Conclusion(limit)


class _Over(Exception):  # noqa: N818
    """A limit was reached in the middle of a check."""


class _Loop:
    """The logic of the loop. Where it stands is what it was last sent."""

    def __init__(self, task: Task, book: QuestionBook, monitor: Monitor):
        self.task, self.book, self.monitor = task, book, monitor
        self.state = TrialState()
        self.plan: Plan | None = None
        self._seen: Observation | None = None
        self._before: Observation | None = None
        self._clockwork = Clockwork(task)
        self._records: dict[Question, QuestionRecord] = {}

    def run(self) -> Steps:
        """Plan, and follow plans until the goal is believed, or the trial cannot go on."""
        first = yield from self._first()
        if first is not None and first.decision is Decision.GIVE_UP:
            return Conclusion("gave up", first.reason)
        failed = yield from self._replan(None if first is None else first.plan)
        while failed is None and self.plan is not None and self._index < len(self.plan.actions):
            yield from self._await()
            step = self._step()
            verdict = yield from self._check(self.monitor.before, step, "before")
            decided = self.state.decided
            if decided is not None and decided.acts and self.state.over is None:
                try:
                    execution = yield from self._act(step)
                except Unwatched:  # it was not begun
                    yield from self._persist(self._look)
                    continue
                if execution.report is Report.UNAVAILABLE:
                    return Conclusion("world refused", execution.message)
                if execution.report is not Report.DONE:
                    step = replace(step, trouble=execution.message or execution.report.value)
                step = replace(
                    step,
                    reported=_reported(execution),
                    sensed=tuple(execution.facts),
                    actions_left=self.state.actions_left,
                )
                verdict = yield from self._check(self.monitor.after, step, "after")
            match verdict.decision:
                case Decision.DONE:
                    break
                case Decision.GIVE_UP:
                    return Conclusion("gave up", verdict.reason)
            if self.state.over is not None and not self._finished(verdict):
                return Conclusion(self.state.over)
            if verdict.decision is Decision.REPLAN:
                failed = yield from self._replan(verdict.plan)
        return failed or Conclusion("goal", believes_goal=True)

    def _first(self) -> Generator[Any, Any, Verdict | None]:
        """What a monitor looks at before the first plan; its verdict may bring that plan."""
        if not isinstance(self.monitor, LooksFirst) or not self.monitor.unsure:
            return None
        look = self.monitor.first
        verdict: Verdict = yield from self._persist(lambda: self._perform(look(self.book)))
        yield from self.emit(
            Decided(
                when="before",
                step=0,
                action="",
                decision=verdict.decision,
                reason=verdict.reason,
                belief={atom.pddl(): round(p, 4) for atom, p in verdict.belief.items()},
            )
        )
        yield from self._believe(verdict.state)
        return verdict

    def _finished(self, verdict: Verdict) -> bool:
        """Whether a verdict leads beyond the plan's last step: what is over then is the plan."""
        assert self.plan is not None
        return verdict.decision is Decision.GO_ON and self._index >= len(self.plan.actions)

    @property
    def _index(self) -> int:
        return self.state.index

    def _step(self) -> Step:
        assert self.plan is not None
        state = self.state
        return Step(
            self.task,
            self.book,
            self.plan,
            state.index,
            state.believed,
            state.attempt,
            actions_left=state.actions_left,
            replans_left=state.replans_left,
            repeats_left=state.repeats_left,
        )

    def _await(self) -> Generator[Any, Any, None]:
        """Let time pass until the plan's step is due, where it has a time.

        Raises:
            _Over: The limit of time was reached meanwhile.
        """
        assert self.plan is not None
        waiting = self._clockwork.due(self.plan, self.state)
        wait = next(waiting, None)
        while wait is not None:
            yield from self._persist(partial(self._do, wait))
            try:
                wait = waiting.send(self.state)
            except StopIteration:
                wait = None

    def emit(self, event: Event) -> Generator[Event, TrialState, None]:
        """Say that something happened."""
        self.state = yield event

    def _do(
        self,
        request: Request | Act | Wait,
        announced: Asked | Acting | None = None,
        seen: Observation | None = None,
    ) -> Generator[Pending, Result, Any]:
        """Have something done."""
        if self.state.over == "limit of time":
            raise _Over
        try:
            state = self.state
            seen = seen or self._seen
            result = yield Pending(request, announced, state.looks, seen, state.seconds_left)
        except Unwatched as unwatched:
            self.state = unwatched.state
            raise
        self.state = result.state
        return result.value

    def _persist(self, doing: Callable[[], Generator[Any, Any, Any]]) -> Generator[Any, Any, Any]:
        """Do something; where the world may have changed meanwhile, look and do it again."""
        unwatched = False
        while True:
            try:
                if unwatched:
                    yield from self._look()
                return (yield from doing())
            except Unwatched:
                unwatched = True

    def _look(self, request: Look | None = None) -> Generator[Any, Any, Observation]:
        seen: Observation = yield from self._do(request or Look())
        self._seen = seen
        return seen

    def _check(
        self, of: Callable[[Step], Check], step: Step, when: Literal["before", "after"]
    ) -> Generator[Any, Any, Verdict]:
        """What the monitor decides of a step."""
        verdict: Verdict = yield from self._persist(lambda: self._perform(of(step)))
        if when == "after":
            verdict = self._clockwork.judged(verdict, step)
        yield from self.emit(
            Decided(
                when=when,
                step=step.index,
                action=step.action.pddl(),
                decision=verdict.decision,
                reason=verdict.reason,
                onto=verdict.step,
                belief={atom.pddl(): round(p, 4) for atom, p in verdict.belief.items()},
            )
        )
        yield from self._believe(verdict.state)
        return verdict

    def _perform(self, check: Check) -> Generator[Any, Any, Verdict]:
        """Have done what a check asks for, until it decides."""
        value: Any = None
        if not isinstance(check, Generator):
            raise PluginError(
                f"The monitor {self.monitor.name} has to give a generator of requests that returns "
                f"a Verdict, not {type(check).__name__}"
            )
        while True:
            try:
                request = check.send(value)
            except StopIteration as end:
                verdict = end.value
                if not isinstance(verdict, Verdict):
                    raise PluginError(
                        f"The monitor {self.monitor.name} has to return a Verdict, not "
                        f"{type(verdict).__name__}"
                    ) from None
                return verdict
            match request:
                case Look():
                    value = yield from self._look(request)
                case Ask(questions):
                    value = yield from self._ask(request, questions)
                case AskPerson(question):
                    value = yield from self._ask(request, (question,))
                case PlanFrom():
                    value = yield from self._do(self._meanwhile(request))
                case _:
                    raise PluginError(
                        f"The monitor {self.monitor.name} asked for {request!r}; it can ask for "
                        "Look, Ask, AskPerson and PlanFrom"
                    )

    def _ask(
        self, request: Ask | AskPerson, questions: tuple[Question, ...]
    ) -> Generator[Any, Any, Any]:
        if self._seen is None:
            yield from self._look()
        assert self._seen is not None
        asked = Asked(
            look=self._seen.look,
            questions=tuple(map(self._record, questions)),
            person=isinstance(request, AskPerson),
        )
        before = None if asked.person else self._compared(questions)
        if before is None:
            return (yield from self._do(request, asked))
        asked = asked.model_copy(update={"before": before.look})
        return (yield from self._do(request, asked, replace(self._seen, before=before)))

    def _compared(self, questions: tuple[Question, ...]) -> Observation | None:
        """The look before the latest action, where it is to be shown, too."""
        started, before = self.state.started, self._before
        if started is None or not started.config.vlm.before_after or before is None:
            return None
        assert self._seen is not None
        ways = (Way.EFFECT, Way.SUCCESSFUL, Way.DID)
        later = self._seen.look > before.look
        return before if later and any(each.way in ways for each in questions) else None

    def _record(self, question: Question) -> QuestionRecord:
        """Questions are asked again and again; what is logged of one is worked out once."""
        record = self._records.get(question)
        if record is None:
            record = self._records[question] = question_record(question)
        return record

    def _act(self, step: Step) -> Generator[Any, Any, Execution]:
        """Have an action executed.

        Raises:
            Unwatched: The world may have changed before it was begun.
        """
        self._before = self._seen
        said = action_record(step.action, self.book)
        self._clockwork.begun(step, self.state)
        acting = Acting(step=step.index, action=said, attempt=step.attempt)
        try:
            execution: Execution = yield from self._do(Act(step.action), acting)
        except Unwatched:
            if self.state.acting is None:
                raise
            # killed in the middle of a skill: what came of it is for a new look
            execution = Execution(Report.FAILED, 0.0, INTERRUPTED)
            yield from self.emit(
                Acted(report=execution.report, seconds=0.0, message=execution.message)
            )
            yield from self._persist(self._look)
            if self._seen is not None:
                execution = replace(execution, facts=self._seen.facts)
        return execution

    def _replan(self, known: Plan | None) -> Generator[Any, Any, Conclusion | None]:
        """Follow a new plan from what is believed; why there is none, where there is none.

        Args:
            known: That plan, where the monitor has had it made.
        """
        if known is not None:
            made = plan_record(replace(known, seconds=0.0), self.state.believed, self.book)
            yield from self.emit(made)
            self.plan = known
            return None
        result = yield from self._persist(
            lambda: self._do(self._meanwhile(PlanFrom(self.state.believed, followed=True)))
        )
        if isinstance(result, Plan):
            self.plan = result
            return None
        if self.state.over is not None:
            return Conclusion(self.state.over)
        if isinstance(result, TimedOut):
            message = f"the planner found no plan within {result.limit:g} s"
            return Conclusion("planner timed out", message)
        crashed = isinstance(result, Crashed)
        return Conclusion("planner crashed" if crashed else "no plan", result.reason)

    def _meanwhile(self, request: PlanFrom) -> PlanFrom:
        return replace(request, running=self._clockwork.running(self.state))

    def _believe(self, state: State | None) -> Generator[Event, TrialState, None]:
        before = self.state.believed
        if state is not None and state != before:
            yield from self.emit(
                Believed(added=atoms(state - before), removed=atoms(before - state))
            )


def _reported(execution: Execution) -> bool | None:
    """Whether a skill reports a failure; None where the program was killed in its middle."""
    if execution.message == INTERRUPTED:
        return None
    return execution.report is not Report.DONE
