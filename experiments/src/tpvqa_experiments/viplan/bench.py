"""Runs ViPlan's problems under noise of recorded VLMs, every missing episode, and writes tables."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tpvqa.belief.calibrating.calibration import Calibration
from tpvqa.belief.calibrating.counted import CountedFaults
from tpvqa.bench.cell import Cell
from tpvqa.bench.engine import Bench, Progress, run_bench
from tpvqa.bench.ledger import REMEDY
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stage import stage
from tpvqa.config import TrialConfig
from tpvqa.errors import BenchError
from tpvqa.files import write_whole
from tpvqa_experiments.viplan import calibrations
from tpvqa_experiments.viplan.group import LIMITS, SETTINGS, Group
from tpvqa_experiments.viplan.problems import Environment, Problem
from tpvqa_experiments.viplan.published import Key, Published
from tpvqa_experiments.viplan.tables import Line, line, markdown

BELIEF, SYMBOLIC, ORACLE = "belief", "symbolic", "oracle"
KNOWING = "knowing"
"""The limit beside the belief monitor: the same, told exactly how VLM and skills err."""
AS_TOLD = f"{BELIEF}:without=learning"
"""How that is run: it takes what it is told as it is."""
NOISES: Mapping[str, str] = {
    "scenes": "recorded-scenes:{}",
    "recorded": "recorded:{}",
    "fresh": "recorded:{}:fresh",
}
"""Ways in which answers of a model are drawn, as specifications of VLMs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ViPlanBench:
    """What to run.

    Attributes:
        problems: The problems, by name.
        models: Recorded models, or `oracle[:ACCURACY]`.
        monitors: Specifications of monitors, or `knowing`, the limit beside `belief`.
        settings: Of `SETTINGS`.
        limits: Of `LIMITS`.
        noise: Of `NOISES`; blocksworld alone has scenes, the household is `recorded` instead.
        episodes: Of every problem in every cell.
        common: Seed and options.
    """

    problems: Mapping[str, Problem]
    models: Sequence[str]
    monitors: Sequence[str]
    settings: Sequence[str] = ("no_cot",)
    limits: Sequence[str] = ("20",)
    noise: str = "scenes"
    episodes: int = 1
    common: TrialConfig = field(default_factory=TrialConfig)

    def cells(self) -> Iterator[tuple[Group, Cell]]:
        """The cells, with what each is counted under."""
        for setting in self.settings:
            for limit in self.limits:
                for model in self.models:
                    for monitor in self.monitors:
                        for name, problem in self.problems.items():
                            where = problem.environment
                            group = Group(where, setting, problem.split, model, monitor, limit)
                            yield group, self._cell(group, name)

    def _cell(self, group: Group, task: str) -> Cell:
        noise = self.noise
        if noise == "scenes" and group.environment is not Environment.BLOCKSWORLD:
            noise = "recorded"
        condition = ",".join((SETTINGS[group.setting], LIMITS[group.limit], "start=unknown"))
        recorded = group.model.partition(":")[0] != ORACLE
        vlm = NOISES[noise].format(group.model) if recorded else group.model
        monitor = group.monitor
        if monitor == KNOWING:
            told = (each.split("=") for each in SETTINGS[group.setting].split(","))
            monitor = ":".join((AS_TOLD, *(f"{name}_rate={value}" for name, value in told)))
        return Cell(task, monitor, vlm, SYMBOLIC, condition)

    def declared(self) -> Bench:
        """What the engine is given."""
        own = {name: problem.task for name, problem in self.problems.items()}
        return Bench(
            wanted=dict.fromkeys((cell for _, cell in self.cells()), self.episodes),
            common=self.common,
            own=own,
            calibrations=self._told,
        )

    def _told(self, missing: Sequence[Cell]) -> Mapping[Cell, Calibration]:
        """What the belief monitor is told in some cells."""
        groups = {cell: group for group, cell in self.cells()}
        counted = dict[tuple[Environment, str, str], CountedFaults | None]()
        found = {}
        for cell in missing:
            group, problem = groups[cell], self.problems[cell.task]
            if cell.monitor.partition(":")[0] != BELIEF:
                continue
            task = stage(cell.task, problem.task).task
            if group.monitor == KNOWING:
                found[cell] = calibrations.exact(cell.vlm, task)
            elif known := calibrations.calibration(cell.vlm, task):
                key = group.environment, group.split, group.setting
                if key not in counted:
                    alike = {
                        name: each.task
                        for name, each in self.problems.items()
                        if (each.environment, each.split) == (problem.environment, problem.split)
                    }
                    setting = SETTINGS[group.setting]
                    counted[key] = calibrations.counted(setting, self.common, alike)
                found[cell] = known.model_copy(update={"faults": counted[key]})
        return found


def run_viplan_bench(
    bench: ViPlanBench,
    folder: Path,
    published: Mapping[Key, Published],
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress = lambda done, total: None,
) -> list[Line]:
    """Run what is missing, and write `viplan.md` and `viplan.json`.

    Args:
        bench: What to run.
        folder: Where everything goes; a bench that was stopped goes on there.
        published: What came of the published runs.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        progress: Told how many episodes are done and how many there are.

    Returns:
        A line for every environment, setting, split, model, monitor and limit.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    declared = bench.declared()
    if not declared.wanted:
        raise BenchError("There is nothing to run: name models, monitors and splits")
    ledger = run_bench(declared, folder, workers=workers, scheduler=scheduler, progress=progress)
    rows: dict[Group, list[EpisodeRow]] = {}
    for group, cell in bench.cells():
        rows.setdefault(group, []).extend(ledger.of(cell, bench.episodes))
    lines = [line(group, own, published.get(group.key)) for group, own in rows.items()]
    plain = json.dumps([each.flat() for each in lines], indent=1)
    for name, text in (("viplan.json", f"{plain}\n"), ("viplan.md", markdown(lines))):
        write_whole(folder / name, text.encode(), remedy=REMEDY)
    return lines
