"""Doing what a trial asks for, with real planners, worlds and VLMs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from threading import Event as Flag
from typing import Any

from tpvqa.drivers.freshness import Freshness
from tpvqa.drivers.halting import unless_halted
from tpvqa.drivers.looked import NO_PICTURE, declared
from tpvqa.drivers.plugged import (
    MALFORMED,
    THEN,
    called,
    malformed,
    planning_result,
    views_of,
)
from tpvqa.drivers.sensed import checked
from tpvqa.errors import PlannerError
from tpvqa.events.events import Acted, Answered, FrameRecord, Observed, PlanMade, Waited
from tpvqa.events.records import (
    answered_record,
    frame_record,
    outcome_record,
    plan_record,
    sensed_records,
)
from tpvqa.monitors import Ask, AskPerson, Look, PlanFrom
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Literal, Task
from tpvqa.planning import Crashed, Planner
from tpvqa.planning.bounded import BoundedPlanner
from tpvqa.planning.towards import plan_towards
from tpvqa.planning.without import plan_without
from tpvqa.questions import Question, QuestionBook
from tpvqa.trial import Act, Pending, Wait
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.vlm.capabilities import is_noise_model, metered, sees_before
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.sight import cannot_see, seen_by
from tpvqa.vlm.usage import Usage
from tpvqa.worlds import Execution, Report, Restorable, World
from tpvqa.worlds.capabilities import Bounded, Halting, Telling, has_pictures
from tpvqa.worlds.goal import goal_holds, unmet
from tpvqa.worlds.outcome import Outcome


@dataclass
class Parts:
    """What a trial is made of.

    Attributes:
        person: Answers where a monitor asks a person; None where nobody is there.
    """

    task: Task
    book: QuestionBook
    planner: Planner
    world: World
    vlm: VLM
    person: VLM | None = None


@dataclass(frozen=True, slots=True)
class Performed:
    """What came of a request: for the trial a value, for the log an event."""

    value: Any
    event: PlanMade | Observed | Answered | Acted | Waited


class Performer:
    """Does what a trial asks for, and says what came of it.

    Args:
        parts: Planner, world, VLM and person.
        save_frame: Saves a picture; gives its path within the episode.
        snapshots: Whether events are to hold the states of world and VLM.
        planning_timeout: Seconds for one call of the planner.
        action_deadline: Seconds for one action.
        cancel: Set from another thread to end the trial.
    """

    def __init__(
        self,
        parts: Parts,
        *,
        save_frame: Callable[[Frame], str],
        snapshots: bool = True,
        planning_timeout: float | None = None,
        action_deadline: float | None = None,
        cancel: Flag | None = None,
    ):
        self.parts, self._save_frame = parts, save_frame
        self._planning_timeout, self._action_deadline = planning_timeout, action_deadline
        self.cancel = cancel or Flag()
        # asked once: such checks are slow
        self._freshness = Freshness(parts.world)
        self._metered = metered(parts.vlm)
        self._counted = Usage() if self._metered is None else self._metered.usage
        self._telling = parts.world if isinstance(parts.world, Telling) else None
        self._halting = parts.world if isinstance(parts.world, Halting) else None
        kept = (parts.world, parts.vlm) if snapshots else ()
        self._kept = [part for part in kept if isinstance(part, Restorable)]
        self._planner: Planner = parts.planner
        if isinstance(parts.world, Bounded):
            self._planner = BoundedPlanner(parts.planner, self._refused)

    def perform(self, pending: Pending) -> Performed:
        """Do what is pending.

        Raises:
            HaltedError: Somebody stopped the robot while it was not acting.
            TpvqaError: A plug-in broke, or returned what it must not.
        """
        if self._halting is None or isinstance(pending.request, Act | Wait):
            return self._perform(pending)
        return unless_halted(self._halting, lambda: self._perform(pending))

    def _perform(self, pending: Pending) -> Performed:
        match pending.request:
            case Look(view):
                return self.look(view, pending.look)
            case Ask(questions):
                return self._ask(pending.seen, questions)
            case AskPerson(question):
                return self._ask_person(pending.seen, question)
            case PlanFrom():
                return self._plan(pending.request, pending.seconds)
            case Act(action):
                return self._act(action, pending.seconds)
            case Wait(until):
                return self._wait(until)

    def goal_holds(self) -> bool | None:
        """Whether the goal holds in truth; None in a world that does not know."""
        return goal_holds(self.parts.world, self.parts.task.goal)

    def unmet(self) -> tuple[Literal, ...]:
        """For want of what the goal does not hold in truth; empty in a world that does not know."""
        return unmet(self.parts.world, self.parts.task.goal)

    def look(self, view: str | None, number: int, *, during: bool = False) -> Performed:
        """Look at the world.

        Args:
            view: From where; None for the default.
            number: Of the look.
            during: Whether an action is running.
        """
        world = self.parts.world
        seen = called(world, "observe", Observation, view)
        facts = checked(seen.facts, self.parts.task, world, "observe")
        try:
            frames = declared(seen.frames, self._views, number)
            seen = replace(seen, look=number, frames=frames, facts=facts)
            observed = Observed(
                look=number,
                view=view,
                world_time=seen.time,
                frames=tuple(map(self._frame, seen.frames.values())),
                detail=dict(seen.detail),
                facts=sensed_records(facts),
                during=during,
                snapshot=None if during else self._snapshot(world),
            )
        except MALFORMED as error:
            raise malformed(world, "observe", error) from error
        if not during:
            self._freshness.looked(seen)
        return Performed(seen, observed)

    @cached_property
    def _views(self) -> tuple[str, ...]:
        return views_of(self.parts.world)

    @property
    def _needs_a_picture(self) -> bool:
        """Whether there is a camera that the VLM would look through."""
        seen = has_pictures(self.parts.world) and bool(self._views)
        return seen and not is_noise_model(self.parts.vlm)

    def _refused(self, action: Action) -> str:
        return called(self.parts.world, "refuses", str, action)

    def _frame(self, frame: Frame) -> FrameRecord:
        return frame_record(frame, self._save_frame(frame))

    def _plan(self, request: PlanFrom, seconds: float | None) -> Performed:
        parts, timeout = self.parts, _less(self._planning_timeout, seconds)
        planner, task, state = self._planner, parts.task, request.state
        if request.without or request.towards:
            try:
                result: object = (
                    plan_towards(planner, task, state, request.towards, timeout=timeout)
                    if request.towards
                    else plan_without(planner, task, state, request.without, timeout=timeout)
                )
            except PlannerError as error:  # it was wished for, no more
                result = Crashed(str(error), parts.planner.name, 0.0)
        elif request.running:
            running = request.running
            result = called(
                parts.planner, "plan_meanwhile", object, task, state, running, timeout=timeout
            )
        else:
            result = called(planner, "plan", object, task, state, timeout=timeout)
        result = planning_result(planner, result)
        try:
            made = plan_record(result, state, parts.book)
        except MALFORMED as error:
            raise malformed(planner, "plan", error) from error
        seen_so = {
            "considered": not request.followed,
            "without": tuple(sorted(action.pddl() for action in request.without)),
            "towards": tuple(sorted(atom.pddl() for atom in request.towards)),
        }
        return Performed(result, made.model_copy(update=seen_so))

    def _ask(self, seen: Observation | None, questions: Sequence[Question]) -> Performed:
        why = ""
        if seen is not None:
            seen, why = seen_by(self.parts.vlm, seen, self._freshness.faults)
            if not seen.frames and self._needs_a_picture:
                why = NO_PICTURE
            seen = replace(seen, before=self._earlier(seen.before))
        if self._metered is not None:
            self._counted = self._metered.usage
        vlm = self.parts.vlm
        if why:
            answers = cannot_see(questions, why)
        else:
            answers = ask_checked(vlm, seen, questions, then=THEN)
        return Performed(answers, self._answered(vlm, answers))

    def _earlier(self, before: Observation | None) -> Observation | None:
        """What is shown of the look before the latest action, where anything is to be seen."""
        if before is None or not sees_before(self.parts.vlm):
            return None
        shown, why = seen_by(self.parts.vlm, before)
        return None if why else shown

    def _ask_person(self, seen: Observation | None, question: Question) -> Performed:
        person = self.parts.person
        if person is None:
            answer = Answer(question, Reply.UNKNOWN, text="nobody is there")
            return Performed(answer, self._answered(self.parts.vlm, [answer]))
        answers = ask_checked(person, seen, (question,), then=THEN)
        return Performed(answers[0], self._answered(person, answers))

    def _answered(self, asked: VLM, answers: Sequence[Answer]) -> Answered:
        try:
            taken = None
            if self._metered is not None and asked is self.parts.vlm:
                taken = self._metered.usage - self._counted
            return answered_record(answers, self._snapshot(self.parts.vlm), taken)
        except MALFORMED as error:
            raise malformed(asked, "ask", error) from error

    def _act(self, action: Action, seconds: float | None) -> Performed:
        world = self.parts.world
        self._freshness.acted()
        before = self._last_outcome()
        execution = called(
            world,
            "execute",
            Execution,
            action,
            deadline=_less(self._action_deadline, seconds),
            cancel=self.cancel,
        )
        if not isinstance(execution.report, Report):
            raise malformed(world, "execute", ValueError(f"no Report: {execution.report!r:.80}"))
        facts = checked(execution.facts, self.parts.task, world, "execute")
        try:
            if execution.seconds < 0:
                raise ValueError(f"seconds: {execution.seconds:g}, less than none")
            outcome = self._last_outcome()
            acted = Acted(
                report=execution.report,
                seconds=execution.seconds,
                message=execution.message,
                facts=sensed_records(facts),
                truth=None if outcome is before else outcome_record(outcome),
                snapshot=self._snapshot(world),
            )
        except MALFORMED as error:
            raise malformed(world, "execute", error) from error
        return Performed(replace(execution, facts=facts), acted)

    def _wait(self, until: float | None) -> Performed:
        """Let time pass in a world in which actions last."""
        world, before = self.parts.world, self._last_outcome()
        clock = called(world, "wait", float, until, cancel=self.cancel)
        outcome = self._last_outcome()
        try:
            waited = Waited(
                clock=clock,
                truth=None if outcome is before else outcome_record(outcome),
                snapshot=self._snapshot(world),
            )
        except MALFORMED as error:
            raise malformed(world, "wait", error) from error
        return Performed(clock, waited)

    def _last_outcome(self) -> Outcome | None:
        return None if self._telling is None else self._telling.last_outcome

    def _snapshot(self, part: object) -> dict[str, Any] | None:
        kept = next((each for each in self._kept if each is part), None)
        return None if kept is None else dict(kept.snapshot())


def _less(one: float | None, other: float | None) -> float | None:
    """The lower of two limits, either of which may be none."""
    given = [each for each in (one, other) if each is not None]
    return min(given, default=None)
