"""Performs what a trial asks for and logs it; while a log is being resumed, plays it back.

A resumed trial runs the same code as an unbroken one. As long as the log holds events, their
results are taken from it; then the world and the VLM are put back into the states that the log
kept, and the trial goes on.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from threading import Event as Flag
from typing import Any, Protocol, TypeVar

from tpvqa.episodes import records
from tpvqa.episodes.events import (
    Acted,
    Acting,
    Answered,
    Asked,
    Event,
    FrameRecord,
    Observed,
    PlanMade,
    QuestionRecord,
    Resumed,
)
from tpvqa.episodes.plugged import MALFORMED, called, malformed
from tpvqa.errors import EpisodeError, PluginError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, State, Task
from tpvqa.planning import Planner, PlanningResult
from tpvqa.questions import Question, QuestionBook
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.worlds import Execution, Report, Restorable, World

E = TypeVar("E", bound=Event)


class Writer(Protocol):
    """Where events go.

    Attributes:
        resumable: Whether an episode may be gone on with from what was written, so that the
            states of world and VLM belong into the events.
    """

    resumable: bool

    def append(self, event: Event) -> Event:
        """Write an event."""

    def save_frame(self, frame: Any) -> str:
        """Save a picture; its path within the episode."""


class Lost(Exception):  # noqa: N818
    """A log ended in a world that cannot be put back, which may have changed since.

    Whoever meets it looks, and does again what it was about to do.
    """


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


class Recorder:
    """Performs and logs.

    Args:
        parts: Planner, world and VLM.
        writer: Where events go.
        recorded: Events of the episode that is being resumed.
        folder: Where its pictures lie.
        listeners: Told of every event, recorded ones too.
    """

    def __init__(
        self,
        parts: Parts,
        writer: Writer,
        *,
        recorded: Sequence[Event] = (),
        folder: Path | None = None,
        listeners: Sequence[Callable[[Event], None]] = (),
    ):
        self.parts, self._writer, self._folder = parts, writer, folder
        self._recorded, self._listeners = deque(recorded), tuple(listeners)
        self._snapshots: dict[str, Mapping[str, Any]] = {}
        self._replaying, self._unsure = bool(recorded), False
        self._observation: Observation | None = None
        self._questions: dict[Question, QuestionRecord] = {}
        self.questions = self.looks = self.actions = 0

    @property
    def replaying(self) -> bool:
        """Whether recorded events are still to be played back."""
        return bool(self._recorded)

    def emit(self, event: E) -> E:
        """Log an event, or take the recorded one in its place."""
        recorded = self._next(type(event))
        return self._tell(self._writer.append(event) if recorded is None else recorded)  # type: ignore[return-value]

    def end(self, event: E) -> E:
        """Log the last event, whatever was still to be played back."""
        return self._tell(self._writer.append(event))  # type: ignore[return-value]

    def plan(
        self, state: State, *, timeout: float | None, considered: bool = False
    ) -> PlanningResult:
        """A plan from a state, to be followed or only considered.

        Raises:
            Lost: See there.
        """
        self._find()
        record = self._next(PlanMade)
        if record is not None:
            self._tell(record)
            return records.plan_from(record, self.parts.task)
        result = self.parts.planner.plan(self.parts.task, state, timeout=timeout)
        made = records.plan_record(result, state, self.parts.book)
        self._tell(self._writer.append(made.model_copy(update={"considered": considered})))
        return result

    def look(self, view: str | None) -> Observation:
        """A new look at the world.

        Raises:
            Lost: See there.
        """
        self._find()
        number = self.looks
        self.looks += 1
        record = self._next(Observed)
        if record is not None:
            self._tell(record)
            self._observation = records.observation_from(record, self._folder)
            return self._observation
        world = self.parts.world
        seen = called(world, "observe", Observation, view)
        try:
            seen = replace(seen, look=number, frames=_named(seen.frames, number))
            observed = Observed(
                look=seen.look,
                view=view,
                world_time=seen.time,
                frames=tuple(map(self._frame, seen.frames.values())),
                detail=dict(seen.detail),
                snapshot=self._snapshot(world),
            )
        except MALFORMED as error:
            raise malformed(world, "observe", error) from error
        self._tell(self._writer.append(observed))
        self._observation = seen
        return seen

    def _frame(self, frame: Frame) -> FrameRecord:
        return FrameRecord(
            view=frame.view,
            file=self._writer.save_frame(frame),
            media_type=frame.media_type,
            source=frame.source,
        )

    def ask(self, questions: Sequence[Question], *, person: bool = False) -> list[Answer]:
        """Answers to questions about the latest look.

        Raises:
            Lost: See there.
        """
        self._find()
        if self._observation is None:
            self.look(None)
        assert self._observation is not None
        self.questions += len(questions)
        self.emit(
            Asked(
                look=self._observation.look,
                questions=tuple(map(self._question, questions)),
                person=person,
            )
        )
        self._find()
        record = self._next(Answered)
        if record is None:
            asked = self.parts.person if person else self.parts.vlm
            if asked is None:
                text = "nobody is there"
                answers = [Answer(question, Reply.UNKNOWN, text=text) for question in questions]
            else:
                answers = _answers(asked, self._observation, questions)
            try:
                record = records.answered_record(answers, self._snapshot(self.parts.vlm))
            except MALFORMED as error:
                raise malformed(asked, "ask", error) from error
            record = self._writer.append(record)  # type: ignore[assignment]
        self._tell(record)
        return records.answers_from(record, questions)

    def act(
        self, action: Action, *, step: int, attempt: int, deadline: float | None, cancel: Flag
    ) -> Execution:
        """Execute an action; that it is about to be executed is on disk before.

        Raises:
            Lost: See there.
        """
        self._find()
        self.actions += 1
        said = records.action_record(action, self.parts.book)
        self.emit(Acting(step=step, action=said, attempt=attempt))
        interrupted = False
        try:
            self._find()
        except Lost:  # killed in the middle of a skill: what came of it is for a new look
            interrupted = True
        record = self._next(Acted)
        if record is None:
            world = self.parts.world
            before = getattr(world, "last_outcome", None)
            execution = (
                Execution(Report.FAILED, 0.0, "interrupted")
                if interrupted
                else called(world, "execute", Execution, action, deadline=deadline, cancel=cancel)
            )
            try:
                record = Acted(
                    report=execution.report,
                    seconds=execution.seconds,
                    message=execution.message,
                    truth=_truth(world, before),
                    snapshot=self._snapshot(world),
                )
            except MALFORMED as error:
                raise malformed(world, "execute", error) from error
            record = self._writer.append(record)  # type: ignore[assignment]
        assert isinstance(record, Acted)
        self._tell(record)
        if interrupted:
            self.look(None)
        return Execution(record.report, record.seconds, record.message)

    def _next(self, kind: type[E]) -> E | None:
        """The next recorded event, which must be of a kind; None once all are played back."""
        if self._recorded:
            event = self._recorded.popleft()
            if not isinstance(event, kind):
                raise EpisodeError(
                    f"event {event.number} of the log is {event.kind!r} where this version "
                    f"would write {kind.__name__!r}: it cannot be resumed, only shown"
                )
            snapshot = getattr(event, "snapshot", None)
            if snapshot is not None:
                self._snapshots["vlm" if isinstance(event, Answered) else "world"] = snapshot
            return event
        self.settle()
        return None

    def _find(self) -> None:
        """Notice that the world may not be as it was left, from the log or for the log."""
        if self._recorded:
            if isinstance(self._recorded[0], Resumed):
                self._tell(self._recorded.popleft())
                raise Lost
            return
        self.settle()
        if self._unsure:
            self._unsure = False
            self._tell(self._writer.append(Resumed()))
            raise Lost

    def settle(self) -> None:
        """Put world and VLM where the log left them, once it has been played back."""
        if self._replaying and not self._recorded:
            self._replaying = False
            self._unsure = not isinstance(self.parts.world, Restorable)
            for part, snapshot in self._snapshots.items():
                target = getattr(self.parts, part)
                if isinstance(target, Restorable):
                    target.restore(snapshot)

    def _question(self, question: Question) -> QuestionRecord:
        """Questions are asked again and again; what is logged of one is worked out once."""
        record = self._questions.get(question)
        if record is None:
            record = self._questions[question] = records.question_record(question)
        return record

    def _snapshot(self, part: object) -> dict[str, Any] | None:
        if self._writer.resumable and isinstance(part, Restorable):
            return dict(part.snapshot())
        return None

    def _tell(self, event: E) -> E:
        for listener in self._listeners:
            listener(event)
        return event


def _named(frames: Mapping[str, Frame], look: int) -> dict[str, Frame]:
    """The frames of a look, each with the name of the file that it is saved as."""
    return {view: replace(frame, id=f"{look:04d}-{frame.view}") for view, frame in frames.items()}


def _answers(vlm: VLM, seen: Observation, questions: Sequence[Question]) -> list[Answer]:
    """One answer to each question, in order."""
    answers = called(vlm, "ask", list, seen, questions)
    if len(answers) != len(questions) or not all(isinstance(each, Answer) for each in answers):
        kinds = ", ".join(sorted({type(each).__name__ for each in answers})) or "nothing"
        raise PluginError(
            f"{vlm.name} has to give {len(questions)} Answers to {len(questions)} questions, "
            f"and gave {len(answers)} ({kinds})"
        )
    return answers


def _truth(world: World, before: object) -> dict[str, Any] | None:
    """What truly came of the last action; None where it did not happen or nobody knows."""
    outcome = getattr(world, "last_outcome", None)
    if outcome is None or outcome is before:
        return None
    return {
        "succeeded": outcome.succeeded,
        "reason": outcome.reason,
        "undone": None if outcome.undone is None else outcome.undone.pddl(),
        "undoing": outcome.undoing,
        "added": records.atoms(outcome.after - outcome.before),
        "removed": records.atoms(outcome.before - outcome.after),
    }
