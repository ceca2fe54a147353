"""Runs the bench abroad: calibrations, every missing episode, the limit, the tables."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import Bench, Progress, run_bench
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.own_task import OwnTask, own_tasks
from tpvqa.bench.published import version_of
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.tasks import find_task
from tpvqa_experiments.abroad.parts import SEEING, Extent, Part, believes, limits_of
from tpvqa_experiments.abroad.repeating import repeating
from tpvqa_experiments.abroad.results import write_results
from tpvqa_experiments.abroad.seeing import seeing
from tpvqa_experiments.belief import calibrations as learnt

WORLD = "world-sensed.yaml"
AT_ONCE = 20
"""Episodes of the limit that are written together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AbroadBench:
    """What to run.

    Attributes:
        parts: Which parts.
        extent: How much of them.
        calibration_episodes: Trials that each calibration is learnt from.
        limit: Whether to measure the limits, too: who sees all, and what repetition can do.
        common: Seed, rates of faults, limits.
    """

    parts: Sequence[Part] = tuple(Part)
    extent: Extent = field(default_factory=Extent)
    calibration_episodes: int = 120
    limit: bool = True
    common: TrialConfig = field(default_factory=TrialConfig)

    def wanted(self) -> dict[Cell, int]:
        """How many episodes of each cell; a cell of several parts is run once."""
        found: dict[Cell, int] = {}
        for part in self.parts:
            for cell, episodes in self.extent.cells(part):
                found[cell] = max(episodes, found.get(cell, 0))
        return found

    def limits(self) -> dict[Cell, int]:
        """How many episodes of each limit, in every task and condition that is run."""
        found: dict[Cell, int] = {}
        for part in self.parts if self.limit else ():
            for cell, episodes in self.extent.cells(part):
                for name in limits_of(part):
                    limit = replace(cell, monitor=name)
                    found[limit] = max(episodes, found.get(limit, 0))
        return found

    def declared(
        self,
        folder: Path,
        calibrating: Progress,
        version: str | None = None,
        *,
        workers: int = 1,
        scheduler: str | None = None,
        published: Path | None = None,
    ) -> Bench:
        """What the engine is given.

        Args:
            folder: Where calibrations are kept.
            calibrating: Told how many calibrations are there and how many there will be.
            version: That of rows of which only tables are made.
            workers: Local processes, which learn calibrations, too.
            scheduler: Address of a Dask scheduler to use instead.
            published: A folder of rows; calibrations may lie in it.
        """
        extent = self.extent

        def told(missing: Sequence[Cell]) -> Mapping[Cell, Calibration]:
            believing = [
                cell
                for cell in missing
                if believes(cell.monitor) and cell.task not in extent.others
            ]
            known = learnt.calibrations(
                folder / learnt.CALIBRATIONS,
                {learnt.source_of(cell) for cell in believing},
                self.common,
                self.calibration_episodes,
                done=calibrating,
                own=extent.tasks_of_files,
                workers=workers,
                scheduler=scheduler,
                published=published,
            )
            return {cell: known[learnt.source_of(cell)] for cell in believing}

        return Bench(
            wanted=self.wanted(),
            common=self.common,
            own=extent.tasks_of_files,
            calibrations=told,
            more_settings={
                "trials of a calibration": self.calibration_episodes,
                **({} if version is None else {"version": version}),
            },
        )


def run_abroad_bench(
    bench: AbroadBench,
    folder: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    calibrating: Progress = lambda done, total: None,
    progress: Progress = lambda done, total: None,
    only_tables: bool = False,
    published: Path | None = None,
) -> dict[Part, dict[Cell, Sequence[EpisodeRow]]]:
    """Run what is missing, and write tables of the parts that were named.

    Args:
        bench: What to run.
        folder: Where everything goes; a bench that was stopped goes on there.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        calibrating: Told how many calibrations are there and how many there will be.
        progress: Told how many episodes are done and how many there are.
        only_tables: Run nothing; published rows may be of an earlier version.
        published: Rows of this bench that count as finished: a Parquet file, or a folder of them.

    Returns:
        The episodes of every cell, by part; those of who sees all are among them.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    version = version_of(published) if only_tables and published is not None else None
    declared = bench.declared(
        folder, calibrating, version, workers=workers, scheduler=scheduler, published=published
    )
    for cell in declared.wanted:
        cell.config(bench.common, 0)  # says which of its settings cannot be
    if not declared.wanted:
        unfelt = Part.SENSED in bench.parts and not bench.extent.sensed
        raise BenchError(
            "There is nothing to run: none of these parts has such a task. `--parts` and `--tasks` "
            "choose; domains of others are named with --others FOLDER, see "
            "experiments/tools/others_domains.py"
            + (f"; the part sensed takes domains of --own with a {WORLD} beside" if unfelt else "")
        )
    ledger = run_bench(
        replace(declared, wanted={}) if only_tables else declared,
        folder,
        workers=workers,
        scheduler=scheduler,
        progress=progress,
        published=published,
    )
    limits = bench.limits()
    if not only_tables and any(ledger.missing(cell, count) for cell, count in limits.items()):
        ledger = Ledger(folder, declared.settings, published)
        try:
            for rows in _limits(bench, ledger, limits):
                ledger.add(rows)
        finally:
            ledger.close()
    found = {part: dict(_rows(bench, part, ledger, limits)) for part in bench.parts}
    write_results(folder, declared.settings, found)
    return found


def _limits(
    bench: AbroadBench, ledger: Ledger, limits: Mapping[Cell, int]
) -> Iterator[list[EpisodeRow]]:
    own = bench.extent.tasks_of_files
    for cell, count in limits.items():
        here, missing = stage(cell.task, own.get(cell.task)), ledger.missing(cell, count)
        for first in range(0, len(missing), AT_ONCE):
            numbers = missing[first : first + AT_ONCE]
            run = seeing if cell.monitor == SEEING else repeating
            yield [run(here, cell, bench.common, number) for number in numbers]


def _rows(
    bench: AbroadBench, part: Part, ledger: Ledger, limits: Mapping[Cell, int]
) -> Iterator[tuple[Cell, Sequence[EpisodeRow]]]:
    for cell, count in bench.extent.cells(part):
        beside = (replace(cell, monitor=name) for name in limits_of(part))
        for each in (cell, *(limit for limit in beside if limit in limits)):
            rows = ledger.of(each, count)
            if rows:
                yield each, rows


def tasks_in(folder: Path) -> dict[str, OwnTask]:
    """The tasks that lie in a folder, a folder each, by the names of their problems.

    Raises:
        BenchError: There are none, or a file cannot be read.
    """
    folders = sorted(each.parent for each in folder.glob("*/domain.pddl"))
    if not folders:
        raise BenchError(f"{folder} holds no folder with a domain.pddl and a problem")
    return own_tasks(folders)


def blocks_in(folder: Path) -> dict[str, OwnTask]:
    """The problems of the shipped blocksworld that lie in a folder.

    Raises:
        BenchError: There are none, or a file cannot be read.
    """
    shipped = find_task("build_tower")
    return own_tasks(
        [folder], domain=shipped.domain, questions=shipped.questions, world_file=shipped.world
    )


def sensed(tasks: Mapping[str, OwnTask]) -> dict[str, OwnTask]:
    """Those of some tasks that have a `world-sensed.yaml`, with that, as NAME-sensed.

    Raises:
        BenchError: A file cannot be read.
    """
    found = {}
    for name, task in tasks.items():
        world = task.origin.domain.parent / WORLD
        if world.exists():
            found[f"{name}-sensed"] = OwnTask.read(replace(task.origin, world=world))
    return found
