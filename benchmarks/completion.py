"""Completion rates over seeded trials, with 95% Wilson intervals, as a Markdown table.

python benchmarks/completion.py --episodes 100
"""

import argparse
import time
from collections import Counter
from collections.abc import Iterator

from tpvqa.assembly import Trial
from tpvqa.bench.statistics import wilson
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Ended
from tpvqa.pddl import load_task
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.plugins import Kind, make


def trials(
    planner: FastDownward,
    *,
    task: str,
    world: str,
    monitor: str,
    vlm: str,
    seed: int,
    episodes: int,
) -> Iterator[Ended]:
    """Run the trials of one cell."""
    loaded = load_task(task)
    shared = make(Kind.VLM, vlm) if vlm == "embedded" else None
    for episode in range(episodes):
        config = TrialConfig(
            task=task, world=world, monitor=monitor, vlm=vlm, seed=seed, episode=episode
        )
        with Trial(config, task=loaded, planner=planner, vlm=shared) as trial:
            yield trial.run(MemoryWriter())


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--episodes", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--world", default="images")
    parser.add_argument(
        "--tasks", nargs="+", default=["clean_dishes", "serve_breakfast", "eat_apple"]
    )
    parser.add_argument(
        "--cells",
        nargs="+",
        default=["tpvqa/embedded", "none/oracle"],
        metavar="MONITOR/VLM",
    )
    options = parser.parse_args()
    print(
        "| task | monitor | VLM | completed | 95% interval | actions | questions | repeats "
        "| replans | s a trial | how they ended |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    planner = FastDownward()
    try:
        for task in options.tasks:
            for cell in options.cells:
                monitor, vlm = cell.split("/", 1)
                began = time.perf_counter()
                ended = list(
                    trials(
                        planner,
                        task=task,
                        world=options.world,
                        monitor=monitor,
                        vlm=vlm,
                        seed=options.seed,
                        episodes=options.episodes,
                    )
                )
                print(row(task, monitor, vlm, ended, time.perf_counter() - began), flush=True)
    finally:
        planner.close()


def row(task: str, monitor: str, vlm: str, ended: list[Ended], seconds: float) -> str:
    """One line of the table."""
    count = len(ended)
    completed = sum(bool(each.completed) for each in ended)
    found = wilson(completed, count)
    low, high = found.low, found.high
    means = [
        sum(getattr(each, name) for each in ended) / count
        for name in ("actions", "questions", "repeats", "replans")
    ]
    how = Counter(
        "goal" if each.completed else "believed, not true" if each.believed_goal else each.because
        for each in ended
    )
    told = ", ".join(f"{name} {number}" for name, number in how.most_common())
    figures = " | ".join(f"{mean:.1f}" for mean in means)
    vlm = "–" if monitor == "none" else vlm
    return (
        f"| {task} | {monitor} | {vlm} | {completed / count:.2f} | {low:.2f}–{high:.2f} "
        f"| {figures} | {seconds / count:.2f} | {told} |"
    )


if __name__ == "__main__":
    main()
