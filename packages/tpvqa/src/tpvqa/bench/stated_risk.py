"""The risk that cells state, learnt from trials of other seeds under each cell's own conditions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.risk import RiskBound, RiskCalibration, least_trials
from tpvqa.bench.cell import Cell
from tpvqa.bench.folders import folder_within
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.schedule import run_all
from tpvqa.bench.settings import common_settings
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.monitors.stated_risk import split_risk

FOLDER = "risk"
"""Where their trials lie, in the folder of the bench."""
OTHER_SEEDS = 20_000
"""How far the seed of these trials lies from that of the bench; what answers are worth is learnt
from yet others."""
TRIALS = 199
"""Of every cell; with one more they are a whole number of times 1 / .02, and 1 / .05."""


def unstated(cell: Cell) -> Cell:
    """The cell whose trials tell the risk of a cell."""
    return replace(cell, monitor=split_risk(cell.monitor)[0])


def check_risk(cell: Cell, trials: int) -> None:
    """See that the risk of a cell, if it states one, can be learnt.

    Raises:
        BenchError: So many trials are too few, or its trials are not alike.
        PluginError: The risk is no number between 0 and 1.
    """
    risk = split_risk(cell.monitor)[1]
    if risk is None:
        return
    if trials < least_trials(risk):
        raise BenchError(
            f"{cell}: a risk of {risk:g} takes at least {least_trials(risk)} trials, and "
            f"{trials} are to be run. Say --risk-trials {least_trials(risk)} or more"
        )
    if cell.carried:
        raise BenchError(
            f"{cell}: who learns from trial to trial is another in each, so that no risk can be "
            "stated of them. Leave out carried= or risk="
        )


def bounds(
    cells: Sequence[Cell],
    folder: Path,
    common: TrialConfig,
    trials: int,
    *,
    calibrations: Mapping[Cell, Calibration],
    own: Mapping[str, OwnTask],
    more_settings: Mapping[str, Any],
    workers: int = 1,
    scheduler: str | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> dict[Cell, RiskBound]:
    """Where "done" may be reported in cells that state a risk.

    Cells that differ in their risk alone share their trials. What is finished is never run again.

    Args:
        cells: Any; those that state no risk are left out.
        folder: Of the bench.
        common: What all its trials share; these have other seeds.
        trials: Of every cell.
        calibrations: What monitors are told of the VLM's answers, by cell.
        own: Tasks of the user's own, by name.
        more_settings: What else decides the figures.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        progress: Told how many of these trials are done and how many there are.

    Raises:
        BenchError: A trial failed, or the folder cannot be used.
        WriteError: It cannot be written to.
    """
    risks = {cell: risk for cell in cells if (risk := split_risk(cell.monitor)[1]) is not None}
    if not risks:
        return {}
    away = common.but(seed=common.seed + OTHER_SEEDS)
    wanted = dict.fromkeys(map(unstated, risks), trials)
    ledger = Ledger(folder_within(folder, FOLDER), {**common_settings(away), **more_settings})
    try:
        total = sum(wanted.values())
        done = total - sum(len(ledger.missing(cell, count)) for cell, count in wanted.items())
        progress(done, total)

        def count(more: int) -> None:
            nonlocal done
            done += more
            progress(done, total)

        told = {unstated(cell): calibrations[cell] for cell in risks if cell in calibrations}
        run_all(
            ledger,
            wanted,
            away,
            workers=workers,
            scheduler=scheduler,
            done=count,
            calibrations=told,
            own=own,
        )
        known = {cell: learnt(ledger.of(cell, count)) for cell, count in wanted.items()}
        return {cell: known[unstated(cell)].bound(risk) for cell, risk in risks.items()}
    finally:
        ledger.close()


def learnt(
    rows: Sequence[EpisodeRow], made_with: Mapping[str, str] | None = None
) -> RiskCalibration:
    """What rows of trials without a bound tell.

    Args:
        rows: Of one cell, and at least one.
        made_with: Under which conditions they were run.

    Raises:
        BenchError: A trial failed, or its monitor does not say how probable the goal is.
    """
    failed = next((row for row in rows if row.error), None)
    if failed is not None:
        raise BenchError(
            f"episode {failed.episode} of {failed.cell} failed, so that no risk is learnt: "
            f"{failed.error.strip()}"
        )
    ended = [row for row in rows if row.believed_goal]
    if any(row.goal is None for row in ended):
        raise BenchError(
            f"{rows[0].cell}: the monitor does not say how probable the goal is. Take belief"
        )
    return RiskCalibration(
        made_with=made_with or {},
        seed=rows[0].seed,
        trials=len(rows),
        wrong=tuple(row.goal for row in ended if row.goal is not None and not row.reached),
        right=tuple(row.goal for row in ended if row.goal is not None and row.reached),
    )
