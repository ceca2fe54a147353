"""Every step of a trial as a typed event on disk; reading back, resuming."""

from tpvqa.episodes.events import EVENT, Ended, Event, Limits, Resumed, Started
from tpvqa.episodes.log import EpisodeWriter, MemoryWriter, read_episode
from tpvqa.episodes.recorder import Parts, Recorder

__all__ = [
    "EVENT",
    "Ended",
    "EpisodeWriter",
    "Event",
    "Limits",
    "MemoryWriter",
    "Parts",
    "Recorder",
    "Resumed",
    "Started",
    "read_episode",
]
