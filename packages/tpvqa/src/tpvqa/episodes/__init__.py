"""The events of a trial on disk: writing, reading back, following; the report."""

from tpvqa.episodes.following import follow
from tpvqa.episodes.log import read_episode
from tpvqa.episodes.writing import EpisodeWriter, MemoryWriter

__all__ = ["EpisodeWriter", "MemoryWriter", "follow", "read_episode"]
