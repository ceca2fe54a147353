"""How many episodes a second: `python benchmarks/episodes.py`.

One core without pictures (noise-model VLM, mean over the paper's five monitors and three tasks) and
with pictures and the embedded network, memory per process, and one against two Dask workers side by
side. Everything is timed warm: the first episodes of a process load and plan what later ones share.
"""

import argparse
import resource
import tempfile
import time
from pathlib import Path

from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.schedule import run_all
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa_experiments.paper import MONITORS, TASKS


def rate(cells: list[Cell], episodes: int, warm: int) -> tuple[float, float]:
    """Episodes a second of wall time and of processor time, in this process."""
    common = TrialConfig()
    for cell in cells:
        for episode in range(warm):
            stage(cell.task).run(cell, common, episode)
    wall, cpu = time.perf_counter(), time.process_time()
    for cell in cells:
        for episode in range(warm, warm + episodes):
            row = stage(cell.task).run(cell, common, episode)
            assert not row.error, row.error
    count = len(cells) * episodes
    return count / (time.perf_counter() - wall), count / (time.process_time() - cpu)


def on_workers(cells: list[Cell], episodes: int, workers: int) -> float:
    """Seconds for a whole bench on Dask's workers, their start included."""
    with tempfile.TemporaryDirectory() as folder:
        ledger = Ledger(Path(folder), {})
        began = time.perf_counter()
        wanted = dict.fromkeys(cells, episodes)
        run_all(ledger, wanted, TrialConfig(), workers=workers, distributed=True)
        seconds = time.perf_counter() - began
        ledger.close()
    return seconds


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--episodes", type=int, default=60, help="of a task and monitor, timed")
    parser.add_argument("--scaling", type=int, default=400, help="of a task and monitor")
    given = parser.parse_args()
    told = [Cell(t, m, "oracle:0.8", "symbolic") for t in TASKS for m in MONITORS]
    seen = [Cell(t, m, "embedded", "images") for t in TASKS for m in MONITORS]
    print(f"{'one core':40}{'wall':>8}{'processor':>11}  episodes a second")
    for name, cells, warm in (
        ("noise model, no pictures", told, 30),
        ("embedded network, pictures", seen, 60),
    ):
        wall, cpu = rate(cells, given.episodes, warm)
        print(f"{name:40}{wall:8.0f}{cpu:11.0f}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{'memory of the process with pictures':40}{peak:8.0f} MB")
    seconds = {n: on_workers(told, given.scaling, n) for n in (1, 2)}
    count = len(told) * given.scaling
    for workers, taken in seconds.items():
        print(f"{count} episodes on {workers} Dask worker(s):  {taken:6.1f} s")
    print(f"two workers against one: {seconds[1] / seconds[2]:.2f}x")


if __name__ == "__main__":
    main()
