"""Damaged and forged episodes through everything that reads them: told clearly, or as they are."""

from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from io import StringIO
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from tests.cli.mutants import mutants
from tests.cli.test_saying import obeyed
from tests.doubles import configured
from tpvqa.assembly import Trial
from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.bench.recorded_faults import experience_from
from tpvqa.cli.terminal import EpisodeView
from tpvqa.episodes import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.episodes.report import render_report
from tpvqa.errors import TpvqaError
from tpvqa.events import Ended, Event, Started
from tpvqa.monitors.belief import BeliefMonitor
from tpvqa.planning import Planner
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.planning.remembering import Remembering
from tpvqa.resuming import trial_of

EACH = 250
WORLD = {"task": "build_tower", "world": "symbolic", "failure": 0.4, "disturbance": 0.5}
EPISODES = {
    "tpvqa": configured(**WORLD, vlm="oracle:0.8:0.3", monitor="tpvqa", seed=3),
    "belief": configured(**WORLD, vlm="oracle:0.8", monitor="belief", seed=1),
    "images": configured(task="eat_apple", world="images", vlm="oracle:0.8", monitor="tpvqa"),
}


@pytest.fixture(scope="module")
def planner() -> Iterator[Planner]:
    planner = FastDownward()
    yield Remembering(planner)
    planner.close()


@pytest.fixture(scope="module", params=list(EPISODES))
def recorded(
    request: pytest.FixtureRequest, planner: Planner, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, Trial]:
    folder = tmp_path_factory.mktemp(request.param)
    with Trial(EPISODES[request.param], planner=planner) as trial:
        writer = EpisodeWriter(folder, durable=False)
        trial.run(writer, folder=folder)
        writer.close()
    log = folder / LOG
    log.write_bytes(b"".join(log.read_bytes().splitlines(keepends=True)[:80]))
    return folder, trial


def shown(events: list[Event]) -> str:
    file = StringIO()
    view = EpisodeView(Console(file=file, width=100), live=False)
    for event in events:
        view(event)
    return file.getvalue()


def played_back(events: list[Event], folder: Path, told: Trial, planner: Planner) -> None:
    """Go on with an episode up to the first thing that is to be done."""
    started, last = events[0], events[-1]
    assert isinstance(started, Started)
    shared: dict[str, Any] = {"planner": planner}
    known = told.started()
    if [getattr(started, name) for name in _TEXTS] == [getattr(known, name) for name in _TEXTS]:
        shared |= {"task": told.task, "book": told.book, "rules": told.rules}
        if isinstance(told.monitor, BeliefMonitor):
            shared["model"] = told.monitor.belief.model
    with trial_of(started, **shared) as trial:
        before = events[:-1] if isinstance(last, Ended) else events
        trial.stepping(MemoryWriter(), started=started, recorded=before, folder=folder).begin()


_TEXTS = ("domain", "problem", "questions", "rules")


@pytest.mark.parametrize("seed", [1, 2])
def test_a_mutant_is_refused_clearly_or_read_as_any_episode(
    recorded: tuple[Path, Trial], planner: Planner, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder, told = recorded
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    whole = (folder / LOG).read_bytes()
    came: Counter[str] = Counter()
    try:
        for mutant in mutants(whole, EACH, seed):
            (folder / LOG).write_bytes(mutant)
            try:
                events = read_episode(folder)
            except TpvqaError:
                came["refused"] += 1
                continue
            came["read"] += 1
            assert obeyed(shown(events)) == set()
            if came["read"] % 4 == 0:
                render_report(events, folder)
            with suppress(TpvqaError):
                experience_from(label_episodes([folder]).own.acts)
            if came["read"] % 2 == 0:
                with suppress(TpvqaError):
                    played_back(events, folder, told, planner)
    finally:
        (folder / LOG).write_bytes(whole)
    assert came["read"] > EACH / 10
    assert came["refused"] > EACH / 10
