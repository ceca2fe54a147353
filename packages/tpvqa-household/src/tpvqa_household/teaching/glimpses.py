"""What the frozen branch makes of a user's pictures, kept on disk piece by piece."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from tpvqa.errors import PictureError, TrainingError
from tpvqa.files import read_plain, write_whole
from tpvqa.pictures import in_colour
from tpvqa.training.example import Example
from tpvqa.training.stopping import between_steps
from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.taught.arrays import MOST_BYTES, packed, unpacked
from tpvqa_household.embedded.taught.sight import KIND, SIZE, Sees, glimpsed
from tpvqa_household.teaching.variants import variant

MOST_VIEWS = 600
"""In all, where each picture is seen more than once; more cost time, and help no more."""
PIECE = 64
"""Views in one file."""
_ROOM = "Make room, or name another folder with --out"


def views_of(pictures: int, epochs: int) -> int:
    """How often each picture is seen: more views help where pictures are few."""
    return max(1, min(epochs, MOST_VIEWS // pictures))


def glimpses(
    branch: Sees,
    pictures: Sequence[Example],
    folder: Path,
    *,
    views: int,
    seed: int,
    done: Callable[[int], None],
) -> tuple[Floats, Floats]:
    """The features of pictures; what an earlier call with the same left in the folder is taken.

    Args:
        branch: The frozen branch.
        pictures: One example of each.
        folder: Where they are kept.
        views: How often each is seen: as it is, and then as `variant` has it.
        seed: Of the views.
        done: Told how many views are done.

    Returns:
        views × n × `SIZE` features, and the n × `KIND` by which kinds of pictures are told, as they
        are.

    Raises:
        TrainingError: A picture, or what was kept, is damaged.
        WriteError: It cannot be kept.
        KeyboardInterrupt: Ctrl-C, after everything was kept.
    """
    found: list[tuple[Floats, Floats]] = []
    every = [(each, number) for number in range(views) for each in pictures]
    with between_steps() as stop:
        for first in range(0, len(every), PIECE):
            piece = every[first : first + PIECE]
            path = folder / f"pictures-{first:06d}.npz"
            rows = _kept(path, len(piece))
            had = len(rows)
            for each, number in piece[had:]:
                if stop():
                    break
                rows.append(_seen(branch, each, number, seed))
                done(first + len(rows))
            if len(rows) > had:
                _keep(path, rows)
            if stop():
                raise KeyboardInterrupt
            done(first + len(rows))
            found += rows
    features = np.stack([row for row, _ in found]).reshape(views, len(pictures), SIZE)
    return features, np.stack([kind for _, kind in found[: len(pictures)]])


def _seen(branch: Sees, example: Example, number: int, seed: int) -> tuple[Floats, Floats]:
    try:
        picture = in_colour(example.data)
    except PictureError as error:
        raise TrainingError(f"A picture {error}") from error
    return glimpsed(branch, np.asarray(variant(picture, example.picture, number, seed)))


def _keep(path: Path, rows: Sequence[tuple[Floats, Floats]]) -> None:
    features, kinds = (np.stack(each) for each in zip(*rows, strict=True))
    data = packed({"features": features, "kinds": kinds})
    write_whole(path, data, remedy=_ROOM, durable=True)


def _kept(path: Path, most: int) -> list[tuple[Floats, Floats]]:
    if not path.is_file():
        return []
    try:
        arrays = unpacked(read_plain(path, most=MOST_BYTES))
        features, kinds = arrays["features"], arrays["kinds"]
        if features.shape[1:] != (SIZE,) or kinds.shape != (len(features), KIND):
            raise ValueError("it holds other features")
        if len(features) > most:
            raise ValueError("it holds more pictures")
    except (OSError, ValueError, KeyError) as error:
        raise TrainingError(
            f"{path} is damaged ({error}). Remove its folder to begin anew"
        ) from error
    return list(zip(features, kinds, strict=True))
