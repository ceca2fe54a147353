"""What an episode consists of: files of its folder that nothing else is written in place of."""

from pathlib import Path

from tpvqa.episodes.log import LOG, episode_folder
from tpvqa.episodes.shape import FRAMES
from tpvqa.files import resolved

LABELS = "labels.jsonl"
BENCH = ("episodes.jsonl", "bench.json")
"""What a bench writes in its folder, where no episode lies beside it."""


def belongs_to(path: Path, episode: Path | str) -> bool:
    """Whether a path is that of an episode's log, of its labels or of its pictures.

    Args:
        path: Where something is to be written.
        episode: The episode's folder, or its `episode.jsonl`.
    """
    folder = resolved(episode_folder(episode))
    for place in (resolved(path.parent) / path.name, resolved(path)):
        if folder / FRAMES in (place, *place.parents):
            return True
        if any(same_file(place, folder / name) for name in (LOG, LABELS)):
            return True
    return False


def same_file(one: Path, other: Path) -> bool:
    """Whether two paths lead to one file, which need not be there."""
    try:
        return one.samefile(other)
    except OSError:
        return resolved(one) == resolved(other)
