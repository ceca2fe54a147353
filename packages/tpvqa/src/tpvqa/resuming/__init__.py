"""Going on with an episode that was interrupted or killed."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Event as Flag
from typing import Any, TypeVar

from pydantic import BaseModel, ValidationError

from tpvqa.assembly import Trial
from tpvqa.belief import Calibration
from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.belief.filtering.priors import load_priors
from tpvqa.belief.learning.experience import Experience
from tpvqa.drivers import Listener
from tpvqa.episodes import EpisodeWriter
from tpvqa.episodes.log import episode_folder
from tpvqa.errors import EpisodeError, PlacedError
from tpvqa.events import Ended, Started
from tpvqa.pddl import Task, task_from_text
from tpvqa.questions import QuestionBook
from tpvqa.resuming.naming import NOTHING, config_of
from tpvqa.told import first_fault
from tpvqa.vlm import VLM
from tpvqa.worlds.world_file import load_world_file

__all__ = ["config_of", "resume", "trial_of"]

M = TypeVar("M", bound=BaseModel)


def trial_of(
    started: Started,
    *,
    named: Mapping[str, Any] = NOTHING,
    person: VLM | None = None,
    place: str = "the episode",
    **shared: Any,
) -> Trial:
    """The trial that an episode was started as, with what its monitor was told then.

    Domain, problem, questions, world file and priors are those whose text the log keeps; the files
    that it names are not read.

    Args:
        started: The episode's first event.
        named: What only the user may name, see `config_of`.
        person: Answers where the monitor asks a person.
        place: The episode, as messages name it.
        **shared: What trials share, see `Trial`.

    Raises:
        NotNamedError: As `config_of` does.
        EpisodeError: What the log keeps cannot be read.
    """
    config = config_of(started, named, place=place)
    if "task" not in shared:
        shared["task"] = _task(started, place)
    if not {"book", "rules", "priors"} <= shared.keys():
        shared = {**_texts(started, shared["task"], place), **shared}
    return Trial(
        config,
        calibration=_read(Calibration, started.calibration, place),
        experience=_read(Experience, started.experience, place),
        risk=_read(RiskBound, started.risk, place),
        reading=False,
        person=person,
        begun_as=started,
        **shared,
    )


def resume(
    folder: Path | str,
    *,
    named: Mapping[str, Any] = NOTHING,
    listeners: Sequence[Listener] = (),
    cancel: Flag | None = None,
    person: VLM | None = None,
    then: Callable[[Trial, Ended], None] = lambda trial, ended: None,
) -> Ended:
    """Go on with an unfinished episode, with the same random numbers, to the same end.

    Nobody else can write the episode from before it is read.

    Args:
        folder: The episode's, or its `episode.jsonl`.
        named: What only the user may name, see `config_of`.
        listeners: Told of every event, recorded ones too.
        cancel: Ends it early.
        person: Answers where the monitor asks a person.
        then: Told the trial and how it ended.

    Raises:
        EpisodeError: There is nothing to go on with, it has ended already, it is damaged, or
            another process writes it.
        NotNamedError: The log names an address, a file or an option that is not in `named`.
        WriteError: It cannot be written.
        Interrupted: Ctrl-C. The log is ended first.
    """
    folder = episode_folder(folder)
    writer, events = EpisodeWriter.going_on(folder)
    try:
        started = events[0]
        assert isinstance(started, Started)
        with trial_of(started, named=named, person=person, place=str(folder)) as trial:
            trial.check()
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


def _task(started: Started, place: str) -> Task:
    try:
        return task_from_text(
            started.domain,
            started.problem,
            domain_path=Path(started.domain_file),
            problem_path=Path(started.problem_file),
        )
    except PlacedError as error:
        raise EpisodeError(f"{place}: the log's own text of {error}") from error


def _texts(started: Started, task: Task, place: str) -> dict[str, Any]:
    """Questions, world file and priors, as their readers want them: as files."""
    texts = {"questions": started.questions, "world": started.rules, "priors": started.priors}
    with TemporaryDirectory() as folder:
        paths: list[Path | None] = []
        for name, text in texts.items():
            path = Path(folder) / f"{name}.yaml"
            if text is not None:
                path.write_text(text, encoding="utf-8")
            paths.append(None if text is None else path)
        questions, rules, priors = paths
        try:
            return {
                "book": QuestionBook.load(questions, task),
                "rules": load_world_file(rules, task),
                "priors": load_priors(task, priors, started.config.start.what),
            }
        except PlacedError as error:
            said = str(error).replace(f"{folder}/", "")
            raise EpisodeError(f"{place}: the log's own text of {said}") from error


def _read(kind: type[M], values: dict[str, Any] | None, place: str) -> M | None:
    try:
        return None if values is None else kind.model_validate(values)
    except ValidationError as error:
        first = first_fault(error)
        where = ".".join(map(str, first["loc"]))
        raise EpisodeError(
            f"{place}: the log's {kind.__name__.lower()} is damaged ({where}: {first['msg']}). "
            "Show the episode instead"
        ) from error
