"""`tpvqa bench abroad`: others' domains, and worlds that are not as the problem says."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.bench_running import bench_bar, listed, listed_of
from tpvqa.config.model import MOST

if TYPE_CHECKING:
    from tpvqa.bench.own_task import OwnTask
    from tpvqa_experiments.abroad import Part

PARTS = "others,own,sensed,elsewhere,dead,failure,shipped"
CHECKOUT = Path(__file__).parents[4]
EXAMPLES, PROBLEMS = CHECKOUT / "examples", CHECKOUT / "experiments/problems"


def abroad(
    *,
    parts: Annotated[str, typer.Option(help=f"Parts, with commas: {PARTS}, nothing.")] = PARTS,
    others: Annotated[
        Path | None,
        typer.Option(help="Folder of domains of others, see experiments/tools/others_domains.py."),
    ] = None,
    own: Annotated[
        Path | None,
        typer.Option(help="Folder of domains of one's own, a folder each. Default: examples."),
    ] = None,
    tasks: Annotated[
        str, typer.Option(help="Shipped tasks, or some of the folders', with commas. Default: all.")
    ] = "",
    monitors: Annotated[str, typer.Option(help="Monitors, with commas. Default: all.")] = "",
    vlms: Annotated[str, typer.Option(help="Noise models, with commas.")] = "oracle:0.8",
    more: Annotated[
        str, typer.Option(help="Settings that every condition has besides, e.g. redo=risky.")
    ] = "",
    episodes: Annotated[int, typer.Option(help="Of every cell.", min=1)] = 300,
    others_episodes: Annotated[
        int, typer.Option(help="Of every cell of others' domains.", min=1)
    ] = 100,
    calibration_episodes: Annotated[
        int, typer.Option(help="Trials that each calibration is learnt from.", min=1)
    ] = 120,
    limit: Annotated[bool, typer.Option(help="Measure who sees all, too.")] = True,
    seed: Annotated[
        int, typer.Option(help="Decides every random number.", min=-MOST, max=MOST)
    ] = 0,
    workers: Annotated[
        int | None, typer.Option(help="Local processes. Default: one a core.", min=1)
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Address of a Dask scheduler, e.g. tcp://host:8786.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Folder; a bench that was stopped goes on.")] = Path(
        "bench-abroad"
    ),
    only_tables: Annotated[
        bool, typer.Option("--only-tables", help="Run nothing; write tables of what is finished.")
    ] = False,
    rows: Annotated[
        Path | None,
        typer.Option(help="Published rows that count as finished, e.g. experiments/rows/abroad."),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Measure monitors on domains of others, and in worlds that are not as the problem says."""
    import os

    from tpvqa.bench.condition import normalised
    from tpvqa.config import Limits, TrialConfig
    from tpvqa.errors import BenchError
    from tpvqa_experiments.abroad import AbroadBench, run_abroad_bench
    from tpvqa_experiments.abroad.bench import blocks_in, sensed
    from tpvqa_experiments.abroad.parts import MONITORS, SHIPPED, Extent
    from tpvqa_experiments.abroad.tables import lines

    noises = listed(vlms)
    if not noises:
        raise BenchError("--vlms names none: name noise models with commas, e.g. oracle:0.8")
    foreign, mine = _tasks(others), _ours(own)
    blocks = blocks_in(PROBLEMS) if PROBLEMS.is_dir() else {}
    chosen = listed_of(tasks, {*foreign, *mine, *blocks, *SHIPPED}, "task of this bench")
    ours = _chosen(mine, chosen)
    bench = AbroadBench(
        parts=[_part(name) for name in listed(parts)],
        extent=Extent(
            others=_chosen(foreign, chosen),
            own=ours,
            sensed=sensed(ours),
            blocks=_chosen(blocks, chosen),
            tasks=[name for name in SHIPPED if not chosen or name in chosen],
            monitors=listed(monitors) or MONITORS,
            vlms=noises,
            episodes=episodes,
            others_episodes=others_episodes,
            more=normalised(more),
        ),
        calibration_episodes=calibration_episodes,
        limit=limit,
        common=TrialConfig(seed=seed, limits=Limits(replans=10)),
    )
    with bench_bar(out, "calibrations") as bar:

        def progress(done: int, total: int) -> None:
            if bar.what != "episodes":
                bar.count("episodes")
            bar(done, total)

        found = run_abroad_bench(
            bench,
            out,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            calibrating=bar,
            progress=progress,
            only_tables=only_tables,
            published=rows,
        )
    if as_json:
        told = [
            {"part": str(part), **line.flat()}
            for part, rows in found.items()
            for line in lines(rows)
        ]
        print(json.dumps(told, indent=1))
    else:
        print((out / "abroad.md").read_text(encoding="utf-8"))
        print((out / "targets.md").read_text(encoding="utf-8"))
        print(f"tables: {out}/abroad.md, {out}/targets.md, and as JSON beside them")
    if any(row.error for rows in found.values() for own_rows in rows.values() for row in own_rows):
        raise typer.Exit(1)


def _ours(folder: Path | None) -> "dict[str, OwnTask]":
    if folder is not None:
        return _tasks(folder)
    return _tasks(EXAMPLES) if EXAMPLES.is_dir() else {}


def _tasks(folder: Path | None) -> "dict[str, OwnTask]":
    from tpvqa_experiments.abroad.bench import tasks_in

    return {} if folder is None else tasks_in(folder)


def _chosen(tasks: "dict[str, OwnTask]", names: tuple[str, ...]) -> "dict[str, OwnTask]":
    return {name: task for name, task in tasks.items() if not names or name in names}


def _part(name: str) -> "Part":
    from tpvqa.errors import UnknownNameError
    from tpvqa_experiments.abroad import Part

    if name not in set(Part):
        raise UnknownNameError("part of the bench abroad", name, [part.value for part in Part])
    return Part(name)
