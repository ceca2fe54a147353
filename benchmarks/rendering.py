"""How long the live kitchen takes for a picture: `python benchmarks/rendering.py`."""

import argparse
import os
import statistics
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np


def milliseconds(work: Callable[[], object]) -> tuple[float, float]:
    """Wall time and processor time (all threads together) of a call."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return 1000 * (time.perf_counter() - wall), 1000 * (time.process_time() - cpu)


def main() -> None:
    """Print a table: compile, render alone, and everything that a training picture needs."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--kitchens", type=int, default=4)
    parser.add_argument("--pictures", type=int, default=40, help="of each kitchen")
    parser.add_argument("--size", type=int, default=224)
    parser.add_argument("--threads", type=int, default=2, help="of the software renderer")
    given = parser.parse_args()
    os.environ["LP_NUM_THREADS"] = str(given.threads)
    from tpvqa_household.kitchen.scene import KitchenScene
    from tpvqa_household.kitchen.states import sample_state

    rng = np.random.default_rng(0)
    rows: dict[str, list[tuple[float, float]]] = {
        "build a kitchen": [],
        "render": [],
        "arrange + segment + render": [],
    }
    build, alone, whole = rows.values()
    for kitchen in range(given.kitchens):
        made: list[KitchenScene] = []
        build.append(
            milliseconds(partial(_make, made, KitchenScene, seed=kitchen, size=given.size))
        )
        (scene,) = made

        def everything(number: int, scene: KitchenScene = scene) -> None:
            scene.arrange(sample_state(rng), look=number)
            scene.render()
            scene.shown()

        everything(-1)  # the first picture also uploads what later ones find there
        for number in range(given.pictures):
            whole.append(milliseconds(partial(everything, number)))
            alone.append(milliseconds(scene.render))
        scene.close()
    print(f"{given.size} x {given.size}, software rendering on {given.threads} threads; ms")
    print(f"{'':30}{'median':>9}{'95 %':>9}{'processor time':>18}")
    for name, taken in rows.items():
        wall, cpu = zip(*taken, strict=True)
        print(
            f"{name:30}{statistics.median(wall):9.1f}{np.percentile(wall, 95):9.1f}"
            f"{statistics.median(cpu):18.1f}"
        )


def _make(into: list[Any], kind: Callable[..., Any], **options: int) -> None:
    into.append(kind(**options))


if __name__ == "__main__":
    main()
