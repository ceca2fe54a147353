"""Accuracy on a balanced set: for every action ten observations of its success, ten of failure.

As in the paper's table, and only where the picture shows the answer: after a failed "find the
fridge" the robot may see the fridge all the same, behind the apple it stands before. Effects,
"Was … successful?" and "Did the robot successfully …?" are asked about observations of the action
itself; preconditions and "Is it possible to …?" about those of the action before it in the plan,
which are what the robot sees when it is about to act.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from tpvqa.chance import chance
from tpvqa.monitors.majority import Majority
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Action, Atom, State, Task, load_task
from tpvqa.planning import Plan, Planner
from tpvqa.questions import ActionQuestion, FactQuestion, Question, QuestionBook, Way
from tpvqa.tasks import find_task
from tpvqa.vlm import VLM, Reply
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.metrics import Scored
from tpvqa_household.images.manifest import OUTCOMES, Picture, PictureSet, load_pictures
from tpvqa_household.images.reachable import kind, say_kind
from tpvqa_household.images.visible import mirrored

OBSERVATIONS = 10
"""Of every outcome of every action."""


@dataclass(frozen=True, slots=True)
class Judged:
    """One answer, or one decision by majority, beside the truth.

    Attributes:
        task: The task.
        way: The way of asking.
        scored: The answer; None for a decision.
        right: Whether the answer or the decision is right.
    """

    task: str
    way: Way
    scored: Scored | None
    right: bool


def balanced(vlm: VLM, task_name: str, planner: Planner, *, seed: int = 0) -> Iterator[Judged]:
    """Ask a VLM about the balanced set of a task.

    Args:
        vlm: Looks at pictures.
        task_name: One of the tasks that the shipped pictures show.
        planner: Finds the plan whose actions are asked about.
        seed: Decides which observations are taken where there are more than ten.
    """
    task = load_task(task_name)
    book = QuestionBook.load(find_task(task_name).questions, task)
    plan = planner.plan(task, task.init)
    assert isinstance(plan, Plan)
    pictures = load_pictures(None)
    state, number = task.init, 0
    for place, action in enumerate(plan.actions):
        after = task.apply(state, action)
        following = plan.actions[place + 1] if place + 1 < len(plan.actions) else None
        effects = book.effects(action, state)
        for picture in _observations(pictures, task, action, effects, seed):
            seen = _Seen(picture)
            asked: list[tuple[Way, Sequence[Question], bool]] = [
                (Way.EFFECT, effects, seen.successful(task, action)),
                (Way.SUCCESSFUL, (book.successful(action),), seen.successful(task, action)),
                (Way.DID, (book.did(action),), seen.successful(task, action)),
            ]
            needed = () if following is None else book.preconditions(following, after)
            if following is not None and seen.shown(needed):
                possible = seen.possible(task, following)
                asked += [
                    (Way.PRECONDITION, needed, possible),
                    (Way.POSSIBLE, (book.possible(following),), possible),
                ]
            frame = Frame(f"{number:04d}", "front", pictures.read(picture), source=picture.file)
            yield from _ask(vlm, task_name, Observation(number, 0.0, {"front": frame}), seen, asked)
            number += 1
        state = after


def _observations(
    pictures: PictureSet, task: Task, action: Action, effects: Sequence[FactQuestion], seed: int
) -> Iterator[Picture]:
    said = say_kind(kind(action, task))
    for outcome in OUTCOMES:
        found = [
            picture
            for picture in pictures.manifest.pictures
            for shows in picture.shows
            if (shows.task, shows.action, shows.outcome) == (task.name, said, outcome)
            and _Seen(picture).shown(effects)
        ]
        draw = chance(seed, 0, "balanced set", task.name, action.pddl(), outcome)
        yield from draw.sample(found, min(OBSERVATIONS, len(found)))


class _Seen:
    """What is true in a picture; which hand is which, pictures leave open."""

    def __init__(self, picture: Picture):
        state = picture.true_state
        self._picture = picture
        self._states: tuple[State, ...] = (state, frozenset(map(mirrored, state)))

    def shown(self, questions: Sequence[FactQuestion]) -> bool:
        """Whether the picture shows the answers to questions."""
        show = self._picture.shows_fact
        return all(show(each.atom) or show(mirrored(each.atom)) for each in questions)

    def holds(self, atom: Atom) -> bool:
        return any(atom in state for state in self._states)

    def possible(self, task: Task, action: Action) -> bool:
        return any(task.applicable(state, action) for state in self._states)

    def successful(self, task: Task, action: Action) -> bool:
        return any(task.apply(state, action) == state for state in self._states)


def _ask(
    vlm: VLM,
    task: str,
    observation: Observation,
    seen: _Seen,
    asked: list[tuple[Way, Sequence[Question], bool]],
) -> Iterator[Judged]:
    every = [q for _, questions, _ in asked for q in questions]
    answers = iter(ask_checked(vlm, observation, every))
    for way, questions, truth in asked:
        own = [next(answers) for _ in questions]
        for question, answer in zip(questions, own, strict=True):
            holds = truth if isinstance(question, ActionQuestion) else seen.holds(question.atom)
            scored = Scored(answer.reply, holds, answer.p_yes)
            yield Judged(
                task,
                way,
                scored,
                answer.agrees is not None and (answer.reply is Reply.YES) == holds,
            )
        denied = Majority.TIE_DENIES.denies(own)
        if questions:
            yield Judged(task, way, None, denied is not None and denied != truth)
