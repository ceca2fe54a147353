"""Trials that are killed and gone on with."""

from pathlib import Path

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import EpisodeWriter, read_episode
from tpvqa.episodes.log import LOG
from tpvqa.events import Event, Started
from tpvqa.planning import Planner
from tpvqa.resuming import trial_of


def story(events: list[Event]) -> list[dict[str, object]]:
    """What happened, whenever it did."""
    return [event.model_dump(exclude={"time", "seconds", "number"}) for event in events]


def unbroken(folder: Path, config: TrialConfig, planner: Planner) -> list[Event]:
    """A whole trial, logged in a folder."""
    with Trial(config, planner=planner) as trial:
        writer = EpisodeWriter(folder, durable=False)
        trial.run(writer, folder=folder)
        writer.close()
    return read_episode(folder)


def resumed(whole: Path, cut: int, planner: Planner, *, torn: bool = False) -> list[Event]:
    """The trial of a folder, killed after so many events and gone on with in another folder.

    Args:
        whole: The folder.
        cut: How many events there are when it is killed.
        planner: The planner.
        torn: Whether half of the next event is in the log.
    """
    folder = whole.with_name(f"cut{cut}")
    folder.mkdir()
    lines = (whole / LOG).read_bytes().splitlines(keepends=True)
    rest = lines[cut][: len(lines[cut]) // 2] if torn else b""
    (folder / LOG).write_bytes(b"".join(lines[:cut]) + rest)
    events = read_episode(folder)
    assert len(events) == cut
    started = events[0]
    assert isinstance(started, Started)
    with trial_of(started, planner=planner) as trial:
        writer = EpisodeWriter(folder, resume=cut, durable=False)
        trial.run(writer, started=started, recorded=events, folder=folder)
        writer.close()
    return read_episode(folder)
