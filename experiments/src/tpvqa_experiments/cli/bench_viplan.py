"""`tpvqa bench viplan`: the problems of the ViPlan benchmark under noise of recorded VLMs."""

import json
from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.bench_running import bench_bar, listed, listed_of
from tpvqa.config.model import MOST


def viplan(
    *,
    problems: Annotated[
        Path,
        typer.Option(help="Folder of ViPlan's problems, and of grounder.csv, as published."),
    ] = Path("viplan-problems"),
    environments: Annotated[
        str, typer.Option(help="Environments, with commas: blocksworld, igibson.")
    ] = "blocksworld",
    splits: Annotated[str, typer.Option(help="Splits, with commas.")] = "simple,medium,hard",
    models: Annotated[
        str,
        typer.Option(
            help="Recorded models, tables of your own (FILE[:MODEL], not with scenes), or "
            "oracle[:ACCURACY], with commas. Default: all recorded models."
        ),
    ] = "",
    monitors: Annotated[
        str,
        typer.Option(
            help="Monitors, with commas; `knowing` is the limit beside belief, told exactly how "
            "answers and skills err (not with scenes)."
        ),
    ] = "grounder,belief",
    settings: Annotated[
        str, typer.Option(help="no_cot, or fail01_no_cot in which one action in ten fails.")
    ] = "no_cot",
    limit: Annotated[
        str, typer.Option(help="Actions in a trial, with commas: 20 as ViPlan allows, none.")
    ] = "20",
    noise: Annotated[
        str,
        typer.Option(
            help="How answers are drawn: scenes (blocksworld: whole recorded scenes of the same "
            "shape), recorded (recorded:MODEL), fresh (recorded:MODEL:fresh)."
        ),
    ] = "scenes",
    episodes: Annotated[int, typer.Option(help="Of every problem in every cell.", min=1)] = 1,
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
        "bench-viplan"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Measure monitors on ViPlan's problems, beside what its own grounder reached on them."""
    import os

    from tpvqa.config import Limits, TrialConfig
    from tpvqa.errors import BenchError
    from tpvqa.vlm.recorded.spec import RecordedSpec
    from tpvqa_experiments.viplan.bench import NOISES, ORACLE, ViPlanBench, run_viplan_bench
    from tpvqa_experiments.viplan.group import LIMITS, SETTINGS
    from tpvqa_experiments.viplan.problems import SPLITS, Environment, problems_in
    from tpvqa_experiments.viplan.published import MODELS, published

    wanted = [split for split in SPLITS if split in listed_of(splits, SPLITS, "split")]
    chosen = {
        name: problem
        for where in listed_of(environments, [each.value for each in Environment], "environment")
        for name, problem in problems_in(problems, Environment(where), wanted).items()
    }
    oracles = [name for name in listed(models) if name.partition(":")[0] == ORACLE]
    tables = [name for name in listed(models) if RecordedSpec.names_table(name)]
    if tables and noise == "scenes":
        raise BenchError(f"{tables[0]} holds no whole scenes. Say --noise recorded, or fresh")
    names = sorted(MODELS.values())
    bench = ViPlanBench(
        problems=chosen,
        models=listed_of(models, [*names, *oracles, *tables], "recorded model") or names,
        monitors=listed(monitors),
        settings=listed_of(settings, SETTINGS, "setting"),
        limits=listed_of(limit, LIMITS, "limit"),
        noise=listed_of(noise, NOISES, "noise")[0],
        episodes=episodes,
        common=TrialConfig(seed=seed, limits=Limits(replans=10)),
    )
    recorded = published(problems)
    with bench_bar(out) as progress:
        lines = run_viplan_bench(
            bench,
            out,
            recorded,
            workers=workers or os.cpu_count() or 1,
            scheduler=scheduler,
            progress=progress,
        )
    if as_json:
        print(json.dumps([each.flat() for each in lines], indent=1))
    else:
        print((out / "viplan.md").read_text(encoding="utf-8"))
        print(f"table: {out}/viplan.md, and as JSON beside it")
    if any(each.errors for each in lines):
        raise typer.Exit(1)
