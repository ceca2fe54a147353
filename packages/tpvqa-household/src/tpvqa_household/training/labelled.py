"""Real photographs with labels: a folder with a `labels.csv`."""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.errors import TpvqaError
from tpvqa.pictures import in_colour, read_picture
from tpvqa_household.training.subjects import Subject

SIDE = 224
COLUMNS: Mapping[Subject, str] = {
    **{
        Subject("fact", "near", (thing,)): column
        for thing, column in (
            ("fridge", "refrigerator"),
            ("sink", "sink"),
            ("tv", "tv"),
            ("table", "table"),
            ("counter", "counter"),
            ("knife", "knife"),
            ("apple", "apple"),
            ("bread", "bread"),
            ("plate", "plate_or_bowl"),
        )
    },
    Subject("fact", "opened", ("fridge",)): "refrigerator_open",
    Subject("fact", "turned_on", ("tv",)): "tv_on",
}
"""The labels' column of each fact; bowls count as plates."""


@dataclass(frozen=True)
class Labelled:
    """Photographs of one part of a folder.

    Attributes:
        pixels: n × 224 × 224 × 3, squeezed as the network squeezes them.
        labels: n × len(`COLUMNS`): 1 true, 0 false, -1 not known.
        groups: What home, product or dish each shows; a group is never split.
        files: Their names.
    """

    pixels: NDArray[np.uint8]
    labels: NDArray[np.int64]
    groups: NDArray[np.str_]
    files: Sequence[str]


def read_labelled(folder: Path, split: str) -> Labelled:
    """Read the photographs of a split.

    Raises:
        TpvqaError: The labels cannot be read, or name no photograph of the split.
    """
    rows = [row for row in read_rows(folder) if row["split"] == split]
    if not rows:
        raise TpvqaError(f"{folder / 'labels.csv'} has no photographs of split {split!r}.")
    values = {"0": 0, "1": 1}
    labels = [[values.get(row[column], -1) for column in COLUMNS.values()] for row in rows]
    return Labelled(
        np.stack([squeezed(folder / row["file"]) for row in rows]),
        np.array(labels, np.int64),
        np.array([row["group"] for row in rows]),
        [row["file"] for row in rows],
    )


def read_rows(folder: Path) -> list[dict[str, str]]:
    """The lines of a folder's `labels.csv`.

    Raises:
        TpvqaError: It cannot be read, or lacks a column.
    """
    file = folder / "labels.csv"
    try:
        with file.open(encoding="utf-8", newline="") as lines:
            rows = list(csv.DictReader(lines))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise TpvqaError(f"{file} cannot be read: {error}") from None
    lacking = {"file", "split", "group", *COLUMNS.values()} - set(rows[0] if rows else ())
    if lacking:
        raise TpvqaError(f"{file} lacks the columns {', '.join(sorted(lacking))}")
    return rows


def squeezed(path: Path) -> NDArray[np.uint8]:
    """A picture as the network squeezes it into its square."""
    picture = in_colour(read_picture(path))
    size = (SIDE, SIDE)
    return np.asarray(picture.resize(size, Image.Resampling.BICUBIC, reducing_gap=3))
