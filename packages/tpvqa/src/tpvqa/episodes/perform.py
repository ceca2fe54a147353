"""Does for a monitor what it asks for."""

from typing import Any

from tpvqa.episodes.recorder import Recorder
from tpvqa.monitors import Ask, AskPerson, Check, Look, Verdict
from tpvqa.monitors.requests import PlanFrom


def perform(recorder: Recorder, check: Check, *, timeout: float | None) -> Verdict:
    """Do what a check asks for, until it decides.

    Args:
        recorder: Performs and logs.
        check: A monitor's check.
        timeout: Seconds for one call of the planner.
    """
    answer: Any = None
    while True:
        try:
            request = check.send(answer)
        except StopIteration as end:
            verdict: Verdict = end.value
            return verdict
        match request:
            case Look(view):
                answer = recorder.look(view)
            case Ask(questions):
                answer = recorder.ask(questions)
            case PlanFrom(state):
                answer = recorder.plan(state, timeout=timeout, considered=True)
            case AskPerson(question):
                answer = recorder.ask([question], person=True)[0]
