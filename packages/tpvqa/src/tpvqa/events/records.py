"""Between the objects of a trial and the records of its log, both ways."""

from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from tpvqa.errors import EpisodeError, PictureError
from tpvqa.events.events import (
    Acted,
    ActionRecord,
    Answered,
    AnswerRecord,
    FrameRecord,
    Observed,
    OutcomeRecord,
    PlanMade,
    QuestionRecord,
    SensedRecord,
)
from tpvqa.events.usage import UsageRecord
from tpvqa.observation import NPY, PNG, Depth, Frame, Intrinsics, Observation, SensedFact
from tpvqa.pddl import Action, Atom, State, Task
from tpvqa.pictures import read_file
from tpvqa.planning import Crashed, Plan, PlanningResult, TimedOut, Unsolvable
from tpvqa.questions import ActionQuestion, FactQuestion, Question, QuestionBook
from tpvqa.vlm import Answer
from tpvqa.vlm.usage import Usage
from tpvqa.worlds import Execution
from tpvqa.worlds.outcome import Outcome

_OF_ANSWERS = tuple(each.name for each in fields(Answer) if each.name != "question")


def atoms(state: State) -> tuple[str, ...]:
    """A state as sorted PDDL atoms."""
    return tuple(atom.pddl() for atom in sorted(state))


def action_record(action: Action, book: QuestionBook) -> ActionRecord:
    """An action with the way it is said."""
    return ActionRecord(name=action.name, arguments=action.arguments, said=book.say(action))


def plan_record(result: PlanningResult, state: State, book: QuestionBook) -> PlanMade:
    """A planner's result."""
    record = PlanMade(
        state=atoms(state), result="plan", planner=result.planner, seconds=result.seconds
    )
    match result:
        case Plan():
            plan = tuple(action_record(action, book) for action in result.actions)
            times = result.times or None
            return record.model_copy(update={"plan": plan, "cost": result.cost, "times": times})
        case Unsolvable():
            return record.model_copy(update={"result": "unsolvable", "reason": result.reason})
        case TimedOut():
            reason = f"no plan within {result.limit:g} s"
            passed = {"result": "timed out", "reason": reason, "limit": result.limit}
            return record.model_copy(update=passed)
        case Crashed():
            return record.model_copy(update={"result": "crashed", "reason": result.reason})


def plan_from(record: PlanMade, task: Task) -> PlanningResult:
    """A recorded planner's result."""
    planner, seconds = record.planner, record.seconds
    if record.result == "plan":
        actions = tuple(task.action(step.name, step.arguments) for step in record.plan)
        return Plan(actions, record.cost, planner, seconds, record.times or ())
    if record.result == "unsolvable":
        return Unsolvable(record.reason, planner, seconds)
    if record.result == "timed out":
        return TimedOut(seconds if record.limit is None else record.limit, planner, seconds)
    return Crashed(record.reason, planner, seconds)


def question_record(question: Question) -> QuestionRecord:
    """A question as it is logged."""
    match question:
        case FactQuestion(text, way, atom, expected, alike, wording):
            others = tuple(other.pddl() for other in alike) or None
            return QuestionRecord(
                text=text,
                way=way,
                atom=atom.pddl(),
                expected=expected,
                alike=others,
                wording=wording or None,
            )
        case ActionQuestion(text, way, action):
            return QuestionRecord(text=text, way=way, action=action.pddl())


def answered_record(
    answers: Sequence[Answer], snapshot: dict[str, Any] | None, usage: Usage | None = None
) -> Answered:
    """The answers as they are logged, with the state of the VLM that gave them and what it took."""
    said = tuple(
        AnswerRecord(**{name: getattr(answer, name) for name in _OF_ANSWERS}) for answer in answers
    )
    taken = None if usage is None else UsageRecord(**asdict(usage))
    return Answered(answers=said, snapshot=snapshot, usage=taken)


def answers_from(record: Answered, questions: Sequence[Question]) -> list[Answer]:
    """Recorded answers to the same questions."""
    if len(record.answers) != len(questions):
        raise EpisodeError("the recorded answers do not fit the questions: another version's log")
    return [
        Answer(question, *(getattr(answer, name) for name in _OF_ANSWERS))
        for question, answer in zip(questions, record.answers, strict=True)
    ]


def outcome_record(outcome: Outcome | None) -> OutcomeRecord | None:
    """What truly came of an action; None where nobody knows."""
    if outcome is None:
        return None
    return OutcomeRecord(
        failure=outcome.failure,
        undone=None if outcome.undone is None else outcome.undone.pddl(),
        undoing=outcome.undoing,
        added=atoms(outcome.after - outcome.before),
        removed=atoms(outcome.before - outcome.after),
    )


def execution_from(record: Acted) -> Execution:
    """What a skill reported, from the record."""
    return Execution(record.report, record.seconds, record.message, facts=sensed_from(record.facts))


def sensed_records(facts: Sequence[SensedFact]) -> tuple[SensedRecord, ...]:
    """What a robot sensed, as it is logged."""
    return tuple(
        SensedRecord(atom=each.atom.pddl(), probability=each.probability) for each in facts
    )


def sensed_from(records: Sequence[SensedRecord]) -> tuple[SensedFact, ...]:
    """What a robot sensed, from the records."""
    return tuple(SensedFact(Atom.parse(each.atom), each.probability) for each in records)


def frame_record(frame: Frame, file: str) -> FrameRecord:
    """A camera image that was saved to a file, and its depth image beside it."""
    return FrameRecord(
        view=frame.view,
        file=file,
        media_type=frame.media_type,
        source=frame.source,
        stamp=frame.stamp,
        intrinsics=None if frame.intrinsics is None else asdict(frame.intrinsics),
        depth=None if frame.depth is None else depth_file(file, frame.depth),
    )


def depth_file(file: str, depth: Depth) -> str:
    """Where the depth image of a picture lies: beside it."""
    return f"{Path(file).with_suffix('')}-depth{depth.suffix}"


def observation_from(record: Observed, folder: Path | None) -> Observation:
    """A recorded look, its pictures read from the episode's folder."""
    frames = {}
    for frame in record.frames:
        frames[frame.view] = _frame(frame, folder)
    return Observation(
        record.look, record.world_time, frames, record.detail, sensed_from(record.facts)
    )


def _frame(record: FrameRecord, folder: Path | None) -> Frame:
    folder = folder or Path()
    depth = None
    if record.depth is not None:
        png = record.depth.endswith(".png")
        depth = Depth(_bytes(folder, record.depth), PNG if png else NPY)
    seen = record.intrinsics
    intrinsics = None
    if seen is not None:
        size = int(seen["width"]), int(seen["height"])
        intrinsics = Intrinsics(seen["fx"], seen["fy"], seen["cx"], seen["cy"], *size)
    return Frame(
        Path(record.file).stem,
        record.view,
        _bytes(folder, record.file),
        record.media_type,
        record.source,
        record.stamp,
        intrinsics,
        depth,
    )


def _bytes(folder: Path, name: str) -> bytes:
    try:
        return read_file(name, inside=folder)
    except PictureError as error:
        raise EpisodeError(
            f"the picture of a look cannot be taken from the episode: {error}"
        ) from error
