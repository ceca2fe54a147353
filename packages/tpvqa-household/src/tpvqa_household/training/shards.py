"""Pictures on disk: parts of a few hundred, each written whole or not at all."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tpvqa.pddl import Atom
from tpvqa_household.training.facts import FactTable


@dataclass(frozen=True)
class Shard:
    """A part of a set of pictures.

    Attributes:
        pixels: n × 224 × 224 × 3, mapped from disk.
        table: What they show.
        info: What else the renderer tells of each.
    """

    pixels: NDArray[np.uint8]
    table: FactTable
    info: Sequence[Mapping[str, Any]]


def path_of(folder: Path, split: str, seed: int) -> Path:
    """Where a part lies, without the endings .npy (pixels) and .npz (facts)."""
    return folder / f"{split}-{seed:06d}"


def write(path: Path, shard: Shard) -> None:
    """Write a part; a reader never sees half of it."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pixels = path.with_suffix(".tmp.npy")
    np.save(pixels, shard.pixels)
    facts = path.with_suffix(".tmp.npz")
    np.savez_compressed(
        facts,
        atoms=np.array([atom.pddl() for atom in shard.table.atoms]),
        true=shard.table.true,
        visible=shard.table.visible,
        info=np.array([json.dumps(info, default=str) for info in shard.info]),
    )
    os.replace(pixels, path.with_suffix(".npy"))
    os.replace(facts, path.with_suffix(".npz"))


def read(path: Path) -> Shard:
    """Read a part that `write` wrote."""
    with np.load(path.with_suffix(".npz")) as data:
        atoms = tuple(Atom.parse(str(text)) for text in data["atoms"])
        table = FactTable(atoms, data["true"], data["visible"])
        info = [json.loads(str(text)) for text in data["info"]]
    return Shard(np.load(path.with_suffix(".npy"), mmap_mode="r"), table, info)


def finished(folder: Path, split: str) -> list[Path]:
    """The parts of a split that are complete, in the order of their seeds."""
    return sorted(p for p in folder.glob(f"{split}-*.npz") if ".tmp" not in p.name)
