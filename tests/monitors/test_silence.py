"""A VLM that stops answering: the trial ends instead of going on unseen."""

from collections.abc import Sequence
from dataclasses import replace

import pytest

from tests.doubles import configured, known_truth, truthful
from tpvqa.assembly import Trial
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended, Limits
from tpvqa.events.events import Decided
from tpvqa.monitors.silence import ACTIONS, QUESTIONS
from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply
from tpvqa.vlm.protocol import TruthSource


class FallsSilent:
    """Answers so many questions rightly, and none any more, but for every so manyth."""

    name = "falls-silent"

    def __init__(self, truth: TruthSource, *, after: int, reply: Reply, every: int = 0):
        self._truth, self._after, self._reply, self._every = truth, after, reply, every
        self.asked = 0

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        found = list[Answer]()
        for question in questions:
            self.asked += 1
            speaks = self.asked <= self._after or (self._every and self.asked % self._every == 0)
            right = truthful(question, self._truth.holds)
            found.append(Answer(question, right if speaks else self._reply))
        return found


def tried(
    task: str,
    *,
    after: int = 0,
    reply: Reply = Reply.UNKNOWN,
    every: int = 0,
    start: str = "known",
) -> tuple[Ended, str, int]:
    """How a trial ends, the reason of its last decision, and how much was asked."""
    settings = {"task": task, "world": "symbolic", "vlm": "oracle:0.9", "start": start}
    with Trial(configured(**settings, limits=Limits(actions=60), seed=1)) as trial:
        truth = known_truth(trial.world)
        vlm = FallsSilent(truth, after=after, reply=reply, every=every)
        trial.parts = replace(trial.parts, vlm=vlm)
        writer = MemoryWriter()
        ended = trial.run(writer)
    reasons = [event.reason for event in writer.events if isinstance(event, Decided)]
    return ended, reasons[-1], vlm.asked


@pytest.mark.parametrize("reply", [Reply.UNKNOWN, Reply.CANNOT_SEE])
@pytest.mark.parametrize("after", [0, 15])
def test_where_nothing_is_answered_any_more_it_stops_and_says_so(after: int, reply: Reply) -> None:
    ended, reason, asked = tried("serve_breakfast", after=after, reply=reply)
    assert ended.because == "gave up"
    assert not ended.believed_goal
    assert f"no answer to the last {asked - after} questions" in reason
    assert asked - after >= QUESTIONS
    assert ended.actions <= 2 * ACTIONS + after


def test_one_answer_now_and_then_is_enough_to_go_on() -> None:
    ended, reason, _ = tried("eat_apple", every=10)
    assert "no answer to the last" not in reason
    assert ended.actions > ACTIONS


def test_where_nothing_is_known_at_first_and_nothing_answered_nothing_is_done() -> None:
    ended, reason, asked = tried("serve_breakfast", start="unknown")
    assert ended.because == "gave up"
    assert f"no answer to the last {asked} questions" in reason
    assert ended.actions == 0
