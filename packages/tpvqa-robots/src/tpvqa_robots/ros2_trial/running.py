"""One trial for a goal of `RunTask`."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event as Flag
from typing import Any

from tpvqa import Trial
from tpvqa.drivers import Interrupted
from tpvqa.drivers.live import INTERRUPTED
from tpvqa.episodes import EpisodeWriter
from tpvqa.events import Ended, Event
from tpvqa.events.events import Observed
from tpvqa.events.records import observation_from
from tpvqa.observation import Observation
from tpvqa_robots.bridges.steps import PausableTrial

PATIENCE = 300.0
"""Seconds that the VLM may be busy with somebody's question before the trial breaks off."""


@dataclass
class Running:
    """A trial that runs, and what it looked at last.

    Attributes:
        trial: The trial.
        folder: Its episode's.
        seen: Its latest look.
    """

    trial: Trial
    folder: Path
    seen: Observed | None = None

    def latest(self) -> Observation | None:
        """The latest look, with its pictures; None before the first."""
        return None if self.seen is None else observation_from(self.seen, self.folder)


def run(
    running: Running, listener: Callable[[Event], None], cancel: Callable[[Flag], Any]
) -> Ended:
    """Run it to its end.

    Args:
        running: The trial.
        listener: Told of every event.
        cancel: Given what has to be set to end it early.

    Raises:
        Interrupted: Ctrl-C; the log is ended first.
        TpvqaError: World, planner or VLM cannot go on; what was logged is whole.
    """

    def listen(event: Event) -> None:
        if isinstance(event, Observed):
            running.seen = event
        listener(event)

    running.trial.check()
    with _writer(running.folder) as writer:
        trial = PausableTrial(running.trial, writer, patience=PATIENCE, listeners=(listen,))
        cancel(trial.pause)
        try:
            trial.begin()
            while trial.ended is None and not trial.pause.is_set():
                trial.step()
            trial.end()
        except KeyboardInterrupt:
            trial.end(INTERRUPTED)
            if trial.ended is None:  # it had not begun
                raise
            raise Interrupted(trial.ended) from None
    assert trial.ended is not None
    return trial.ended


@contextmanager
def _writer(folder: Path) -> Iterator[EpisodeWriter]:
    writer = EpisodeWriter(folder)
    try:
        yield writer
    finally:
        writer.close()
