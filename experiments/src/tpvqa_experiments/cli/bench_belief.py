"""`tpvqa bench belief`: the belief monitor against votes and the paper's baselines."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.bench_running import bench_bar, listed, listed_of
from tpvqa.config.model import MOST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tpvqa_experiments.belief import Part
    from tpvqa_experiments.belief.check import Check


def belief(
    *,
    parts: Annotated[
        str,
        typer.Option(
            help="Parts, with commas: grid, rivals, paper, embedded, recorded, wrong-model, "
            "wrong-vlm, ablations, lasting."
        ),
    ] = "grid,rivals,paper,embedded,recorded,wrong-model,wrong-vlm,ablations,lasting",
    tasks: Annotated[
        str, typer.Option(help="Shipped tasks, with commas.")
    ] = "clean_dishes,serve_breakfast,eat_apple,build_tower",
    accuracies: Annotated[
        str, typer.Option(help="Of the grid's noise models, with commas.")
    ] = "0.6,0.7,0.8,0.9,0.95",
    rhos: Annotated[
        str,
        typer.Option(help="Chances that a further look repeats the last answer, with commas."),
    ] = "0,0.5",
    prices: Annotated[
        str, typer.Option(help="Costs of a question along the grid's curves, with commas.")
    ] = "10,3,2,1,0.3,0.1,0.03,0.003",
    models: Annotated[str, typer.Option(help="Recorded VLMs, with commas. Default: all.")] = "",
    monitors: Annotated[
        str, typer.Option(help="Run only cells of these monitors, with commas. Default: all.")
    ] = "",
    vlms: Annotated[
        str, typer.Option(help="Run only cells of these VLMs, with commas. Default: all.")
    ] = "",
    episodes: Annotated[
        int, typer.Option(help="Of every cell of the belief monitor.", min=1)
    ] = 1000,
    rivals: Annotated[int, typer.Option(help="Of every cell of another monitor.", min=1)] = 200,
    curve_episodes: Annotated[
        int, typer.Option(help="Of every further point of a curve.", min=1)
    ] = 100,
    chains: Annotated[
        int,
        typer.Option(
            help="Robots that learn, over 30 episodes each, how good their VLM is.", min=1
        ),
    ] = 30,
    lasting_episodes: Annotated[
        int, typer.Option(help="Of every cell of the part lasting, ours or a rival's.", min=1)
    ] = 300,
    calibration_episodes: Annotated[
        int, typer.Option(help="Trials that each calibration is learnt from.", min=1)
    ] = 120,
    embedded_calibration: Annotated[
        str, typer.Option(help="World where the embedded network is calibrated: images or kitchen.")
    ] = "images",
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
        "bench-belief"
    ),
    only_tables: Annotated[
        bool, typer.Option("--only-tables", help="Run nothing; write tables of what is finished.")
    ] = False,
    rows: Annotated[
        Path | None,
        typer.Option(help="Published rows that count as finished, e.g. experiments/rows/belief."),
    ] = None,
    rivals_from: Annotated[
        Path | None,
        typer.Option(
            help="A folder of this bench, of an earlier version, too: its trials of other "
            "monitors count as finished."
        ),
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Measure the belief monitor against votes over several looks and the paper's baselines."""
    import os

    from tpvqa.vlm.recorded.answers import models as recorded_models
    from tpvqa_experiments.belief import BeliefBench, run_belief_bench
    from tpvqa_experiments.belief.lasting_tables import lasting_rows
    from tpvqa_experiments.belief.parts import Extent
    from tpvqa_experiments.belief.tables import LASTING, summary_rows
    from tpvqa_experiments.paper import PAPER

    bench = BeliefBench(
        parts=[_part(name) for name in listed(parts)],
        extent=Extent(
            tasks=listed(tasks),
            accuracies=_numbers(accuracies, "--accuracies", most=1),
            rhos=_numbers(rhos, "--rhos", most=1),
            prices=_numbers(prices, "--prices"),
            models=listed_of(models, recorded_models(), "recorded VLM"),
            episodes=episodes,
            rivals=rivals,
            curve=curve_episodes,
            chains=chains,
            lasting=lasting_episodes,
        ),
        calibration_episodes=calibration_episodes,
        embedded_world=embedded_calibration,
        monitors=listed(monitors),
        vlms=listed(vlms),
        common=PAPER.but(seed=seed),
    )
    with bench_bar(out, "calibrations") as bar:

        def progress(done: int, total: int) -> None:
            if bar.what != "episodes":
                bar.count("episodes")
            bar(done, total)

        results, checks = run_belief_bench(
            bench,
            out,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            calibrating=bar,
            progress=progress,
            only_tables=only_tables,
            published=rows,
            rivals_from=rivals_from,
        )
    if as_json:
        told = {
            "targets": [check.flat() for check in checks],
            "cells": summary_rows(results),
            "lasting": lasting_rows(results, bench.extent),
        }
        print(json.dumps(told, indent=1))
    else:
        _print(checks)
        print(f"tables and figures: {out}/belief.md, {out}/targets.md, {out}/figures")
        if (out / LASTING).exists():
            print(f"errors that last: {out}/{LASTING}")
    if results.errors:
        raise typer.Exit(1)


def _print(checks: "Sequence[Check]") -> None:
    from rich.table import Table

    from tpvqa.cli.consoles import ResultConsole

    table = Table(title="targets", title_justify="left", title_style="bold", box=None)
    for name in ("condition", "figure"):
        table.add_column(name)
    for name in ("target", "measured", "95% interval", "reached"):
        table.add_column(name, justify="right", no_wrap=True)
    last = ""
    for check in checks:
        if check.measured is None:
            continue
        found = check.measured
        table.add_row(
            check.condition if check.condition != last else "",
            check.what,
            check.target,
            f"{found.value:.3g}",
            f"{found.low:.3g} to {found.high:.3g}" if found.low < found.high else "",
            {True: "yes", False: "no", None: ""}[check.reached],
        )
        last = check.condition
    console = ResultConsole()
    (console if console.is_terminal else ResultConsole(width=150)).print(table)
    missing = sum(check.measured is None for check in checks)
    if missing:
        print(f"\n{missing} of {len(checks)} figures were not measured")


def _numbers(text: str, option: str, *, most: float | None = None) -> tuple[float, ...]:
    from math import inf, isfinite

    from tpvqa.errors import BenchError, shown

    try:
        found = tuple(float(part) for part in listed(text))
    except ValueError:
        found = ()
    if not found or not all(isfinite(each) and 0 <= each <= (most or inf) for each in found):
        of = f" from 0 to {most:g}" if most else " not below 0"
        raise BenchError(f"{option} {shown(text)}: write numbers{of} with commas, e.g. 0.6,0.8")
    return found


def _part(name: str) -> "Part":
    from tpvqa.errors import UnknownNameError
    from tpvqa_experiments.belief import Part

    if name not in set(Part):
        raise UnknownNameError("part of the belief bench", name, [part.value for part in Part])
    return Part(name)
