"""Runs the missing episodes of a bench: in this process, or on Dask's workers."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from types import MappingProxyType

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.risk import RiskBound
from tpvqa.bench.cell import Cell
from tpvqa.bench.dask_workers import as_they_finish, dask_client
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stage import run_each
from tpvqa.config import TrialConfig

BATCH: Mapping[str, int] = {"symbolic": 20, "images": 10}
"""Episodes that a worker is sent at once, by world: as many are lost where all is stopped."""
SMALL_BATCH = 5
"""In other worlds."""
SLOW = ("belief",)
"""Monitors that are sent a fifth of that."""
RETRIES = 3
"""How often a batch whose worker died is given to another."""


@dataclass(frozen=True, slots=True)
class Batch:
    """Some missing episodes of one cell."""

    cell: Cell
    episodes: tuple[int, ...]


def batches(ledger: Ledger, wanted: Mapping[Cell, int]) -> list[Batch]:
    """What is still to be run, so ordered that all cells grow together."""
    made = []
    for place, (cell, episodes) in enumerate(wanted.items()):
        missing = ledger.missing(cell, episodes)
        if cell.carried:  # what is learned is passed on in one process, from the first of them
            size = cell.carried
            firsts = {number - number % size for number in missing}
            made += [(n, place, Batch(cell, tuple(range(n, n + size)))) for n in firsts]
            continue
        size = BATCH.get(cell.world.partition(":")[0], SMALL_BATCH)
        if cell.monitor.partition(":")[0] in SLOW:
            size = max(size // 5, 1)
        made += [
            (first, place, Batch(cell, tuple(missing[first : first + size])))
            for first in range(0, len(missing), size)
        ]
    return [batch for _, _, batch in sorted(made, key=lambda entry: entry[:2])]


def run_all(
    ledger: Ledger,
    wanted: Mapping[Cell, int],
    common: TrialConfig,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    distributed: bool | None = None,
    done: Callable[[int], None] = lambda count: None,
    calibrations: Mapping[Cell, Calibration] = MappingProxyType({}),
    own: Mapping[str, OwnTask] = MappingProxyType({}),
    risks: Mapping[Cell, RiskBound] = MappingProxyType({}),
) -> None:
    """Run every missing episode; in this process each is on disk as soon as it has ended, and a
    worker's as soon as its batch is back.

    What comes out does not depend on the workers: all chance is a function of seed and episode.

    Args:
        ledger: Where rows go.
        wanted: How many episodes of each cell.
        common: What all cells share.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        distributed: Whether to use Dask; by default with more than one worker, or a scheduler.
        done: Told how many episodes have come back.
        calibrations: What the VLM's answers are worth, of cells whose monitor is told.
        own: Tasks of the user's own, by the names that cells have for them.
        risks: Where "done" may be reported, of cells that state a risk.

    Raises:
        MissingExtraError: Dask is needed and not installed.
        BenchError: The workers do not start, or the scheduler cannot be reached.
    """
    todo = batches(ledger, wanted)
    if distributed is None:
        distributed = workers > 1 or scheduler is not None

    def given(batch: Batch) -> Given:
        cell = batch.cell
        told = calibrations.get(cell), own.get(cell.task), risks.get(cell)
        return cell, common, batch.episodes, *told

    results = _on_dask(todo, given, workers, scheduler) if distributed else _here(todo, given)
    for rows in results:
        ledger.add(rows)
        done(len(rows))


Given = tuple[
    Cell, TrialConfig, tuple[int, ...], Calibration | None, OwnTask | None, RiskBound | None
]
"""What `run_each` is called with."""


def _here(todo: Sequence[Batch], given: Callable[[Batch], Given]) -> Iterator[list[EpisodeRow]]:
    for batch in todo:
        rows = run_each(*given(batch))
        if batch.cell.carried:
            yield list(rows)
        else:
            yield from ([row] for row in rows)


def _on_dask(
    todo: Sequence[Batch], given: Callable[[Batch], Given], workers: int, scheduler: str | None
) -> Iterator[list[EpisodeRow]]:
    if not todo:
        return
    with dask_client(min(workers, len(todo)), scheduler) as client:
        futures = {
            client.submit(_values, given(batch), pure=False, retries=RETRIES): batch
            for batch in todo
        }
        for future, values, failed in as_they_finish(client, futures):
            batch = futures.pop(future)
            if failed is None:
                yield [EpisodeRow.model_validate(value) for value in values]
            else:
                yield _failed(batch, given(batch)[1], repr(failed))


def _values(given: Given) -> list[dict[str, object]]:
    """What a worker is sent: the rows of a batch as plain values."""
    return [row.model_dump() for row in run_each(*given)]


def _failed(batch: Batch, common: TrialConfig, error: str) -> list[EpisodeRow]:
    cell = batch.cell
    return [
        EpisodeRow(
            **asdict(cell),
            seed=common.seed,
            episode=episode,
            error=error,
        )
        for episode in batch.episodes
    ]
