"""Whoever presses an emergency stop is not kept waiting by a VLM that takes its time."""

import asyncio
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from threading import Event, Thread

import pytest

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.errors import WorldError
from tpvqa.events import Ended
from tpvqa.observation import Observation
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply

PRESSED = "emergency stop; the robot stands"
SLOW = 30.0
"""Seconds that an answer takes."""


class _SlowVLM:
    name = "slow"

    def __init__(self) -> None:
        self.asked, self.over = Event(), Event()

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.asked.set()
        self.over.wait(SLOW)
        return [Answer(each, Reply.YES) for each in questions]


class _BrokenVLM:
    name = "broken"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        raise WorldError("it is broken")


@pytest.fixture
def vlm() -> Iterator[_SlowVLM]:
    slow = _SlowVLM()
    yield slow
    slow.over.set()


def _trial(vlm: object, halted: Callable[[], str]) -> Trial:
    config = TrialConfig().but(
        task={"name": "eat_apple"},
        world={"spec": "symbolic"},
        vlm={"spec": "oracle:1"},
        monitor={"spec": "tpvqa"},
    )
    trial = Trial(config, vlm=vlm)  # type: ignore[arg-type]
    trial.world.halted = halted  # type: ignore[attr-defined]
    return trial


def _live(trial: Trial, writer: EpisodeWriter) -> None:
    trial.run(writer)


def _asynchronous(trial: Trial, writer: EpisodeWriter) -> None:
    async def through() -> None:
        async for _ in trial.asynchronous(writer).events():
            pass

    asyncio.run(through())


@pytest.mark.parametrize("run", [_live, _asynchronous])
def test_a_stop_ends_the_trial_while_the_vlm_is_asked(
    run: Callable[[Trial, EpisodeWriter], None], vlm: _SlowVLM, tmp_path: Path
) -> None:
    pressed = Event()
    with _trial(vlm, lambda: PRESSED if pressed.is_set() else "") as trial:
        writer = EpisodeWriter(tmp_path, durable=False)
        running = Thread(target=run, args=(trial, writer))
        running.start()
        assert vlm.asked.wait(20)
        began = time.monotonic()
        pressed.set()
        running.join(SLOW)
        took = time.monotonic() - began
        writer.close()
    assert took < SLOW / 6  # busy machines take their time, but nobody waited for the answer
    end = list(read_episode(tmp_path))[-1]
    assert isinstance(end, Ended)
    assert (end.because, end.message, end.completed) == ("world refused", PRESSED, False)


def test_what_is_stopped_already_is_not_even_looked_at(vlm: _SlowVLM, tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    with _trial(vlm, lambda: PRESSED) as trial:
        ended = trial.run(writer)
    writer.close()
    assert (ended.because, ended.message) == ("world refused", PRESSED)
    assert not vlm.asked.is_set()


def test_what_breaks_meanwhile_is_told_as_ever(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    with _trial(_BrokenVLM(), lambda: "") as trial, pytest.raises(WorldError, match="is broken"):
        trial.run(writer)
    writer.close()
