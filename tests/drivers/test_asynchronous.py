"""A trial beside other tasks: it can be killed anywhere, and looked at while it acts."""

import asyncio
import contextlib
import time
from collections.abc import Iterator
from pathlib import Path
from threading import Event as Flag
from typing import Any

import pytest

from tests.doubles import configured
from tests.moments import moments
from tests.resumed import story
from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.drivers.asynchronous import AsynchronousTrial
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.errors import TpvqaError
from tpvqa.events import Ended, Event, Started
from tpvqa.events.events import Acted, Acting, Observed
from tpvqa.monitors.belief import BeliefMonitor
from tpvqa.pddl import Action
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.resuming import trial_of
from tpvqa.worlds import Execution
from tpvqa.worlds.symbolic import SymbolicWorld

CONFIG = configured(
    task="build_tower", world="symbolic", vlm="oracle:0.85:0.3", seed=11, monitor="tpvqa"
)


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = Remembering(FastDownward())
    yield planner
    planner.close()


def run(trial: Trial, writer: EpisodeWriter | MemoryWriter, **more: object) -> list[Event]:
    async def through() -> list[Event]:
        running = trial.asynchronous(writer, **more)  # type: ignore[arg-type]
        return [event async for event in running.events()]

    return asyncio.run(through())


def test_it_is_the_trial_that_the_live_driver_runs(planner: Planner) -> None:
    writer = MemoryWriter()
    with Trial(CONFIG, planner=planner) as trial:
        trial.run(writer)
    with Trial(CONFIG, planner=planner) as trial:
        assert story(run(trial, MemoryWriter())) == story(writer.events)


@pytest.mark.parametrize(
    ("monitor", "vlm"), [("tpvqa", "oracle:0.85:0.3"), ("belief", "oracle:0.95:0.3")]
)
def test_killed_after_any_event_it_is_gone_on_with_to_the_same_end(
    tmp_path: Path, planner: Planner, monitor: str, vlm: str
) -> None:
    config = CONFIG.but(monitor={"spec": monitor}, vlm={"spec": vlm}, seed=1)
    writer = EpisodeWriter(tmp_path / "whole", durable=False)
    with Trial(config, planner=planner) as trial:
        whole = run(trial, writer, folder=tmp_path / "whole")
        shared: dict[str, Any] = {"task": trial.task}
        if isinstance(trial.monitor, BeliefMonitor):
            shared["model"] = trial.monitor.belief.model
    writer.close()
    lines = (tmp_path / "whole" / LOG).read_bytes().splitlines(keepends=True)
    assert len(lines) == len(whole) > 20
    for cut in moments([event.kind for event in whole], spread=2):
        folder = tmp_path / f"cut{cut}"
        folder.mkdir()
        (folder / LOG).write_bytes(b"".join(lines[:cut]))
        events = read_episode(folder)
        started = events[0]
        assert isinstance(started, Started)
        with trial_of(started, planner=planner, **shared) as trial:
            writer = EpisodeWriter(folder, resume=cut, durable=False)
            run(trial, writer, started=started, recorded=events, folder=folder)
            writer.close()
        assert story(read_episode(folder)) == story(whole), cut


class Slow(SymbolicWorld):
    """Takes its time over every action, unless it is cancelled."""

    def execute(
        self, action: Action, *, deadline: float | None = None, cancel: Flag | None = None
    ) -> Execution:
        assert cancel is not None
        cancel.wait(0.05)
        return super().execute(action, deadline=deadline, cancel=cancel)


def slow(planner: Planner, config: TrialConfig = CONFIG) -> Trial:
    trial = Trial(config, planner=planner)
    assert trial.simulation is not None
    world = Slow(trial.simulation)
    trial.parts.world = world
    return trial


def test_a_look_can_be_taken_while_an_action_runs(planner: Planner, tmp_path: Path) -> None:
    """It is in the log between the action's begin and its end, and changes nothing else."""
    config = CONFIG.but(vlm={"spec": "oracle"})
    folder = tmp_path / "e"
    writer = EpisodeWriter(folder, durable=False)

    async def watched() -> list[Event]:
        running, told = trial.asynchronous(writer, folder=folder), list[Event]()
        async for event in running.events():
            told.append(event)
            if isinstance(event, Acting):
                seen = await running.look()
                assert seen is not None
                assert seen.look == event_looks(told)
        assert await running.look() is None  # nothing is running any more
        with pytest.raises(TpvqaError, match="has run already"):
            await anext(running.events())
        return told

    def event_looks(told: list[Event]) -> int:
        return sum(isinstance(event, Observed) for event in told)

    with slow(planner, config) as trial:
        told = asyncio.run(watched())
    writer.close()
    during = [n for n, event in enumerate(told) if isinstance(event, Observed) and event.during]
    assert during
    for n in during:
        assert isinstance(told[n - 1], Acting)
        assert isinstance(told[n + 1], Acted)
    with Trial(config, planner=planner) as trial:
        trial.run(alone := MemoryWriter())
    said = ("decided", "acting", "believed", "plan made")
    assert [e for e in story(told) if e["kind"] in said] == [
        e for e in story(alone.events) if e["kind"] in said
    ]
    cut = during[-1] + 1  # killed while that action ran
    lines = (folder / LOG).read_bytes().splitlines(keepends=True)
    (folder / LOG).write_bytes(b"".join(lines[:cut]))
    events = read_episode(folder)
    with Trial(config, planner=planner) as trial:
        writer = EpisodeWriter(folder, resume=cut, durable=False)
        ended = trial.run(writer, recorded=events, folder=folder)
        writer.close()
    assert (ended.because, ended.completed) == ("goal", True)


def test_whoever_leaves_has_stopped_the_trial(planner: Planner) -> None:
    writer = MemoryWriter()

    async def leave() -> float:
        async with trial.asynchronous(writer) as running:
            async for event in running.events():
                if isinstance(event, Acting):
                    break
            began = time.monotonic()
        return time.monotonic() - began

    with slow(planner) as trial:
        waited = asyncio.run(leave())
    ended = writer.events[-1]
    assert isinstance(ended, Ended)
    assert ended.because == "cancelled"
    assert isinstance(writer.events[-2], Acted)
    assert waited < 2


def test_a_loop_that_shuts_down_leaves_no_robot_acting(planner: Planner) -> None:
    writer, tasks = MemoryWriter(), list[object]()

    async def consume(running: AsynchronousTrial) -> None:
        async for _ in running.events():
            pass

    async def main() -> None:
        tasks.append(asyncio.create_task(consume(trial.asynchronous(writer))))
        while not any(isinstance(event, Acting) for event in writer.events):
            await asyncio.sleep(0.001)

    with slow(planner) as trial:
        asyncio.run(main())
    assert [event.kind for event in writer.events[-2:]] == ["acted", "ended"]


def test_a_look_that_is_given_up_is_still_one_look(planner: Planner) -> None:
    writer = MemoryWriter()

    async def impatient() -> None:
        async with trial.asynchronous(writer) as running:
            async for event in running.events():
                if isinstance(event, Acting):
                    with contextlib.suppress(TimeoutError):
                        await asyncio.wait_for(running.look(), 1e-4)

    with slow(planner) as trial:
        asyncio.run(impatient())
    looks = [event.look for event in writer.events if isinstance(event, Observed)]
    assert looks == list(range(len(looks)))


def test_trials_run_beside_each_other_as_they_do_alone(planner: Planner) -> None:
    config = CONFIG.but(monitor={"spec": "belief"}, vlm={"spec": "oracle:0.95:0.3"})
    configs = [config.but(episode=n) for n in range(3)]

    async def one(config: TrialConfig) -> list[dict[str, object]]:
        with Trial(config, planner=planner) as trial:
            running = trial.asynchronous(MemoryWriter())
            return story([event async for event in running.events()])

    async def together() -> list[list[dict[str, object]]]:
        return await asyncio.gather(*map(one, configs))

    assert asyncio.run(together()) == [asyncio.run(one(config)) for config in configs]


def test_what_breaks_reaches_whoever_listens(planner: Planner) -> None:
    class Broken(Slow):
        def execute(self, action: Action, **_: object) -> Execution:
            raise OSError("no arm")

    trial = Trial(CONFIG, planner=planner)
    assert trial.simulation is not None
    trial.parts.world = Broken(trial.simulation)
    with trial, pytest.raises(TpvqaError, match="no arm"):
        run(trial, MemoryWriter())
