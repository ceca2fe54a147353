"""Pieces of photographs that show no household, to learn *no* and *cannot see* from.

`python -m tpvqa_household.training.photographs PHOTOGRAPHS DATA` adds them to a folder that
`render` fills.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa.chance import chance_array
from tpvqa.errors import TpvqaError
from tpvqa.pictures import in_colour, read_picture
from tpvqa_household.kitchen.household import atoms_of_interest
from tpvqa_household.training import shards
from tpvqa_household.training.facts import FactTable

FIRST = 800_000
"""Seed of the first part; those of rendered parts are below."""
PART = 200
SIDE = 224
_ENDINGS = (".jpg", ".jpeg", ".png", ".webp")


def pieces(photographs: Sequence[Path], seed: int, count: int) -> shards.Shard:
    """Random pieces of photographs, of any size, mirrored or turned; some melt into another.

    Args:
        photographs: Files.
        seed: Decides everything.
        count: How many pieces.
    """
    opened = [np.asarray(in_colour(read_picture(path))) for path in photographs]
    pixels, info = [], []
    for number in range(count):
        rng = chance_array(seed, 0, "photograph", number)
        which = int(rng.integers(len(opened)))
        piece = _piece(opened[which], rng)
        if rng.random() < 0.3:
            other = _piece(opened[int(rng.integers(len(opened)))], rng)
            share = np.clip(np.linspace(-2, 3, SIDE) + rng.uniform(-1, 1), 0, 1)[:, None, None]
            piece = (piece * share + other * (1 - share)).astype(np.uint8)
        pixels.append(piece)
        info.append({"photograph": photographs[which].name, "pixels": {}})
    # Nothing of the household is there, which the picture shows; of all else it shows nothing.
    facts = {atom: (False, atom.predicate == "near") for atom in atoms_of_interest()}
    return shards.Shard(np.stack(pixels), FactTable.of([facts] * count), info)


def _piece(photograph: NDArray[np.uint8], rng: np.random.Generator) -> NDArray[np.uint8]:
    height, width = photograph.shape[:2]
    side = int(min(height, width) * rng.uniform(0.15, 1.0))
    top, left = int(rng.integers(height - side + 1)), int(rng.integers(width - side + 1))
    cut = Image.fromarray(photograph[top : top + side, left : left + side])
    piece = np.rot90(
        np.asarray(cut.resize((SIDE, SIDE), Image.Resampling.BOX)), int(rng.integers(4))
    )
    return np.ascontiguousarray(piece[:, ::-1] if rng.random() < 0.5 else piece)


def main(arguments: Sequence[str] | None = None) -> int:
    """Add parts with pieces of photographs."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.photographs",
        description=(__doc__ or "").splitlines()[0],
    )
    parser.add_argument("photographs", type=Path, help="a folder of photographs of other things")
    parser.add_argument("folder", type=Path, help="the folder that `render` fills")
    parser.add_argument("--pieces", type=int, default=1000)
    chosen = parser.parse_args(arguments)
    found = sorted(p for p in chosen.photographs.glob("*") if p.suffix.lower() in _ENDINGS)
    try:
        if not found:
            raise TpvqaError(f"{chosen.photographs}: no photographs ({', '.join(_ENDINGS)}) there.")
        for seed in range(FIRST, FIRST - (-chosen.pieces // PART)):
            shards.write(shards.path_of(chosen.folder, "train", seed), pieces(found, seed, PART))
    except (TpvqaError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{-(-chosen.pieces // PART) * PART} pieces of {len(found)} photographs")
    return 0


if __name__ == "__main__":
    sys.exit(main())
