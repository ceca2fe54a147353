"""Between the objects of a trial and the records of its log, both ways."""

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

from tpvqa.episodes.events import (
    ActionRecord,
    Answered,
    AnswerRecord,
    FrameRecord,
    Observed,
    PlanMade,
    QuestionRecord,
)
from tpvqa.errors import EpisodeError
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, State, Task
from tpvqa.planning import Crashed, Plan, PlanningResult, TimedOut, Unsolvable
from tpvqa.questions import ActionQuestion, FactQuestion, Question, QuestionBook
from tpvqa.vlm import Answer

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
            return record.model_copy(update={"plan": plan, "cost": result.cost})
        case Unsolvable():
            return record.model_copy(update={"result": "unsolvable", "reason": result.reason})
        case TimedOut():
            reason = f"no plan within {result.limit:g} s"
            return record.model_copy(update={"result": "timed out", "reason": reason})
        case Crashed():
            return record.model_copy(update={"result": "crashed", "reason": result.reason})


def plan_from(record: PlanMade, task: Task) -> PlanningResult:
    """A recorded planner's result."""
    planner, seconds = record.planner, record.seconds
    if record.result == "plan":
        actions = tuple(task.action(step.name, step.arguments) for step in record.plan)
        return Plan(actions, record.cost, planner, seconds)
    if record.result == "unsolvable":
        return Unsolvable(record.reason, planner, seconds)
    if record.result == "timed out":
        return TimedOut(seconds, planner, seconds)
    return Crashed(record.reason, planner, seconds)


def question_record(question: Question) -> QuestionRecord:
    """A question as it is logged."""
    match question:
        case FactQuestion(text, way, atom, expected, alike):
            others = tuple(other.pddl() for other in alike) or None
            return QuestionRecord(
                text=text, way=way, atom=atom.pddl(), expected=expected, alike=others
            )
        case ActionQuestion(text, way, action):
            return QuestionRecord(text=text, way=way, action=action.pddl())


def answered_record(answers: Sequence[Answer], snapshot: dict[str, Any] | None) -> Answered:
    """The answers as they are logged, with the state of the VLM that gave them."""
    said = tuple(
        AnswerRecord(**{name: getattr(answer, name) for name in _OF_ANSWERS}) for answer in answers
    )
    return Answered(answers=said, snapshot=snapshot)


def answers_from(record: Answered, questions: Sequence[Question]) -> list[Answer]:
    """Recorded answers to the same questions."""
    if len(record.answers) != len(questions):
        raise EpisodeError("the recorded answers do not fit the questions: another version's log")
    return [
        Answer(question, *(getattr(answer, name) for name in _OF_ANSWERS))
        for question, answer in zip(questions, record.answers, strict=True)
    ]


def observation_from(record: Observed, folder: Path | None) -> Observation:
    """A recorded look, its pictures read from the episode's folder."""
    frames = {}
    for frame in record.frames:
        frames[frame.view] = _frame(frame, folder)
    return Observation(record.look, record.world_time, frames, record.detail)


def _frame(record: FrameRecord, folder: Path | None) -> Frame:
    path = (folder or Path()) / record.file
    try:
        data = path.read_bytes()
    except OSError as error:
        raise EpisodeError(
            f"{path}: the picture of a look cannot be read ({error.strerror})"
        ) from error
    return Frame(path.stem, record.view, data, record.media_type, record.source)
