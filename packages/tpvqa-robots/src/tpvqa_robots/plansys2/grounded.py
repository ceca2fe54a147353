"""One action, done where pictures show that it may, and well done where they show its effects."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import count
from threading import Event

from tpvqa import Trial
from tpvqa.drivers.plugged import called
from tpvqa.observation import Observation
from tpvqa.pddl import Action
from tpvqa.questions import FactQuestion
from tpvqa.vlm import Answer
from tpvqa.vlm.sight import ask_seeing
from tpvqa.worlds import Execution, Report

LOOKS = 3
"""Looks at a scene that tells nothing, as the monitors take."""


class Grounded:
    """Does actions of a task in a world, and asks a VLM before and after.

    Args:
        trial: Gives task, questions, world and VLM; it is not run.
    """

    def __init__(self, trial: Trial):
        self._trial, self._numbers = trial, count(1)

    def perform(
        self, action: Action, cancelled: Event, tell: Callable[[str], None]
    ) -> tuple[bool, str]:
        """Do an action; whether it was well done, and why not.

        Args:
            action: The action.
            cancelled: Set from another thread to stop it.
            tell: Told what it is about.

        Raises:
            TpvqaError: World or VLM cannot go on.
        """
        trial = self._trial
        tell("looks whether it may")
        may, why = self._hold(trial.book.preconditions(action, trial.task.init), cancelled)
        if not may:
            return False, f"not begun: {why}"
        tell(f"acts: {trial.book.say(action)}")
        limit = trial.config.limits.action_seconds
        limits = {"deadline": limit, "cancel": cancelled}
        done = called(trial.world, "execute", Execution, action, **limits)
        if done.report is not Report.DONE:
            return False, f"{done.report}: {done.message}".rstrip(": ")
        tell("looks what came of it")
        holds, why = self._hold(trial.book.effects(action, trial.task.init), cancelled)
        return holds, why or "seen"

    def _hold(self, questions: Sequence[FactQuestion], cancelled: Event) -> tuple[bool, str]:
        """Whether facts are affirmed in one look; an answer that is unknown is neither yes nor no,
        and another look is taken."""
        unknown = ""
        for _ in range(LOOKS if questions else 0):
            if cancelled.is_set():
                return False, "cancelled"
            answers = self._look(questions)
            denied = [each for each in answers if each.agrees is False]
            if denied:
                return False, f"denied: {_named(denied)}"
            open_ones = [each for each in answers if each.agrees is None]
            if not open_ones:
                return True, ""
            unknown = f"unknown after {LOOKS} looks: {_named(open_ones)}"
        return not questions, unknown

    def _look(self, questions: Sequence[FactQuestion]) -> list[Answer]:
        world, vlm = self._trial.world, self._trial.vlm
        seen = called(world, "observe", Observation, None)
        return ask_seeing(vlm, replace(seen, look=next(self._numbers)), questions)


def _named(answers: Sequence[Answer]) -> str:
    return ", ".join(each.question.text for each in answers)
