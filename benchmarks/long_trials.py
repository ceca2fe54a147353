"""Time and memory of a belief monitor's decisions over a long trial.

Blocks are put into another order, things are brought from places to others, some of them closed, or
parcels are brought to other cities: plans of some hundred actions, failures and disturbances of
.25, answers right in .8, or as told, of which nothing is known. Printed are whether the goal was
reached, the processor time of a decision (checks before and after an action together; planning, in
another process, not counted) by tenths of the trial, and the greatest memory of this process.

    python benchmarks/long_trials.py --kind blocks --size 20 --seed 0
"""

import argparse
import resource
import time
from pathlib import Path
from statistics import median, quantiles
from tempfile import TemporaryDirectory

from large_problems import LOGISTICS, logistics_problem  # type: ignore[import-not-found]
from long_problems import (  # type: ignore[import-not-found]
    HOME,
    TOWER,
    home_problem,
    tower_problem,
)

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Event
from tpvqa.events.events import Decided, Ended, PlanMade


def parcels_problem(parcels: int, *, seed: int = 0) -> str:
    """So many parcels to be brought elsewhere, in three cities."""
    return str(logistics_problem(60, seed=seed, wanted=parcels))


KINDS = {
    "blocks": (TOWER, tower_problem, 20),
    "household": (HOME, home_problem, 60),
    "logistics": (LOGISTICS, parcels_problem, 12),
}
"""Domain, problem of a size, and that size by default: blocks, things, parcels."""


def main() -> None:
    """Run one trial and print what it took."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--kind", choices=KINDS, default="blocks")
    options.add_argument("--size", type=int, help="blocks, things, or parcels")
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--monitor", default="belief")
    options.add_argument("--vlm", default="oracle:0.8")
    given = options.parse_args()
    domain, problem, usual = KINDS[given.kind]
    size = given.size or usual
    folder = TemporaryDirectory()
    files = {"domain": Path(folder.name, "domain.pddl"), "problem": Path(folder.name, "p.pddl")}
    files["domain"].write_text(domain)
    files["problem"].write_text(problem(size, seed=given.seed))
    config = TrialConfig().but(
        task={name: str(path) for name, path in files.items()},
        seed=given.seed,
        monitor={"spec": given.monitor},
        vlm={"spec": given.vlm},
        world={"spec": "symbolic"},
        limits={"repeats": "none", "replans": "none", "actions": "50x"},
    )
    times, plans = list[float](), list[int]()
    begun = time.process_time()

    def watch(event: Event) -> None:
        nonlocal begun
        if isinstance(event, PlanMade):
            plans.append(len(event.plan))
        if isinstance(event, Decided) and event.when == "after":
            now = time.process_time()
            times.append((now - begun) * 1000)
            begun = now

    with folder, Trial(config) as trial:
        print(f"start: {(time.process_time() - begun) * 1000:.0f} ms")
        begun = time.process_time()
        ended = trial.run(MemoryWriter(resumable=False, keep=False), listeners=[watch])
    assert isinstance(ended, Ended)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{given.kind} {size}: a plan of {plans[0]} steps; {ended.because} ", end="")
    print("(it was so) after " if ended.completed else "(it was not reached) after ", end="")
    print(f"{ended.actions} actions, {ended.questions} questions; {memory:.0f} MiB at most")
    tenth = max(1, len(times) // 10)
    by_tenths = [median(times[n : n + tenth]) for n in range(0, len(times), tenth)]
    print("ms a decision, medians of tenths:", " ".join(f"{each:.0f}" for each in by_tenths))
    print(f"in all: {median(times):.0f} ms at the median, {quantiles(times, n=20)[-1]:.0f} at 95 %")


if __name__ == "__main__":
    main()
