"""Render training pictures: `python -m tpvqa_household.training.render --help`.

Every part of the set has a seed of its own and is written whole, so that the command can be
stopped and started again, and any number of processes gives the same pictures.
"""

import argparse
import os
import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from tpvqa.chance import chance_array
from tpvqa.errors import TpvqaError
from tpvqa_household.kitchen.layout import Split
from tpvqa_household.training import shards
from tpvqa_household.training.facts import FactTable
from tpvqa_household.training.states import random_state

PART = 200
"""Pictures a part."""
PER_KITCHEN = 20
"""Pictures of one kitchen; compiling the next takes as long as a few pictures."""
_OVERVIEW = 0.04
_SIDE = 0.16


@dataclass(frozen=True)
class Part:
    """One part to render."""

    folder: Path
    split: Split
    seed: int


def pictures(seed: int, split: Split, count: int) -> shards.Shard:
    """Random kitchens in random states, seen as the robot would see them.

    Args:
        seed: Decides everything.
        split: "train", or "held_out" for meshes and layouts that training never sees.
        count: How many pictures.
    """
    from tpvqa_household.kitchen.scene import KitchenScene

    pixels, facts, info = [], [], []
    for first in range(0, count, PER_KITCHEN):
        number = seed * 1000 + first // PER_KITCHEN
        scene = KitchenScene(seed=number, split=split)
        try:
            for look in range(min(PER_KITCHEN, count - first)):
                rng = chance_array(number, 0, "training state", look)
                view = "front"
                if rng.random() < _SIDE:
                    view = str(rng.choice(["left", "right"]))
                elif rng.random() < _OVERVIEW:
                    view = "overview"
                scene.repaint(look)
                scene.arrange(random_state(rng), look=look, view=view)
                pixels.append(scene.render())
                facts.append({a: (s.true, s.visible) for a, s in scene.shown().items()})
                info.append({"kitchen": number, "view": view, "pixels": dict(scene.pixels())})
        finally:
            scene.close()
    return shards.Shard(np.stack(pixels), FactTable.of(facts), info)


def _render(part: Part) -> tuple[Part, float]:
    os.nice(10)
    began = time.perf_counter()
    try:
        shard = pictures(part.seed, part.split, PART)
    except TpvqaError as error:  # its own type cannot cross the border between processes
        raise RuntimeError(f"{part.split} part {part.seed}: {error}") from None
    shards.write(shards.path_of(part.folder, part.split, part.seed), shard)
    return part, time.perf_counter() - began


def _missing(folder: Path, split: Split, seeds: Sequence[int]) -> Iterator[Part]:
    for seed in seeds:
        if not shards.path_of(folder, split, seed).with_suffix(".npz").exists():
            yield Part(folder, split, seed)


def main(arguments: Sequence[str] | None = None) -> int:
    """Render the parts that are missing."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.render", description=__doc__.splitlines()[0]
    )
    parser.add_argument("folder", type=Path, help="where the parts go, outside the repository")
    parser.add_argument("--pictures", type=int, default=20_000, help="how many in all")
    parser.add_argument("--split", choices=("train", "held_out"), default="train")
    parser.add_argument("--seed", type=int, default=0, help="of the first part")
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--minutes", type=float, default=None, help="start no part after this long")
    chosen = parser.parse_args(arguments)
    os.environ.setdefault("LP_NUM_THREADS", "1")  # software GL: one thread a process
    seeds = range(chosen.seed, chosen.seed + -(-chosen.pictures // PART))
    todo = list(_missing(chosen.folder, chosen.split, seeds))
    print(f"{len(seeds)} parts of {PART} pictures, {len(todo)} to render", flush=True)
    began = time.perf_counter()
    queue = iter(todo)
    context = get_context("spawn")
    with ProcessPoolExecutor(chosen.processes, context, max_tasks_per_child=4) as pool:
        running = {pool.submit(_render, part) for _, part in zip(range(chosen.processes), queue)}  # noqa: B905
        done = 0
        while running:
            finished = next(as_completed(running))
            running.remove(finished)
            part, seconds = finished.result()
            done += 1
            print(
                f"{part.split} part {part.seed}: {1000 * seconds / PART:.0f} ms a picture, "
                f"{done} of {len(todo)} after {time.perf_counter() - began:.0f} s",
                flush=True,
            )
            late = chosen.minutes and time.perf_counter() - began > 60 * chosen.minutes
            following = None if late else next(queue, None)
            if following is not None:
                running.add(pool.submit(_render, following))
    return 0


if __name__ == "__main__":
    sys.exit(main())
