"""Whether a risk that is stated is held: `python benchmarks/risk.py [--trials N] [--out FOLDER]`.

For every noise model a calibration of its answers is learnt on trials of one seed, and trials of
another are run with the belief monitor that states no risk. One that states it does the same until
it would say "done", so that every such trial tells what comes of it under any threshold
(`tests/bench/test_stated_risk.py` sees to that). The trials are split at random again and again:
of some the threshold is learnt, on the others it is tried. Printed, each in the mean over splits,
are the share of all trials that end in "done" with the goal false (the stated risk bounds that
mean; its 95% interval is by as many trials as there are), how often it is above the risk in a
single split, completion, and the share that stops without "done" though the goal is reached. With
--out what is finished is kept, and the same command goes on there.
"""

import argparse
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from random import Random
from statistics import fmean

from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import Bench, run_bench
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stated_risk import TRIALS, learnt
from tpvqa.bench.statistics import wilson
from tpvqa.config import TrialConfig
from tpvqa_experiments.belief.calibrations import calibrations, source_of

SPLITS = 1000


def tried(rows: Sequence[EpisodeRow], risk: float, trials: int) -> list[tuple[float, float, float]]:
    """Wrong "done", completion, and what is reached and not said, of every split.

    Args:
        rows: Of trials without a bound.
        risk: That is stated.
        trials: Of which it is learnt; the others are those that count.
    """
    random, found = Random(0), []
    for _ in range(SPLITS):
        drawn = random.sample(rows, len(rows))
        bound = learnt(drawn[:trials]).bound(risk)
        others = drawn[trials:]
        said = [row.believed_goal and bound.allows(row.goal or 0.0) for row in others]
        reached = [row.reached for row in others]
        ends = list(zip(said, reached, strict=True))
        found.append(
            (
                fmean(done and not true for done, true in ends),
                fmean(done and true for done, true in ends),
                fmean(true and not done for done, true in ends),
            )
        )
    return found


def progress(done: int, total: int) -> None:
    """Say how far it is."""
    print(f"\r{done} of {total} trials", end="", file=sys.stderr, flush=True)


def main() -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--task", default="build_tower")
    parser.add_argument("--vlms", default="oracle:0.8,oracle:0.8:0:0.74")
    parser.add_argument("--risks", default=".02,.05,.1")
    parser.add_argument("--condition", default="limits=none")
    parser.add_argument("--trials", type=int, default=1000, help="of every noise model")
    parser.add_argument("--risk-trials", type=int, default=TRIALS, help="that tell the risk")
    parser.add_argument("--calibration-trials", type=int, default=120)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--out", type=Path, help="folder to keep what is finished in")
    given = parser.parse_args()
    common = TrialConfig(seed=given.seed)
    cells = [
        Cell(given.task, "belief", vlm, "symbolic", given.condition)
        for vlm in given.vlms.split(",")
    ]
    with tempfile.TemporaryDirectory() as temporary:
        folder = given.out or Path(temporary)
        known = calibrations(
            folder / "calibrations",
            {*map(source_of, cells)},
            common,
            given.calibration_trials,
            workers=given.workers,
        )
        bench = Bench(
            wanted=dict.fromkeys(cells, given.trials),
            common=common,
            calibrations=lambda missing: {cell: known[source_of(cell)] for cell in missing},
            more_settings={"trials of a calibration": given.calibration_trials},
        )
        ledger = run_bench(bench, folder, workers=given.workers, progress=progress)
    print(f"\n{'VLM':20}{'risk':>6}{'wrong done':>11}{'95%':>14}{'above it':>10}", end="")
    print(f"{'completed':>10}{'reached, not said':>19}")
    for cell in cells:
        rows = ledger.of(cell, given.trials)
        unbounded = learnt(rows)
        wrong = wilson(len(unbounded.wrong), len(rows))
        lost = fmean(row.reached and not row.believed_goal for row in rows)
        print(
            f"{cell.vlm:20}{'none':>6}{wrong.rate:11.3f}   {wrong.low:.3f}–{wrong.high:.3f}"
            f"{'':10}{len(unbounded.right) / len(rows):10.3f}{lost:19.3f}"
        )
        for risk in map(float, given.risks.split(",")):
            splits = tried(rows, risk, given.risk_trials)
            mean, completed, unsaid = (fmean(each) for each in zip(*splits, strict=True))
            held = wilson(round(mean * len(rows)), len(rows))
            above = fmean(each[0] > risk for each in splits)
            print(
                f"{cell.vlm:20}{risk:6g}{mean:11.3f}   {held.low:.3f}–{held.high:.3f}{above:10.2f}"
                f"{completed:10.3f}{unsaid:19.3f}"
            )


if __name__ == "__main__":
    main()
