"""`tpvqa bench scenes`: the whole state from one look, on scenes as real VLMs saw them."""

import json
from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.bench_running import listed
from tpvqa.config.model import MOST


def scenes(
    *,
    data: Annotated[
        Path,
        typer.Option(
            envvar="TPVQA_SCENES",
            help="Folder of recorded scenes: scenes.csv.gz and answers.csv.gz.",
        ),
    ],
    models: Annotated[str, typer.Option(help="Recorded VLMs, with commas. Default: all.")] = "",
    seed: Annotated[
        int,
        typer.Option(help="Decides which problems are learned from first.", min=-MOST, max=MOST),
    ] = 0,
    out: Annotated[Path, typer.Option(help="Folder for tables and figures.")] = Path(
        "bench-scenes"
    ),
    as_json: Annotated[bool, typer.Option("--json", help="Print the table as JSON.")] = False,
) -> None:
    """Measure how often the whole state is right after one look, without any noise model."""
    from tpvqa.cli.progress import CountBar
    from tpvqa_experiments.scenes import ScenesBench, run_scenes_bench
    from tpvqa_experiments.scenes.tables import lines

    bench = ScenesBench(data=data, models=listed(models), seed=seed)
    with CountBar("scenes") as bar:
        judged = run_scenes_bench(bench, out, progress=bar)
    if as_json:
        print(json.dumps([line.flat() for line in lines(judged)], indent=1))
    else:
        print((out / "scenes.md").read_text(encoding="utf-8"))
        print(f"tables: {out}/scenes.md, and as JSON beside it; figure: {out}/reliability.svg")
