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
from tpvqa.errors import PluginError, WorldError
from tpvqa.events import Ended
from tpvqa.observation import Observation
from tpvqa.planning import Crashed
from tpvqa.questions import Question
from tpvqa.vlm import Answer, Reply

PRESSED = "emergency stop; the robot stands"
SLOW = 30.0
"""Seconds that an answer takes."""


class _Slow:
    """Something that takes its time: `asked` is set once it is wanted."""

    name = "slow"

    def __init__(self) -> None:
        self.asked, self.over = Event(), Event()

    def wait(self) -> None:
        self.asked.set()
        self.over.wait(SLOW)


class _SlowVLM(_Slow):
    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        self.wait()
        return [Answer(each, Reply.YES) for each in questions]


class _SlowPlanner(_Slow):
    def plan(self, *_: object, **__: object) -> Crashed:
        self.wait()
        return Crashed("it was too late", self.name, 0.0)

    def close(self) -> None:
        pass


class _BrokenVLM:
    name = "broken"

    def ask(self, observation: Observation, questions: Sequence[Question]) -> list[Answer]:
        raise WorldError("it is broken")


@pytest.fixture
def vlm() -> Iterator[_SlowVLM]:
    slow = _SlowVLM()
    yield slow
    slow.over.set()


def _trial(halted: Callable[[], str], **parts: object) -> Trial:
    config = TrialConfig().but(
        task={"name": "eat_apple"},
        world={"spec": "symbolic"},
        vlm={"spec": "oracle:1"},
        monitor={"spec": "tpvqa"},
    )
    trial = Trial(config, **parts)  # type: ignore[arg-type]
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
@pytest.mark.parametrize("what", ["ask", "plan", "look"])
def test_a_stop_ends_the_trial_whatever_takes_its_time(
    what: str, run: Callable[[Trial, EpisodeWriter], None], tmp_path: Path
) -> None:
    pressed = Event()
    slow = _SlowPlanner() if what == "plan" else _SlowVLM()
    parts = {"ask": {"vlm": slow}, "plan": {"planner": slow}, "look": {}}[what]
    with _trial(lambda: PRESSED if pressed.is_set() else "", **parts) as trial:
        if what == "look":
            observe = trial.world.observe

            def late(view: str | None = None) -> Observation:
                slow.wait()
                return observe(view)

            trial.world.observe = late  # type: ignore[method-assign]
        writer = EpisodeWriter(tmp_path, durable=False)
        running = Thread(target=run, args=(trial, writer))
        running.start()
        assert slow.asked.wait(20)
        began = time.monotonic()
        pressed.set()
        running.join(SLOW)
        took = time.monotonic() - began
        writer.close()
        slow.over.set()
    assert took < 1.0  # .2 s and what a busy machine takes: nobody waited for the answer
    end = list(read_episode(tmp_path))[-1]
    assert isinstance(end, Ended)
    assert (end.because, end.message, end.completed) == ("world refused", PRESSED, False)


def test_a_world_that_cannot_say_whether_it_is_stopped_is_named(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    with _trial(lambda: None) as trial, pytest.raises(PluginError, match="halted has to return"):  # type: ignore[arg-type,return-value]
        trial.run(writer)
    writer.close()


def test_what_is_stopped_already_is_not_even_looked_at(vlm: _SlowVLM, tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    with _trial(lambda: PRESSED, vlm=vlm) as trial:
        ended = trial.run(writer)
    writer.close()
    assert (ended.because, ended.message) == ("world refused", PRESSED)
    assert not vlm.asked.is_set()


def test_what_breaks_meanwhile_is_told_as_ever(tmp_path: Path) -> None:
    writer = EpisodeWriter(tmp_path, durable=False)
    with (
        _trial(lambda: "", vlm=_BrokenVLM()) as trial,
        pytest.raises(WorldError, match="is broken"),
    ):
        trial.run(writer)
    writer.close()
