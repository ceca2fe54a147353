"""The events of a trial on disk: writing, reading back, following; the report."""

from tpvqa.episodes.following import follow
from tpvqa.episodes.log import EpisodeWriter, MemoryWriter, read_episode

__all__ = ["EpisodeWriter", "MemoryWriter", "follow", "read_episode"]
