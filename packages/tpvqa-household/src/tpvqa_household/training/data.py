"""All pictures of a folder, with the right answers to everything that can be asked."""

from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tpvqa.pddl import Action
from tpvqa.questions.question import Way
from tpvqa_household.training import shards
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.labels import Label, Labels
from tpvqa_household.training.subjects import Subject


def in_words(shard: shards.Shard) -> FactTable:
    """The facts of a part, with near(x) as its question means it: x is in the picture.

    The robot is near one thing only, but asked "Is there a table in the image?" of a table in the
    background the right word is yes.
    """
    from tpvqa_household.kitchen.truth import ENOUGH, NOTHING

    true, visible = shard.table.true.copy(), shard.table.visible.copy()
    for i, atom in enumerate(shard.table.atoms):
        if atom.predicate == "near":
            thing = atom.arguments[0]
            counts = np.array([info["pixels"].get(thing, 0) for info in shard.info])
            true[:, i] = counts >= ENOUGH[thing]
            visible[:, i] = true[:, i] | (counts <= NOTHING)
    return FactTable(shard.table.atoms, true, visible)


class Pictures:
    """The pictures of a folder, which may still grow.

    Args:
        folder: Where `render` puts them.
        split: "train" or "held_out".
        subjects: What can be asked about.
        actions: The ground actions behind them.
        seeds: Only parts whose seed lies in this range.
    """

    def __init__(
        self,
        folder: Path,
        split: str,
        subjects: Sequence[Subject],
        actions: Iterable[Action],
        *,
        seeds: range = range(1_000_000),
    ):
        self._folder, self._split, self._seeds = folder, split, seeds
        self._subjects, self._actions = subjects, tuple(actions)
        self._finds = np.array(
            [s.form == Way.POSSIBLE and s.name == "find" for s in subjects], bool
        )
        self._read: set[Path] = set()
        self._pixels: list[NDArray[np.uint8]] = []
        self._starts = np.zeros(1, np.int64)
        self.labels = np.zeros((0, len(subjects)), np.int8)

    def refresh(self) -> int:
        """Take in parts that were written since; the number of pictures now."""
        rows = [self.labels]
        for path in shards.finished(self._folder, self._split):
            if path in self._read or int(path.stem.rsplit("-", 1)[1]) not in self._seeds:
                continue
            shard = shards.read(path)
            self._read.add(path)
            self._pixels.append(shard.pixels)
            labels = Labels(in_words(shard), self._actions).of(self._subjects)
            elsewhere = np.array(["photograph" in info for info in shard.info])
            # Whether a thing can be found from where no kitchen is, nobody knows.
            labels[np.ix_(elsewhere, self._finds)] = Label.UNCLEAR
            rows.append(labels)
        self.labels = np.concatenate(rows)
        self._starts = np.cumsum([0, *(len(part) for part in self._pixels)])
        return len(self)

    def __len__(self) -> int:
        return len(self.labels)

    def pixels(self, numbers: NDArray[np.int64]) -> NDArray[np.uint8]:
        """The pictures of the given numbers, n × height × width × 3."""
        parts = np.searchsorted(self._starts, numbers, side="right") - 1
        return np.stack(
            [self._pixels[p][n - self._starts[p]] for p, n in zip(parts, numbers, strict=True)]
        )
