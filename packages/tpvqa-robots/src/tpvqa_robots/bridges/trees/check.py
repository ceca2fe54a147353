"""Looks whether facts hold."""

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from threading import Event
from typing import Literal as OneOf

from tpvqa.drivers.plugged import called
from tpvqa.errors import TpvqaError
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Literal, State
from tpvqa.questions import FactQuestion, QuestionBook
from tpvqa.vlm import VLM, Answer
from tpvqa.vlm.capabilities import may_be_asked_side_by_side
from tpvqa.vlm.sight import ask_seeing
from tpvqa.worlds import World
from tpvqa_robots.bridges.jobs import Job, turn
from tpvqa_robots.bridges.trees.library import PATIENCE, Behaviour, Status, reason

LOOKS = 3
"""Looks at a scene that tells nothing: as many as the monitors take by default. Errors of a VLM
last in one scene, so that more would tell little."""


class Check(Behaviour):
    """Looks, and asks a VLM whether facts hold.

    SUCCESS where every fact is affirmed in one look, FAILURE where one is denied. An answer that
    is unknown is neither: it looks again at the next tick, and after `looks` looks that told
    nothing it is FAILURE, as nobody may act on it. A look that broke or took longer than
    `patience` told nothing.

    Args:
        name: Of the behaviour.
        world: What is looked at.
        vlm: Who answers.
        book: The task's questions.
        literals: The facts, or their negations; or else:
        action: The action whose facts they are.
        when: Its preconditions before it, or its effects after it.
        believed: The state that decides which parts of a disjunction and which conditional effects
            are asked about; the problem's initial one by default.
        view: From where to look; None for the default.
        looks: How often to look where answers are unknown.
        patience: Seconds for one look with its answers.

    Raises:
        TpvqaError: A fact is not of the task, or is one that nobody asks about; there is nothing
            to ask, or both an action and literals.
        ValueError: A number is out of its range.

    Attributes:
        questions: What is asked.
        answers: What was answered last.
    """

    def __init__(
        self,
        name: str,
        world: World,
        vlm: VLM,
        book: QuestionBook,
        *,
        literals: Sequence[Literal] = (),
        action: Action | None = None,
        when: OneOf["before", "after"] = "before",
        believed: State | None = None,
        view: str | None = None,
        looks: int = LOOKS,
        patience: float = PATIENCE,
    ):
        super().__init__(name)
        if looks < 1 or patience <= 0:
            raise ValueError("a Check looks at least once, and has some time for it")
        if (action is None) == (not literals):
            raise TpvqaError(f"The Check {name!r} is given either literals or an action.")
        self._world, self._vlm, self._view = world, vlm, view
        self._looks, self._patience = looks, patience
        if action is None:
            self.questions = _about(literals, book, name)
        else:
            state = book.task.init if believed is None else believed
            about = book.preconditions if when == "before" else book.effects
            self.questions = about(action, state)
        if not self.questions:
            raise TpvqaError(
                f"The Check {name!r} has nothing to ask: no camera shows what {action} "
                f"{'needs' if when == 'before' else 'changes'}."
            )
        self.answers: list[Answer] = []
        self._seeing, self._answering = turn("see", world), turn("ask", vlm)
        self._side_by_side = may_be_asked_side_by_side(vlm)
        self._job: Job[list[Answer]] | None = None
        self._told_nothing = 0

    def initialise(self) -> None:
        """Begin the first look."""
        self._told_nothing, self.answers = 0, []
        self._job = Job(self._look, self.name)

    def update(self) -> Status:
        """Whether the look that was begun has told enough."""
        assert self._job is not None
        if not self._job.over and self._job.seconds < self._patience:
            self.feedback_message = f"look {self._told_nothing + 1} of {self._looks}"
            return Status.RUNNING
        try:
            told = self._told(self._job)
        except Exception as error:  # noqa: BLE001 — whatever a plug-in raises, it told nothing
            told, unknown = None, reason(error)
        else:
            unknown = ", ".join(_named(each) for each in self.answers if each.agrees is None)
        if told is not None:
            return Status.SUCCESS if told else Status.FAILURE
        self._told_nothing += 1
        if self._told_nothing < self._looks:
            self.feedback_message = f"unknown, looking again: {unknown}"
            self._job = Job(self._look, self.name)
            return Status.RUNNING
        looks = "1 look" if self._looks == 1 else f"{self._looks} looks"
        self.feedback_message = f"unknown after {looks}: {unknown}"
        return Status.FAILURE

    def terminate(self, new_status: Status) -> None:
        """Drop a look that nobody wants any more."""
        if new_status is Status.INVALID and self._job is not None:
            self._job.drop()
            self._job = None

    def shutdown(self) -> None:
        """The same."""
        self.terminate(Status.INVALID)

    def _told(self, job: Job[list[Answer]]) -> bool | None:
        """Whether the facts hold; None where the answers do not say."""
        if not job.over:
            job.drop()
            raise TimeoutError(f"no answer within {self._patience:g} s")
        self.answers = job.result()
        denied = [each for each in self.answers if each.agrees is False]
        if denied:
            self.feedback_message = f"denied: {', '.join(map(_named, denied))}"
            return False
        if self.answers and all(each.agrees for each in self.answers):
            self.feedback_message = f"affirmed: {', '.join(map(_named, self.answers))}"
            return True
        return None

    def _look(self, dropped: Event) -> list[Answer]:
        vlm = self._answering.waited_for(self._patience, "the VLM")
        with nullcontext() if self._side_by_side else vlm:  # before the look, which is then new
            with self._seeing.waited_for(self._patience, "the camera"):
                if dropped.is_set():
                    return []
                seen = called(self._world, "observe", Observation, self._view)
            # a trial numbers its looks from 0 on: what is asked is not about one of those
            shown = replace(seen, look=-next(self._answering.numbers))
            return ask_seeing(self._vlm, shown, self.questions)


def _about(literals: Sequence[Literal], book: QuestionBook, name: str) -> tuple[FactQuestion, ...]:
    """A question about every literal.

    Raises:
        TpvqaError: One is not of the task, or is not asked about.
    """
    for literal in literals:
        book.task.check_atom(literal.atom)
        why = book.why_not(literal)
        if why is not None:
            raise TpvqaError(f"The Check {name!r}: {literal} is never asked about: {why}.")
    return tuple(dict.fromkeys(book.fact(literal) for literal in literals))


def _named(answer: Answer) -> str:
    said = f" ({answer.text})" if answer.agrees is None and answer.text else ""
    return f"{getattr(answer.question, 'literal', answer.question.text)}{said}"
