"""Time and memory of a belief monitor's decisions over a long trial.

Blocks are put into another order: plans of about four actions a block, failures and disturbances
of .25, answers right in .8 of which nothing is known. Printed are the processor time of a decision
(checks before and after an action together; planning, in another process, not counted) by tenths
of the trial, and the greatest memory of this process.

    python benchmarks/long_trials.py --blocks 20 --seed 0
"""

import argparse
import itertools
import resource
import time
from pathlib import Path
from random import Random
from statistics import median, quantiles
from tempfile import TemporaryDirectory

from tpvqa.assembly import Trial
from tpvqa.config import TrialConfig
from tpvqa.episodes import MemoryWriter
from tpvqa.events import Event
from tpvqa.events.events import Decided, Ended

DOMAIN = """(define (domain blocks)
  (:requirements :strips :typing) (:types block)
  (:predicates (on ?x ?y - block) (on_table ?x - block) (clear ?x - block) (holding ?x - block)
    (empty))
  (:action pick_up :parameters (?x - block)
    :precondition (and (clear ?x) (on_table ?x) (empty))
    :effect (and (holding ?x) (not (on_table ?x)) (not (clear ?x)) (not (empty))))
  (:action put_down :parameters (?x - block)
    :precondition (holding ?x)
    :effect (and (on_table ?x) (clear ?x) (empty) (not (holding ?x))))
  (:action stack :parameters (?x ?y - block)
    :precondition (and (holding ?x) (clear ?y))
    :effect (and (on ?x ?y) (clear ?x) (empty) (not (holding ?x)) (not (clear ?y))))
  (:action unstack :parameters (?x ?y - block)
    :precondition (and (on ?x ?y) (clear ?x) (empty))
    :effect (and (holding ?x) (clear ?y) (not (on ?x ?y)) (not (clear ?x)) (not (empty)))))
"""


def problem(blocks: int, seed: int) -> str:
    """One tower that is to stand in another order."""
    random, names = Random(seed), [f"b{number}" for number in range(blocks)]
    before, after = random.sample(names, blocks), random.sample(names, blocks)
    tower = [f"(on_table {before[0]})", f"(clear {before[-1]})", "(empty)"]
    tower += [f"(on {upper} {lower})" for lower, upper in itertools.pairwise(before)]
    goal = [f"(on {upper} {lower})" for lower, upper in itertools.pairwise(after)]
    return (
        f"(define (problem other_order) (:domain blocks) (:objects {' '.join(names)} - block)\n"
        f"(:init {' '.join(tower)})\n(:goal (and {' '.join(goal)})))"
    )


def main() -> None:
    """Run one trial and print what it took."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--blocks", type=int, default=20)
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--monitor", default="belief")
    given = options.parse_args()
    folder = TemporaryDirectory()
    files = {"domain": Path(folder.name, "domain.pddl"), "problem": Path(folder.name, "p.pddl")}
    files["domain"].write_text(DOMAIN)
    files["problem"].write_text(problem(given.blocks, given.seed))
    config = TrialConfig().but(
        task={name: str(path) for name, path in files.items()},
        seed=given.seed,
        monitor={"spec": given.monitor},
        vlm={"spec": "oracle:0.8"},
        world={"spec": "symbolic"},
        limits={"repeats": "none", "replans": "none", "actions": "50x"},
    )
    begun, times = time.process_time(), list[float]()

    def watch(event: Event) -> None:
        nonlocal begun
        if isinstance(event, Decided) and event.when == "after":
            now = time.process_time()
            times.append((now - begun) * 1000)
            begun = now

    with folder, Trial(config) as trial:
        ended = trial.run(MemoryWriter(resumable=False, keep=False), listeners=[watch])
    assert isinstance(ended, Ended)
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(f"{given.blocks} blocks: {ended.because} after {ended.actions} actions, ", end="")
    print(f"{ended.questions} questions; {memory:.0f} MiB at most")
    tenth = max(1, len(times) // 10)
    by_tenths = [median(times[n : n + tenth]) for n in range(0, len(times), tenth)]
    print("ms a decision, medians of tenths:", " ".join(f"{each:.0f}" for each in by_tenths))
    print(f"in all: {median(times):.0f} ms at the median, {quantiles(times, n=20)[-1]:.0f} at 95 %")


if __name__ == "__main__":
    main()
