"""`tpvqa bench paper` and `tpvqa bench belief`, beside the core's `tpvqa bench run`."""

from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.bench_running import EXIT, bench_bar, finish, listed
from tpvqa_experiments.cli.bench_belief import belief

bench_app = typer.Typer(
    help="Many episodes: completion rates, accuracy, figures.", no_args_is_help=True
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    bench_app.command(epilog=EXIT)(paper)
    bench_app.command(epilog=EXIT)(belief)
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
        str, typer.Option(help="Monitors, with commas; tpvqa:K votes over K looks.")
    ] = "tpvqa,effectvqa,tp,palmevqa,successvqa",
    vlm: Annotated[
        str,
        typer.Option(
            help="VLMs, with commas: embedded, openai:MODEL, oracle:ACCURACY[:RHO], paper-table, "
            "recorded:MODEL."
        ),
    ] = "embedded",
    world: Annotated[
        str | None,
        typer.Option(help="Default: images for VLMs that look, symbolic for noise models."),
    ] = None,
    episodes: Annotated[int, typer.Option(help="Of every task and monitor.", min=1)] = 100,
    curve: Annotated[
        int | None,
        typer.Option(
            help="Episodes of every point of the accuracy curves; 0 for none. Default: as "
            "--episodes.",
            min=0,
        ),
    ] = None,
    seed: Annotated[int, typer.Option(help="Decides every random number.")] = 0,
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
        monitors=listed(monitors),
        vlms=listed(vlm),
        world=world,
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
