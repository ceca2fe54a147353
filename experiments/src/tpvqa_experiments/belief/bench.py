"""Runs the belief bench: calibrations first, then every missing episode, then the tables."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tpvqa.belief.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.schedule import run_all
from tpvqa.bench.settings import common_settings
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.defaults import looks
from tpvqa.errors import BenchError
from tpvqa.plugins import Kind, load, make
from tpvqa.tasks import find_task
from tpvqa_experiments.belief import calibrations as learnt
from tpvqa_experiments.belief.parts import Extent, Part, believes
from tpvqa_experiments.belief.results import BeliefResults
from tpvqa_experiments.belief.tables import write_results
from tpvqa_experiments.belief.targets import Check
from tpvqa_experiments.paper import PAPER

Told = Callable[[int, int], None]
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
        common: Seed, rates of faults, limits.
    """

    parts: Sequence[Part] = tuple(Part)
    extent: Extent = field(default_factory=Extent)
    calibration_episodes: int = 80
    embedded_world: str = "images"
    common: TrialConfig = PAPER

    def wanted(self, parts: Iterable[Part] | None = None) -> dict[Cell, int]:
        """How many episodes of each cell; a cell of several parts is run once.

        Args:
            parts: Which parts; by default those that are to be run.
        """
        found: dict[Cell, int] = {}
        for part in self.parts if parts is None else parts:
            for cell, episodes in self.extent.cells(part):
                found[cell] = max(episodes, found.get(cell, 0))
        return found

    def source_of(self, cell: Cell) -> learnt.Source:
        """Where the calibration of a cell comes from."""
        return learnt.source_of(cell, self.embedded_world)

    def check(self) -> None:
        """See that everything can be found by its name, before anything is run.

        Raises:
            TpvqaError: A task, monitor, VLM or world is not there, or its extra is missing.
        """
        for task in self.extent.tasks:
            find_task(task)
        cells = self.wanted()
        monitors = {cell.monitor: cell.task for cell in cells}
        for monitor, task in monitors.items():
            make(Kind.MONITOR, monitor, task=stage(task).task)
        for vlm in {cell.vlm for cell in cells}:
            load(Kind.VLM, vlm.partition(":")[0])
            looks(vlm)

    def settings(self) -> dict[str, Any]:
        """What decides the figures, besides the cells and the number of episodes."""
        return {
            **common_settings(self.common),
            "trials of a calibration": self.calibration_episodes,
            "how calibrations are learnt": METHOD,
            "the embedded network is calibrated in": self.embedded_world,
        }


def run_belief_bench(
    bench: BeliefBench,
    folder: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    calibrating: Told = lambda done, total: None,
    progress: Told = lambda done, total: None,
    only_tables: bool = False,
    published: Path | None = None,
) -> tuple[BeliefResults, list[Check]]:
    """Run what is missing, and write tables and figures of all parts that lie in the folder.

    Args:
        bench: What to run.
        folder: Where everything goes; a bench that was stopped goes on there.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        calibrating: Told how many calibrations are there and how many there will be.
        progress: Told how many episodes are done and how many there are.
        only_tables: Run nothing.
        published: Rows of this bench that count as finished: a Parquet file, or a folder of them.

    Returns:
        What was found, and what of it must be reached.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    bench.check()
    ledger = Ledger(folder, bench.settings(), published)
    try:
        wanted = {} if only_tables else bench.wanted()
        believing = [
            cell for cell, n in wanted.items() if believes(cell.monitor) and ledger.missing(cell, n)
        ]
        known = learnt.calibrations(
            folder / "calibrations",
            {bench.source_of(cell) for cell in believing},
            bench.common,
            bench.calibration_episodes,
            done=calibrating,
        )
        total = sum(wanted.values())
        done = total - sum(len(ledger.missing(cell, n)) for cell, n in wanted.items())
        progress(done, total)

        def count(more: int) -> None:
            nonlocal done
            done += more
            progress(done, total)

        run_all(
            ledger,
            wanted,
            bench.common,
            workers=workers,
            scheduler=scheduler,
            done=count,
            calibrations={cell: _told(cell, known[bench.source_of(cell)]) for cell in believing},
        )
        found = ((cell, ledger.of(cell, n)) for cell, n in bench.wanted(Part).items())
        rows = {cell: own for cell, own in found if own}
    finally:
        ledger.close()
    results = BeliefResults(bench.settings(), rows, _speed(folder / SPEED_FILE))
    return results, write_results(folder, results, bench.extent)


def _told(cell: Cell, calibration: Calibration) -> Calibration:
    """What a cell's monitor is told; of what is wrongly believed only how often it is right.

    A noise model's P(yes) says how good it truly is, which would give it away.
    """
    return learnt.by_replies(calibration) if cell.believed else calibration


def _speed(path: Path) -> Mapping[str, float]:
    """What `benchmarks/belief.py --out` measured, where it was run for this bench."""
    if not path.exists():
        return {}
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        return {str(name): float(value) for name, value in found.items()}
    except (OSError, ValueError, TypeError, AttributeError) as error:
        raise BenchError(f"{path}: damaged ({error}). Measure again, or remove it") from error
