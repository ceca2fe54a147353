"""The paper's experiment: TPVQA against its four baselines on three tasks."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.curve import curve_cells, curves
from tpvqa.bench.engine import Bench, Progress, run_bench
from tpvqa.bench.grid import can_answer
from tpvqa.bench.ledger import Ledger
from tpvqa.bench.report import WAYS, WORDS, AnswerLine, Results, write_bench_report
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.tables import write_tables
from tpvqa.config import Limits, TrialConfig
from tpvqa.defaults import looks
from tpvqa.planning.fast_downward import FastDownward
from tpvqa.questions import Way
from tpvqa.vlm.making import in_full, make_vlm
from tpvqa.vlm.metrics import measure
from tpvqa_experiments.balanced import Judged, balanced
from tpvqa_experiments.paper_table import PAPER_TABLE

TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
PAPER = TrialConfig(limits=Limits(actions=60, replans=10))
"""What all trials share, where nothing else is said."""
MONITORS = ("tpvqa", "effectvqa", "tp", "palmevqa", "successvqa")
STRICT = ("tpvqa:strict", "effectvqa:strict")
"""The monitors with a majority, under its other reading."""
PLAIN = ("tpvqa:no-alternatives", "tpvqa:strict:no-alternatives")
"""Without the question where else a thing is, which the paper does not ask."""
RIVALS = ("blind:5", "vote:5", "lead:4")
READINGS = {
    "": (*MONITORS, *STRICT, *PLAIN),
    "limits=none": (*MONITORS, *STRICT, *PLAIN, *RIVALS),
    "limits=none,redo=risky": (*MONITORS, *STRICT, *RIVALS),
}
"""What the paper leaves open: limits of ten or none; whether it is free to redo what is done."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PaperBench:
    """What to run.

    Attributes:
        tasks: Shipped tasks.
        monitors: Specifications of monitors, by the condition under which they run.
        vlms: Specifications of VLMs.
        worlds: Specifications of worlds where a VLM looks; all others are asked in the symbolic.
        episodes: Of every cell.
        curve: Episodes of every point of the accuracy curves; 0 for none.
        common: Seed, rates of faults, limits.
    """

    tasks: Sequence[str] = TASKS
    monitors: Mapping[str, Sequence[str]] = field(default_factory=lambda: READINGS)
    vlms: Sequence[str] = ("embedded",)
    worlds: Sequence[str] = ("images",)
    episodes: int = 100
    curve: int = 100
    common: TrialConfig = PAPER

    def cells(self) -> list[Cell]:
        """The cells of the tables."""
        return [
            Cell(task, monitor, vlm, world, condition)
            for vlm in map(in_full, self.vlms)
            for world in (self.worlds if looks(vlm) else ("symbolic",))
            for condition, monitors in self.monitors.items()
            for task in self.tasks
            for monitor in monitors
            if can_answer(vlm, monitor)
        ]

    def curve_cells(self) -> list[Cell]:
        """The cells of the accuracy curves."""
        return curve_cells(self.tasks, self.unchanged) if self.curve else []

    @property
    def unchanged(self) -> Sequence[str]:
        """The monitors of the curves: those of the paper's own conditions, without readings."""
        first = next(iter(self.monitors.values()))
        return [each for each in first if each not in (*STRICT, *PLAIN)]

    def declared(self) -> Bench:
        """What the engine is given."""
        wanted: dict[Cell, int] = {}
        for cells, episodes in ((self.cells(), self.episodes), (self.curve_cells(), self.curve)):
            wanted |= {cell: max(episodes, wanted.get(cell, 0)) for cell in cells}
        return Bench(wanted=wanted, common=self.common)

    def settings(self) -> dict[str, Any]:
        """What decides the figures, besides the cells and the number of episodes."""
        return self.declared().settings


def run_paper_bench(
    bench: PaperBench,
    folder: Path,
    *,
    workers: int = 1,
    scheduler: str | None = None,
    progress: Progress = lambda done, total: None,
) -> Results:
    """Run what is missing, and write tables, figures and the report.

    Args:
        bench: What to run.
        folder: Where everything goes; a bench that was stopped goes on there.
        workers: Local processes.
        scheduler: Address of a Dask scheduler to use instead.
        progress: Told how many episodes are done and how many there are.

    Raises:
        TpvqaError: Something is not there, or the folder cannot be used.
    """
    ledger = run_bench(
        bench.declared(), folder, workers=workers, scheduler=scheduler, progress=progress
    )
    results = _results(bench, ledger)
    write_tables(folder, results)
    write_bench_report(folder, results)
    return results


def _results(bench: PaperBench, ledger: Ledger) -> Results:
    rows = {cell: ledger.of(cell, bench.episodes) for cell in bench.cells()}
    curve: dict[Cell, Sequence[EpisodeRow]] = {
        cell: ledger.of(cell, bench.curve) for cell in bench.curve_cells()
    }
    known = [task for task in bench.tasks if task in TASKS]
    lines = {vlm: balanced_lines(vlm, known, bench.common) for vlm in filter(looks, bench.vlms)}
    return Results(
        settings={
            **bench.settings(),
            "episodes a cell": bench.episodes,
            "tasks": ", ".join(bench.tasks),
            "monitors": "; ".join(
                f"{condition or 'as in the paper'}: {', '.join(monitors)}"
                for condition, monitors in bench.monitors.items()
            ),
            "VLMs": ", ".join(bench.vlms),
        },
        rows=rows,
        balanced=lines,
        curves=curves(curve, bench.tasks, bench.unchanged) if bench.curve else {},
        published=PAPER_TABLE,
    )


def balanced_lines(vlm_spec: str, tasks: Sequence[str], common: TrialConfig) -> list[AnswerLine]:
    """How right a VLM is on the balanced set of each task."""
    vlm, _ = make_vlm(vlm_spec, common.plugin_options())
    planner = FastDownward()
    lines = []
    try:
        for task in tasks:
            by_way: dict[Way, list[Judged]] = defaultdict(list)
            for judged in balanced(vlm, task, planner, seed=common.seed):
                by_way[judged.way].append(judged)
            for way in WAYS:
                scored = [each.scored for each in by_way[way] if each.scored is not None]
                decided = [each.right for each in by_way[way] if each.scored is None]
                if scored:
                    lines.append(
                        AnswerLine(
                            task,
                            WORDS[way],
                            "balanced",
                            measure(scored),
                            sum(decided) / len(decided),
                            PAPER_TABLE.get(way, {}).get(task),
                        )
                    )
    finally:
        planner.close()
    return lines
