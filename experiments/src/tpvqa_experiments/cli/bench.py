"""`tpvqa bench paper`, `belief`, `abroad`, `scenes`, `viplan`, beside the core's `bench run`."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.bench_running import EXIT, bench_bar, finish, listed
from tpvqa.config.model import MOST
from tpvqa_experiments.cli.bench_abroad import abroad
from tpvqa_experiments.cli.bench_belief import belief
from tpvqa_experiments.cli.bench_scenes import scenes
from tpvqa_experiments.cli.bench_viplan import viplan

bench_app = typer.Typer(
    help="Many episodes: completion rates, accuracy, figures.", no_args_is_help=True
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    bench_app.command(epilog=EXIT)(paper)
    bench_app.command(epilog=EXIT)(belief)
    bench_app.command(epilog=EXIT)(abroad)
    bench_app.command(epilog=EXIT)(scenes)
    bench_app.command(epilog=EXIT)(viplan)
    app.add_typer(bench_app, name="bench")


@bench_app.callback()
def _bench() -> None:
    """Many episodes: completion rates, accuracy, figures."""


def paper(
    *,
    tasks: Annotated[
        str, typer.Option(help="Shipped tasks, with commas.")
    ] = "clean_dishes,serve_breakfast,eat_apple",
    monitors: Annotated[
        str | None,
        typer.Option(
            help="Monitors, with commas. Default: those of the paper under every reading of what "
            "it leaves open, and rivals."
        ),
    ] = None,
    conditions: Annotated[
        str | None,
        typer.Option(
            help="As of `tpvqa bench run`, with semicolons between them; '' for the paper's own "
            "alone. Default: every reading, or with --monitors the paper's own."
        ),
    ] = None,
    vlm: Annotated[
        str,
        typer.Option(
            help="VLMs, with commas: embedded, openai:MODEL, oracle:ACCURACY[:RHO], paper-table, "
            "recorded:MODEL."
        ),
    ] = "embedded",
    worlds: Annotated[
        str,
        typer.Option(
            help="Of VLMs that look, with commas: images, images:paper (the paper's simulator to "
            "the letter), kitchen. Noise models are asked in the symbolic world."
        ),
    ] = "images",
    episodes: Annotated[int, typer.Option(help="Of every task and monitor.", min=1)] = 100,
    curve: Annotated[
        int | None,
        typer.Option(
            help="Episodes of every point of the accuracy curves; 0 for none. Default: as "
            "--episodes.",
            min=0,
        ),
    ] = None,
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
        "bench"
    ),
    failure: Annotated[float, typer.Option(help="P(an action fails).", min=0, max=1)] = 0.25,
    disturbance: Annotated[
        float, typer.Option(help="P(a failure undoes something achieved).", min=0, max=1)
    ] = 0.25,
    max_repeats: Annotated[int, typer.Option(help="Repeats of an action in a row.", min=0)] = 10,
    max_replans: Annotated[int, typer.Option(help="Replans in a trial.", min=0)] = 10,
    max_actions: Annotated[int, typer.Option(help="Actions in a trial.", min=1)] = 60,
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Run the paper's experiment: TPVQA against its baselines, with statistics and figures."""
    import os

    from tpvqa.config import Limits, SimulationConfig, TrialConfig
    from tpvqa_experiments.paper import PaperBench, run_paper_bench

    bench = PaperBench(
        tasks=listed(tasks),
        monitors=_readings(monitors, conditions),
        vlms=listed(vlm),
        worlds=listed(worlds),
        episodes=episodes,
        curve=episodes if curve is None else curve,
        common=TrialConfig(
            seed=seed,
            simulation=SimulationConfig(failure=failure, disturbance=disturbance),
            limits=Limits(repeats=max_repeats, replans=max_replans, actions=max_actions),
        ),
    )
    with bench_bar(out) as progress:
        results = run_paper_bench(
            bench,
            out,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            progress=progress,
        )
    finish(results, out, as_json=as_json)


def _readings(monitors: str | None, conditions: str | None) -> Mapping[str, Sequence[str]]:
    """The monitors of every condition."""
    from tpvqa.bench.condition import normalised
    from tpvqa_experiments.paper import READINGS

    if monitors is None and conditions is None:
        return READINGS
    named = [normalised(part) for part in (conditions or "").split(";")]
    return {
        each: listed(monitors) if monitors is not None else READINGS.get(each, READINGS[""])
        for each in named
    }
