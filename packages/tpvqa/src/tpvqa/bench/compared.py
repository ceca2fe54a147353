"""Anybody's bench: a grid of cells, run and compared with its first monitor."""

from dataclasses import replace
from pathlib import Path

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.engine import Bench, Progress, run_bench
from tpvqa.bench.grid import Grid, known_calibrations
from tpvqa.bench.report import Results, write_bench_report
from tpvqa.bench.stated_risk import TRIALS
from tpvqa.bench.tables import write_tables
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError


def run_compared(
    grid: Grid,
    folder: Path,
    *,
    episodes: int,
    common: TrialConfig,
    calibration: Calibration | None = None,
    risk_trials: int = TRIALS,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress = lambda done, total: None,
) -> Results:
    """Run what is missing, and write tables, figures and the report.

    Args:
        grid: The cells.
        folder: Where everything goes; a bench that was stopped goes on there.
        episodes: Of every cell.
        common: What all cells share: seed, rates of faults, limits, options.
        calibration: What monitors that weigh answers are told; None for what is shipped.
        risk_trials: Of every cell that states a risk, from which that is learnt.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        progress: Told how many episodes are done and how many there are.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    bench = replace(declared(grid, episodes, common, calibration), risk_trials=risk_trials)
    cells = grid.cells()
    ledger = run_bench(bench, folder, workers=workers, scheduler=scheduler, progress=progress)
    results = Results(
        settings={
            **bench.settings,
            "episodes a cell": episodes,
            **{
                name: ", ".join(dict.fromkeys(of))
                for name, of in (
                    ("tasks", [cell.task for cell in cells]),
                    ("monitors", grid.monitors),
                    ("VLMs", [cell.vlm for cell in cells]),
                    ("worlds", [cell.world for cell in cells]),
                )
            },
            **({} if not any(grid.conditions) else {"conditions": "; ".join(grid.conditions)}),
        },
        rows={cell: ledger.of(cell, episodes) for cell in cells},
        reference=grid.monitors[0],
        beside=sum(cell not in cells or at >= episodes for cell, at in ledger.rows),
    )
    write_tables(folder, results)
    write_bench_report(folder, results)
    return results


def declared(
    grid: Grid, episodes: int, common: TrialConfig, calibration: Calibration | None
) -> Bench:
    """What the engine is given.

    Raises:
        BenchError: There is no cell, or a condition is not understood.
    """
    cells = grid.cells()
    if not cells:
        raise BenchError("There is nothing to run: no VLM has answers to what a monitor asks")
    known = known_calibrations(cells, calibration)
    return Bench(
        wanted=dict.fromkeys(cells, episodes),
        common=common,
        own=grid.own,
        calibrations=lambda missing: known,
        more_settings={} if calibration is None else {"calibration": calibration.fingerprint},
    )
