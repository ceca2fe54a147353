"""Runs the belief bench: calibrations first, then every missing episode, then the tables."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import Bench, Progress, run_bench
from tpvqa.bench.published import version_of
from tpvqa.bench.told_object import read_object
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError, UnknownNameError
from tpvqa.tasks import find_task
from tpvqa_experiments.belief import calibrations as learnt
from tpvqa_experiments.belief.check import Check
from tpvqa_experiments.belief.parts import Extent, Part, believes
from tpvqa_experiments.belief.results import BeliefResults
from tpvqa_experiments.belief.tables import write_results
from tpvqa_experiments.belief.taken_over import take_over, taken_over
from tpvqa_experiments.paper import PAPER

SPEED_FILE = "speed.json"
METHOD = 2
"""Changes with how calibrations are learnt, so that a bench does not go on with others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BeliefBench:
    """What to run.

    Attributes:
        parts: Which parts.
        extent: How much of them.
        calibration_episodes: Trials that each calibration is learnt from.
        embedded_world: Where the embedded network is calibrated: images, or kitchen.
        monitors: Run only cells of these; tables have whatever lies in the folder.
        vlms: Run only cells of these VLMs.
        common: Seed, rates of faults, limits.
    """

    parts: Sequence[Part] = tuple(Part)
    extent: Extent = field(default_factory=Extent)
    calibration_episodes: int = 80
    embedded_world: str = "images"
    monitors: Sequence[str] = ()
    vlms: Sequence[str] = ()
    common: TrialConfig = PAPER

    def wanted(self, parts: Iterable[Part] | None = None) -> dict[Cell, int]:
        """How many episodes of each cell; a cell of several parts is run once.

        Args:
            parts: Which parts; by default what is to be run of those that are.
        """
        found: dict[Cell, int] = {}
        for part in self.parts if parts is None else parts:
            for cell, episodes in self.extent.cells(part):
                if parts is not None or self._chosen(cell):
                    found[cell] = max(episodes, found.get(cell, 0))
        return found

    def _chosen(self, cell: Cell) -> bool:
        return (not self.monitors or cell.monitor in self.monitors) and (
            not self.vlms or cell.vlm in self.vlms
        )

    def source_of(self, cell: Cell) -> learnt.Source:
        """Where the calibration of a cell comes from."""
        return learnt.source_of(cell, self.embedded_world)

    def check(self) -> None:
        """See that tasks, monitors and VLMs can be found by name: those without a cell, too.

        Raises:
            TpvqaError: A task is not there, or no part that is to be run has cells of a monitor, a
                VLM, or both.
        """
        for task in self.extent.tasks:
            find_task(task)
        cells = [cell for part in self.parts for cell, _ in self.extent.cells(part)]
        for kind, names, known in (
            ("monitor of these parts", self.monitors, [cell.monitor for cell in cells]),
            ("VLM of these parts", self.vlms, [cell.vlm for cell in cells]),
        ):
            for name in names:
                if name not in known:
                    raise UnknownNameError(kind, name, dict.fromkeys(known))
        if not any(map(self._chosen, cells)):
            raise BenchError("No part has a cell of one of these monitors and one of these VLMs")

    def settings(self) -> dict[str, Any]:
        """What decides the figures, besides the cells and the number of episodes."""
        return self.declared({}).settings

    def declared(
        self,
        wanted: Mapping[Cell, int],
        folder: Path = Path(),
        calibrating: Progress = lambda done, total: None,
        version: str | None = None,
        *,
        workers: int = 1,
        scheduler: str | None = None,
        published: Path | None = None,
    ) -> Bench:
        """What the engine is given.

        Args:
            wanted: How many episodes of each cell.
            folder: Where calibrations are kept.
            calibrating: Told how many calibrations are there and how many there will be.
            version: That of rows of which only tables are made.
            workers: Local processes, which learn calibrations, too.
            scheduler: Address of a Dask scheduler to use instead.
            published: A folder of rows; calibrations may lie in it.
        """

        def told(missing: Sequence[Cell]) -> dict[Cell, Calibration]:
            believing = [cell for cell in missing if believes(cell.monitor)]
            known = learnt.calibrations(
                folder / learnt.CALIBRATIONS,
                {self.source_of(cell) for cell in believing},
                self.common,
                self.calibration_episodes,
                done=calibrating,
                workers=workers,
                scheduler=scheduler,
                published=published,
            )
            return {cell: _told(cell, known[self.source_of(cell)]) for cell in believing}

        return Bench(
            wanted=wanted,
            common=self.common,
            calibrations=told,
            more_settings={
                "trials of a calibration": self.calibration_episodes,
                "how calibrations are learnt": METHOD,
                "the embedded network is calibrated in": self.embedded_world,
                **({} if version is None else {"version": version}),
            },
        )


def run_belief_bench(
    bench: BeliefBench,
    folder: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    calibrating: Progress = lambda done, total: None,
    progress: Progress = lambda done, total: None,
    only_tables: bool = False,
    published: Path | None = None,
    rivals_from: Path | None = None,
) -> tuple[BeliefResults, list[Check]]:
    """Run what is missing, and write tables and figures of all parts that lie in the folder.

    Args:
        bench: What to run.
        folder: Where everything goes; a bench that was stopped goes on there.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        calibrating: Told how many calibrations are there and how many there will be.
        progress: Told how many episodes are done and how many there are.
        only_tables: Run nothing; published rows may be of an earlier version.
        published: Rows of this bench that count as finished: a Parquet file, or a folder of them.
        rivals_from: The folder of a belief bench, of an earlier version, too, whose trials of
            other monitors count as finished.

    Returns:
        What was found, and what of it must be reached.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    bench.check()
    version = version_of(published) if only_tables and published is not None else None
    declared = bench.declared(
        {} if only_tables else bench.wanted(),
        folder,
        calibrating,
        version,
        workers=workers,
        scheduler=scheduler,
        published=published,
    )
    if rivals_from is not None:
        take_over(rivals_from, folder, declared.settings)
    ledger = run_bench(
        declared,
        folder,
        workers=workers,
        scheduler=scheduler,
        progress=progress,
        published=published,
    )
    found = ((cell, ledger.of(cell, n)) for cell, n in bench.wanted(Part).items())
    rows = {cell: own for cell, own in found if own}
    told = {**declared.settings, **taken_over(folder)}
    results = BeliefResults(told, rows, _speed(folder / SPEED_FILE))
    return results, write_results(folder, results, bench.extent)


def _told(cell: Cell, calibration: Calibration) -> Calibration:
    """What a cell's monitor is told; of what is wrongly believed only how often it is right.

    A noise model's P(yes) says how good it truly is, which would give it away.
    """
    return learnt.by_replies(calibration) if cell.believed else calibration


def _speed(path: Path) -> Mapping[str, float]:
    """What `benchmarks/belief.py --out` measured, where it was run for this bench."""
    remedy = "Measure again, or remove it"
    found = read_object(path, remedy=remedy) or {}
    if not all(isinstance(value, int | float) for value in found.values()):
        raise BenchError(f"{path}: damaged (it holds no names with numbers). {remedy}")
    return found
