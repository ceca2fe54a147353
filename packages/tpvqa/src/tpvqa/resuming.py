"""Going on with an episode that was interrupted or killed."""

from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Event as Flag
from typing import Any, TypeVar

from pydantic import BaseModel

from tpvqa.belief import Calibration
from tpvqa.belief.experience import Experience
from tpvqa.episodes import Ended, EpisodeWriter, Event, Started, read_episode
from tpvqa.errors import EpisodeError
from tpvqa.trial import Trial, TrialConfig
from tpvqa.vlm import VLM

M = TypeVar("M", bound=BaseModel)


def config_of(started: Started) -> TrialConfig:
    """The configuration that an episode was started with."""
    settings = started.settings
    shipped = settings["shipped_task"]
    return TrialConfig(
        task=shipped,
        domain=None if shipped else started.domain_file,
        problem=None if shipped else started.problem_file,
        questions=settings["own_questions"],
        world_file=settings["own_world_file"],
        monitor=started.monitor,
        vlm=started.vlm,
        world=started.world,
        planner=settings["planner"],
        seed=started.seed,
        episode=started.episode,
        failure=settings["failure"],
        disturbance=settings["disturbance"],
        spontaneous=settings["spontaneous"],
        limits=started.limits,
        planning_timeout=settings["planning_timeout"],
        action_deadline=settings["action_deadline"],
        calibration=_read(Calibration, settings.get("calibration")),
        experience=_read(Experience, settings.get("experience")),
        experience_file=settings.get("experience_file"),
        options=settings["options"],
    )


def _same_files(then: Started, now: Started) -> None:
    for part, file in (
        ("domain", now.domain_file),
        ("problem", now.problem_file),
        ("questions", now.questions_file),
        ("rules", now.world_file),
    ):
        if getattr(then, part) != getattr(now, part):
            raise EpisodeError(
                f"{file} has changed since the episode began: it cannot be resumed, only shown"
            )


def resume(
    folder: Path | str,
    *,
    listeners: Sequence[Callable[[Event], None]] = (),
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
    if isinstance(last, Ended) and last.because != "cancelled":
        raise EpisodeError(f"{folder}: the episode has ended ({last.because}); show it instead")
    if isinstance(last, Ended):
        events.pop()
    folder = Path(folder)
    with Trial(config_of(started), person=person) as trial:
        _same_files(started, trial.started())
        trial.check()
        writer = EpisodeWriter(folder, resume=len(events))
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


def _read(kind: type[M], values: dict[str, Any] | None) -> M | None:
    return None if values is None else kind.model_validate(values)
