"""The service `Ask`: a question to the VLM about the latest picture."""

import math
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from tpvqa import Trial
from tpvqa.drivers.plugged import called
from tpvqa.errors import TpvqaError
from tpvqa.observation import Observation
from tpvqa.pddl import Atom, Literal
from tpvqa.questions import FactQuestion, QuestionBook
from tpvqa.vlm.capabilities import may_be_asked_side_by_side
from tpvqa.vlm.sight import ask_seeing
from tpvqa_robots.bridges.jobs import turn
from tpvqa_robots.ros2.typed import stamped
from tpvqa_robots.ros2_trial.running import Running

PATIENCE = 60.0
"""Seconds that the VLM may be busy with the trial's own questions."""
_NOT = "(not "


class Asking:
    """Answers questions about the trial that runs; where none does, about what the robot sees now.

    Args:
        standing: The trial that runs; None where none does.
        fresh: A trial that is not run, of whose world a look is taken; nobody else has the robot
            meanwhile.
    """

    def __init__(
        self,
        standing: Callable[[], Running | None],
        fresh: Callable[[], AbstractContextManager[Trial]],
    ):
        self._standing, self._fresh = standing, fresh

    def answer(self, request: Any, response: Any) -> Any:
        """Answer a request of the service; what goes wrong is said in the response."""
        response.p_yes = math.nan
        try:
            self._answer(request, response)
        except TpvqaError as error:
            response.message = str(error)
        except TimeoutError as error:
            response.message = str(error)
        return response

    def _answer(self, request: Any, response: Any) -> None:
        running = self._standing()
        if running is None:
            with self._fresh() as trial:
                seen = called(trial.world, "observe", Observation, request.view or None)
                self._ask(trial, seen, request.fact, response)
            return
        latest = running.latest()
        if latest is None:
            raise TpvqaError("The trial has not looked yet.")
        if request.view and request.view not in latest.frames:
            shown = ", ".join(latest.frames) or "nothing"
            raise TpvqaError(f"The latest look shows {shown}, not {request.view!r:.60}.")
        self._ask(running.trial, latest, request.fact, response)

    def _ask(self, trial: Trial, seen: Observation, fact: str, response: Any) -> None:
        vlm, question = trial.vlm, _question(fact, trial.book)
        busy = turn("ask", vlm).waited_for(PATIENCE, "the VLM")
        with nullcontext() if may_be_asked_side_by_side(vlm) else busy:
            (answer,) = ask_seeing(vlm, seen, [question])
        response.answered, response.question = True, question.text
        response.reply, response.text = answer.reply.value, answer.text
        if answer.p_yes is not None:
            response.p_yes = float(answer.p_yes)
        stamp = seen.detail.get("stamp")
        if isinstance(stamp, int | float):
            stamped(response.seen, float(stamp))


def _question(text: str, book: QuestionBook) -> FactQuestion:
    """The question about a fact as PDDL writes it, or its negation.

    Raises:
        TpvqaError: It is no fact of the task, or is never asked about.
    """
    said = text.strip()
    positive = not said.startswith(_NOT)
    inner = said if positive else said.removeprefix(_NOT).removesuffix(")")
    if not inner.strip("() "):
        raise TpvqaError("Ask about a fact as PDDL writes it, e.g. (on toy_eggplant table).")
    literal = Literal(Atom.parse(inner), positive)
    book.task.check_atom(literal.atom)
    why = book.why_not(literal)
    if why is not None:
        raise TpvqaError(f"{text} is never asked about: {why}.")
    return book.fact(literal)
