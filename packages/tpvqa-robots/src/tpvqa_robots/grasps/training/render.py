"""Depth images of things on a table, and what came of grasps of them: what the network learns from.

`python -m tpvqa_robots.grasps.training.render OUT --scenes 500 --seed 1`, from the folder of a
clone; several seeds can be made at once, in processes of their own.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from tpvqa.chance import chance_array
from tpvqa_robots.grasps.training.bench import Bench
from tpvqa_robots.grasps.training.candidates import candidates
from tpvqa_robots.grasps.training.catalogue import HELD_OUT, PACK, TAUGHT, named
from tpvqa_robots.grasps.training.sight import points_of, window
from tpvqa_robots.grasps.training.trials import Trials
from tpvqa_robots.toys.room import TABLE

TRIES = 28
"""Grasps of a scene."""
ANOTHER = 0.3
"""How often a second thing lies beside the first."""
PART = 20
"""Scenes in a file."""

Scene = tuple[NDArray[np.float32], NDArray[np.float32]]


def scene(names: Sequence[str], rng: Generator, *, pack: Path = PACK) -> Scene | None:
    """One table, its things, and tried grasps; None where they do not lie still.

    Args:
        names: Of the catalogue; the first lies in the middle.
        rng: Of sizes, places, grasps and errors.
        pack: The zip of scans.

    Returns:
        The depth image, metres; grasps × (x, y, angle, width, held), metres from the middle.
    """
    bench = Bench([named(name, rng, vary=True, pack=pack) for name in names], rng)
    if not bench.settled:
        return None
    depth = window(bench.depth())
    points = points_of(depth)
    tries = candidates(points, TABLE, rng, TRIES)
    if not tries:
        return None
    came = Trials(bench, rng).all_of(tries, float(points[:, 2].max()) - TABLE)
    rows = [
        (grasp.x, grasp.y, grasp.angle, tried.width, float(tried.held))
        for grasp, tried in zip(tries, came, strict=True)
    ]
    short = TRIES - len(rows)
    return depth, np.array(rows + [(np.nan,) * 5] * short, np.float32)


def render(out: Path, scenes: int, seed: int, *, held_out: bool = False, pack: Path = PACK) -> None:
    """Make scenes, and write them into files of `PART` each.

    Args:
        out: The folder.
        scenes: How many.
        seed: Which.
        held_out: Of the things that training does not see: to see how well it generalises.
        pack: The zip of scans.
    """
    out.mkdir(parents=True, exist_ok=True)
    known, number = HELD_OUT if held_out else TAUGHT, 0
    made: list[Scene] = []
    while number < scenes or made:
        if number < scenes:
            rng = chance_array(seed, number, "grasp scene")
            count = 2 if rng.random() < ANOTHER else 1
            found = scene([str(n) for n in rng.choice(known, count)], rng, pack=pack)
            number += 1
            if found is not None:
                made.append(found)
        if made and (len(made) == PART or number >= scenes):
            depths, grasps = zip(*made, strict=True)
            file = out / f"{seed}-{number:05d}.npz"
            np.savez_compressed(file, depth=np.stack(depths), grasps=np.stack(grasps))
            held = np.nanmean(np.stack(grasps)[..., 4])
            print(f"{file.name}: {len(made)} scenes, {held:.2f} of the grasps held", flush=True)
            made = []


def main() -> None:
    """The command."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("out", type=Path)
    words.add_argument("--scenes", type=int, default=500)
    words.add_argument("--seed", type=int, default=1)
    words.add_argument("--held-out", action="store_true")
    words.add_argument("--pack", type=Path, default=PACK)
    said = words.parse_args()
    render(said.out, said.scenes, said.seed, held_out=said.held_out, pack=said.pack)


if __name__ == "__main__":
    main()
