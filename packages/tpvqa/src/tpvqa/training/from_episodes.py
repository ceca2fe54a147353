"""Examples from recorded episodes: labelled by a person, or of a simulated world."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path

from tpvqa.bench.labelled_episodes import label_episodes
from tpvqa.episodes import read_episode
from tpvqa.episodes.log import episode_folder
from tpvqa.events.events import FrameRecord, Observed
from tpvqa.pictures import read_picture
from tpvqa.training.example import Example


@dataclass
class FromEpisodes:
    """What episodes teach.

    Attributes:
        examples: The questions with their right answers.
        untold: Episodes of which nobody said what was right.
        of_several: Answers from several pictures at once, which say of no single one what is right.
    """

    examples: list[Example] = field(default_factory=list)
    untold: int = 0
    of_several: int = 0


def examples_from(
    folders: Iterable[Path | str], *, done: Callable[[], None] = lambda: None
) -> FromEpisodes:
    """The answers of episodes whose truth is known, with the pictures that they are about.

    Args:
        folders: The episodes' folders.
        done: Called after each.

    Raises:
        CalibrationError: Labels are damaged.
        EpisodeError: There is no episode, or it is damaged.
        PictureError: A picture is missing or damaged.
    """
    found = FromEpisodes()
    for folder in dict.fromkeys(map(episode_folder, folders)):
        labelled = label_episodes([folder])
        if labelled.inferred or not labelled.rows:
            found.untold += 1
            done()
            continue
        looks = _looks(folder)
        for row in labelled.rows:
            frames = looks.get(row.look, ())
            if row.view is not None:
                frames = tuple(frame for frame in frames if frame.view == row.view)
            if len(frames) != 1:
                found.of_several += len(frames) > 1
                continue
            data = read_picture(frames[0].file, inside=Path(folder))
            found.examples.append(
                Example(data, frames[0].media_type, row.text, row.truth, row.predicate)
            )
        done()
    return found


def _looks(folder: Path) -> dict[int, tuple[FrameRecord, ...]]:
    return {each.look: each.frames for each in read_episode(folder) if isinstance(each, Observed)}
