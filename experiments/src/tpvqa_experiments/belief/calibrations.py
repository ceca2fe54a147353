"""What each VLM's answers are worth, learnt from trials that no cell of the bench runs."""

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from tpvqa.belief.calibrating.calibration import Calibration, Group
from tpvqa.belief.calibrating.fitting import fit
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.belief.calibrating.own_words import OwnWords
from tpvqa.bench.cell import Cell
from tpvqa.bench.condition import RATES, settings_of
from tpvqa.bench.dask_workers import as_they_finish, dask_client
from tpvqa.bench.folders import folder_within
from tpvqa.bench.labelled import gather
from tpvqa.bench.labelled_recordings import label_recordings
from tpvqa.bench.own_task import OwnTask
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.defaults import SURVEY, looks
from tpvqa.errors import BenchError, TpvqaError
from tpvqa.vlm.flawed import SAME
from tpvqa.vlm.recorded.spec import RecordedSpec
from tpvqa.vlm.recorded.vlm import told_by
from tpvqa_experiments.belief.lasting import KNOWS

RECORDED = "recorded:"
MISREAD = "flawed:misread:"

LOOKING = "tpvqa:3"
"""Who asks VLMs that look: it also goes where things lie elsewhere. Its first answers count."""
CALIBRATIONS = "calibrations"
"""Where they are kept, in the folder of a bench and in one of published rows."""
OTHER_SEEDS = 10_000
"""How far the seed of these trials lies from that of the bench."""


@dataclass(frozen=True, slots=True, order=True)
class Source:
    """Where a calibration comes from.

    Attributes:
        task: A task.
        vlm: Who answers.
        world: Specification of the world.
        faults: The rates of faults there, and what comes of redoing, as a condition; empty for
            those that all cells share.
    """

    task: str
    vlm: str
    world: str
    faults: str = ""

    @property
    def file(self) -> str:
        """The name of the calibration's file."""
        name = "_".join(filter(None, (self.vlm, self.task, self.world, self.faults)))
        return f"{name}.json".replace(":", "-").replace("/", "-")


def source_of(cell: Cell, embedded_world: str = "images") -> Source:
    """Where the calibration of a cell comes from.

    A recorded VLM that answers by one half of its problems is calibrated on the other half; one
    that misreads the same questions in every trial on trials that each misread their own. Who
    knows how answers err is calibrated on the very same.

    Args:
        cell: Which.
        embedded_world: Where the embedded network's trials are run.
    """
    vlm, world = cell.believed or cell.vlm, cell.world
    if vlm.startswith(RECORDED) and cell.monitor not in KNOWS.values():
        vlm = RECORDED + str(RecordedSpec.parse(vlm.removeprefix(RECORDED)).other_half())
    if vlm.startswith(MISREAD):
        vlm = vlm.partition(f":{SAME}")[0]
    if vlm == "embedded":
        world = embedded_world
    rates = settings_of(cell.condition).items()
    faults = ",".join(f"{name}={value}" for name, value in rates if name in (*RATES, "redo"))
    return Source(cell.task, vlm, world, faults)


def calibrations(
    folder: Path,
    sources: Collection[Source],
    common: TrialConfig,
    episodes: int,
    *,
    done: Callable[[int, int], None] = lambda done, total: None,
    own: Mapping[str, OwnTask] = MappingProxyType({}),
    workers: int = 1,
    scheduler: str | None = None,
    published: Path | None = None,
) -> dict[Source, Calibration]:
    """Load what lies in a folder already, or beside published rows, and learn the rest; each is
    kept as soon as it is learnt.

    Args:
        folder: Where they are kept, a file each.
        sources: Which are needed.
        common: Seed of the bench, rates of faults, limits.
        episodes: Trials that each is learnt from.
        done: Told how many there are, and of how many.
        own: Tasks of the user's own, by name.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        published: A folder of rows that were run with the same settings; in its folder
            `CALIBRATIONS` are those that they were run with.

    Raises:
        TpvqaError: A trial cannot be run, a file is damaged or cannot be written.
    """
    files = {source: folder / source.file for source in sorted(sources)}
    found = dict[Source, Calibration]()
    for lie in filter(None, (published and published / CALIBRATIONS, folder)):
        kept = {source: lie / source.file for source in files}
        found |= {each: Calibration.load(path) for each, path in kept.items() if path.exists()}
    away = common.but(seed=common.seed + OTHER_SEEDS)
    todo = [(each, away, episodes, own.get(each.task)) for each in files if each not in found]
    done(len(found), len(files))
    if todo:
        folder_within(folder.parent, folder.name)  # which is seen before the trials, not after
    here = len(todo) < 2 or (workers < 2 and scheduler is None)
    learning = (
        ((given[0], learnt(*given)) for given in todo)
        if here
        else _on_dask(todo, workers, scheduler)
    )
    for source, calibration in learning:
        calibration.save(files[source])
        found[source] = calibration
        done(len(found), len(files))
    return found


Given = tuple[Source, TrialConfig, int, OwnTask | None]
"""What `learnt` is called with."""


def learnt(
    source: Source, common: TrialConfig, episodes: int, own: OwnTask | None = None
) -> Calibration:
    """Learn one calibration.

    Args:
        source: Which.
        common: Seed of these trials, rates of faults, limits.
        episodes: So many trials.
        own: The task, where it is the user's own.

    Raises:
        TpvqaError: A trial cannot be run.
    """
    looking = looks(source.vlm)
    monitor = LOOKING if looking else SURVEY
    cell = Cell(source.task, monitor, source.vlm, source.world, source.faults)
    heard = OwnWords()
    rows = gather(cell, common, range(episodes), own=own, heard=heard)
    found = fit(rows, source.vlm, chosen_looks=looking)
    if source.vlm.startswith(RECORDED):
        found = _of_recordings(source, rows, found, own)
    return found.hearing(heard)


def _on_dask(
    todo: Sequence[Given], workers: int, scheduler: str | None
) -> Iterator[tuple[Source, Calibration]]:
    with dask_client(min(workers, len(todo)), scheduler) as client:
        futures = {client.submit(_text, given, pure=False): given[0] for given in todo}
        for future, text, failed in as_they_finish(client, futures):
            source = futures.pop(future)
            if isinstance(failed, TpvqaError):
                raise failed
            if failed is not None:
                raise BenchError(f"No calibration of {source} was learnt: {failed!r}") from failed
            yield source, Calibration.model_validate_json(text)


def _text(given: Given) -> str:
    """What a worker is sent back: a calibration as it is written."""
    return learnt(*given).model_dump_json()


def _of_recordings(
    source: Source, rows: Collection[LabelledAnswer], drawn: Calibration, own: OwnTask | None
) -> Calibration:
    """What recorded answers teach, each once in a group. Trials only tell how looks repeat
    and errors last."""
    told = told_by(source.vlm.removeprefix(RECORDED), stage(source.task, own).task)
    recordings = label_recordings(told, {(row.way, row.predicate) for row in rows})
    kinds = {(way, truth) for way in ("precondition", "effect") for truth in (True, False)}
    distinct = sum(each.count for way, truth in kinds for each in told.of(way, "", truth=truth))
    return fit(recordings, source.vlm, chosen_looks=False).model_copy(
        update={
            "rows": distinct,
            "repeat_same_view": drawn.repeat_same_view,
            "repeat_other_view": drawn.repeat_other_view,
            "pairs_same_view": drawn.pairs_same_view,
            "pairs_other_view": drawn.pairs_other_view,
            "lasting": drawn.lasting,
        }
    )


def by_replies(calibration: Calibration) -> Calibration:
    """The same calibration for a VLM that says yes or no and not how sure it is."""

    def blind(group: Group) -> Group:
        return group.model_copy(update={"curve": None})

    return calibration.model_copy(
        update={
            "groups": tuple(map(blind, calibration.groups)),
            "ways": tuple(map(blind, calibration.ways)),
            "whole": blind(calibration.whole),
        }
    )
