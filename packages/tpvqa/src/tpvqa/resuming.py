"""Going on with an episode that was interrupted or killed."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Event as Flag
from typing import Any, TypeVar

from pydantic import BaseModel

from tpvqa.assembly import Trial
from tpvqa.belief import Calibration
from tpvqa.belief.experience import Experience
from tpvqa.config import TrialConfig
from tpvqa.drivers import Listener
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.errors import EpisodeError
from tpvqa.events import Ended, Started
from tpvqa.vlm import VLM

M = TypeVar("M", bound=BaseModel)


def config_of(started: Started) -> TrialConfig:
    """The configuration that an episode was started with, names that were left open filled in."""
    return started.config.but(vlm={"spec": started.vlm}, world={"spec": started.world})


def trial_of(started: Started, *, person: VLM | None = None, **shared: Any) -> Trial:
    """The trial that an episode was started as, with what its monitor was told then.

    Args:
        started: The episode's first event.
        person: Answers where the monitor asks a person.
        **shared: What trials share, see `Trial`.
    """
    return Trial(
        config_of(started),
        calibration=_read(Calibration, started.calibration),
        experience=_read(Experience, started.experience),
        reading=False,
        person=person,
        **shared,
    )


def resume(
    folder: Path | str,
    *,
    listeners: Sequence[Listener] = (),
    cancel: Flag | None = None,
    person: VLM | None = None,
    then: Callable[[Trial, Ended], None] = lambda trial, ended: None,
) -> Ended:
    """Go on with an unfinished episode, with the same random numbers, to the same end.

    Args:
        folder: The episode's.
        listeners: Told of every event, recorded ones too.
        cancel: Ends it early.
        person: Answers where the monitor asks a person.
        then: Told the trial and how it ended.

    Raises:
        EpisodeError: There is nothing to go on with, it has ended already, or a file that it
            was started with is no longer what it was.
        Interrupted: Ctrl-C. The log is ended first.
    """
    events = read_episode(folder)
    started, last = events[0], events[-1]
    assert isinstance(started, Started)
    if isinstance(last, Ended):
        if last.because != "cancelled":
            raise EpisodeError(f"{folder}: the episode has ended ({last.ending}); show it instead")
        events.pop()
    folder = Path(folder)
    with trial_of(started, person=person) as trial:
        _same_files(started, trial.started())
        trial.check()
        writer = EpisodeWriter(folder, resume=len(events), time=events[-1].time)
        try:
            ended = trial.run(
                writer,
                started=started,
                recorded=events,
                folder=folder,
                listeners=listeners,
                cancel=cancel,
            )
            then(trial, ended)
            return ended
        finally:
            writer.close()


def _same_files(then: Started, now: Started) -> None:
    for what, before, after in (
        (now.domain_file, then.domain, now.domain),
        (now.problem_file, then.problem, now.problem),
        (now.questions_file, then.questions, now.questions),
        (now.world_file, then.rules, now.rules),
    ):
        if before != after:
            raise EpisodeError(
                f"{what} has changed since the episode began: it cannot be resumed, only shown"
            )


def _read(kind: type[M], values: dict[str, Any] | None) -> M | None:
    return None if values is None else kind.model_validate(values)
