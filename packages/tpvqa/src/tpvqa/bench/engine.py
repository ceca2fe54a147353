"""The one engine of all benches: a declaration goes in, rows of finished episodes come out."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.checking import check
from tpvqa.bench.condition import settings_of
from tpvqa.bench.ledger import REMEDY, Ledger
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.published import tasks_of
from tpvqa.bench.schedule import run_all
from tpvqa.bench.settings import common_settings, fingerprint
from tpvqa.bench.stated_risk import TRIALS, bounds, check_risk
from tpvqa.bench.told_object import read_object
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.files import write_whole

Progress = Callable[[int, int], None]
"""Told how many are done, and how many there are."""
TASKS = "tasks.json"
"""The fingerprints of the user's own tasks, and of files that conditions name, by name."""


def _nothing(cells: Sequence[Cell]) -> Mapping[Cell, Calibration]:
    return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Bench:
    """What is run.

    Attributes:
        wanted: How many episodes of each cell.
        common: What all trials share: seed, rates of faults, limits, options.
        own: Tasks of the user's own, by the names that cells have for them.
        calibrations: Gives what monitors are told of the VLM's answers, for cells that have
            episodes to run; of others the calibration that is shipped for their VLM, if any.
        more_settings: What else decides the figures.
        risk_trials: Of every cell that states a risk, from which that is learnt.
    """

    wanted: Mapping[Cell, int]
    common: TrialConfig = field(default_factory=TrialConfig)
    own: Mapping[str, OwnTask] = field(default_factory=dict)
    calibrations: Callable[[Sequence[Cell]], Mapping[Cell, Calibration]] = _nothing
    more_settings: Mapping[str, Any] = field(default_factory=dict)
    risk_trials: int = TRIALS

    @property
    def settings(self) -> dict[str, Any]:
        """What decides the figures, besides the cells and the number of episodes."""
        more = {} if self.risk_trials == TRIALS else {"trials of a risk": self.risk_trials}
        return {**common_settings(self.common), **self.more_settings, **more}

    def check(self) -> None:
        """See that every part of every cell is there and can be made, before anything is run.

        Raises:
            TpvqaError: What is not.
        """
        for cell in self.wanted:
            check_risk(cell, self.risk_trials)
        check(list(self.wanted), self.common, self.own)


def run_bench(
    bench: Bench,
    folder: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress = lambda done, total: None,
    published: Path | None = None,
) -> Ledger:
    """Run what is missing.

    Args:
        bench: What to run.
        folder: Where rows go; a bench that was stopped goes on there.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        progress: Told how many episodes are done and how many there are.
        published: Rows of this bench that count as finished: a Parquet file, or a folder of them.

    Returns:
        All rows that lie in the folder. It is closed: it is to be read from only.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    bench.check()
    ledger = Ledger(folder, bench.settings, published)
    try:
        known = {} if published is None else tasks_of(published)
        _keep_files(folder, bench, [cell for cell, _ in ledger.rows], known)
        missing = {cell: len(ledger.missing(cell, n)) for cell, n in bench.wanted.items()}
        unfinished = [cell for cell, count in missing.items() if count]
        told = bench.calibrations(unfinished)
        total = sum(bench.wanted.values())
        done = total - sum(missing.values())

        def before(risk_done: int, risk_total: int) -> None:
            progress(risk_done, risk_total + total)

        risks = bounds(
            unfinished,
            folder,
            bench.common,
            bench.risk_trials,
            calibrations=told,
            own=bench.own,
            more_settings=bench.more_settings,
            workers=workers,
            scheduler=scheduler,
            progress=before,
        )
        progress(done, total)

        def count(more: int) -> None:
            nonlocal done
            done += more
            progress(min(done, total), total)  # chains are run to their end

        run_all(
            ledger,
            bench.wanted,
            bench.common,
            workers=workers,
            scheduler=scheduler,
            done=count,
            calibrations=told,
            own=bench.own,
            risks=risks,
        )
    finally:
        ledger.close()
    return ledger


def _keep_files(
    folder: Path, bench: Bench, ran: Iterable[Cell], published: Mapping[str, str]
) -> None:
    """Note what the files of own tasks and of conditions say, those of published rows, too; other
    files need another folder.

    Raises:
        BenchError: A task or a condition was run with other files.
    """
    path = folder / TASKS
    lie = read_object(path) or {}
    there = {**published, **lie}
    named = {each for cell in bench.wanted for each in _conditions_files(cell)}
    here = {name: own.fingerprint for name, own in bench.own.items()}
    here |= {name: fingerprint(file) for name, file in named}
    before = {name for cell in ran for name in (cell.task, *dict(_conditions_files(cell)))}
    wanted = {cell.task for cell in bench.wanted} | dict(named).keys()
    for name in sorted(wanted & ({*there} | before)):
        if there.get(name) != here.get(name):
            what = "a task" if name not in dict(named) else "a condition"
            raise BenchError(
                f"{folder} holds episodes of {what} {name!r} whose files say something else. "
                "Name another folder with --out"
            )
    if here.keys() - lie.keys():
        write_whole(path, f"{json.dumps(there | here, indent=1)}\n".encode(), remedy=REMEDY)


def _conditions_files(cell: Cell) -> Iterator[tuple[str, Path]]:
    """The files that a cell's condition names, by what it says of them."""
    file = settings_of(cell.condition).get("priors")
    if file is not None:
        yield f"priors={file}", Path(file)
