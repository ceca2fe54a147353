"""`tpvqa dataset`: make, compose, check, show and score a set of pictures."""

import json
import os
from collections.abc import Sequence
from contextlib import suppress
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from tpvqa_household.cli.compose import compose

dataset = typer.Typer(help="The pictures that `--world images` draws from.", no_args_is_help=True)

Folder = Annotated[
    Path | None,
    typer.Option("--pictures", help="Folder of the set. Default: the one that comes with tpvqa."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]


class RendererName(StrEnum):
    """What can render a set."""

    CYCLES = "cycles"
    MUJOCO = "mujoco"


def register(app: typer.Typer) -> None:
    """Add the commands to the application."""
    app.add_typer(dataset, name="dataset")


dataset.command()(compose)


@dataset.command()
def build(
    out: Annotated[Path, typer.Option(help="Folder to make the set in, or to go on in.")],
    renderer: Annotated[
        RendererName, typer.Option(help="Cycles: seconds a picture. MuJoCo: much quicker, plainer.")
    ] = RendererName.CYCLES,
    workers: Annotated[int, typer.Option(min=1, help="Processes that render.")] = 1,
    samples: Annotated[int, typer.Option(min=1, help="Cycles: paths a pixel.")] = 8,
    blender_python: Annotated[
        Path | None,
        typer.Option(
            envvar="TPVQA_BLENDER_PYTHON", help="Cycles: a Python that has the module bpy."
        ),
    ] = None,
    limit: Annotated[
        int | None, typer.Option(min=1, help="Pictures for each visible state, at most.")
    ] = None,
) -> None:
    """Make a set of pictures.

    What the folder holds already is kept, if it is as wanted: a build that was stopped, by Ctrl-C
    too, goes on where it was. Exit code 1: the set that was made has gaps.
    """
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    from tpvqa_household.images.blender import find_blender_python
    from tpvqa_household.images.build import Settings
    from tpvqa_household.images.build import build as make
    from tpvqa_household.images.manifest import load_pictures
    from tpvqa_household.images.recipe import jobs
    from tpvqa_household.images.shipped_tasks import all_reachable
    from tpvqa_household.images.verify import verify as check

    python = find_blender_python(blender_python) if renderer is RendererName.CYCLES else None
    tasks = all_reachable()
    wanted = [job for job in jobs(tasks) if limit is None or job.number < limit]
    settings = Settings(renderer.value, blender=python, samples=samples)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns) as bar:
        row = bar.add_task("pictures", total=len(wanted))
        make(
            wanted,
            out,
            settings,
            workers=workers,
            progress=lambda done, total: bar.update(row, completed=done, total=total),
        )
    report = check(load_pictures(out), tasks)
    typer.echo(f"{out}: {report.pictures} pictures, {report.size / 1e6:.1f} MB")
    _say_gaps(report.gaps)


@dataset.command()
def verify(pictures: Folder = None, as_json: AsJson = False) -> None:
    """Check files, hashes, counts and truth of a set. Exit code 1: something is wrong."""
    from tpvqa_household.images.manifest import ORIGINS, load_pictures
    from tpvqa_household.images.shipped_tasks import all_reachable
    from tpvqa_household.images.verify import verify as check

    opened = load_pictures(pictures)
    report = check(opened, all_reachable())
    if as_json:
        typer.echo(
            json.dumps(
                {
                    "folder": str(opened.folder),
                    "pictures": report.pictures,
                    "bytes": report.size,
                    "renderers": dict(report.renderers),
                    "origins": dict(report.origins),
                    "meshes": dict(report.meshes),
                    "states": report.states,
                    "observations": [
                        {"task": task, "action": action, "outcome": outcome, "pictures": count}
                        for (task, action, outcome), count in report.observations.items()
                    ],
                    "gaps": report.gaps,
                },
                indent=2,
            )
        )
        if report.gaps:
            raise typer.Exit(1)
        return
    by_renderer = ", ".join(
        f"{n} {name}" if name in ORIGINS else f"{n} by {name}"
        for name, n in sorted(report.renderers.items())
    )
    typer.echo(
        f"{opened.folder}: {report.pictures} pictures ({by_renderer}; "
        f"{report.meshes['known']} with known and {report.meshes['held_out']} with held-out "
        f"meshes), {report.size / 1e6:.1f} MB"
    )
    if len(report.origins) > 1:
        typer.echo(", ".join(f"{n} {kind}" for kind, n in sorted(report.origins.items())))
    counts = list(report.states.values())
    typer.echo(f"{len(counts)} reachable visible states, {min(counts)} to {max(counts)} pictures")
    for (task, action, outcome), count in report.observations.items():
        typer.echo(f"  {task:16} {action:24} {outcome:8} {count:4}")
    _say_gaps(report.gaps)
    typer.echo("in order: files, hashes, counts and truth")


@dataset.command()
def show(
    out: Annotated[Path, typer.Argument(help="The HTML page to write.")] = Path("pictures.html"),
    pictures: Folder = None,
    *,
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is there and is no such page.")
    ] = False,
) -> None:
    """Write one page with all pictures by action and outcome."""
    from tpvqa.files import write_whole
    from tpvqa_household.images.manifest import load_pictures
    from tpvqa_household.images.sheet import contact_sheet

    opened = load_pictures(pictures)
    _see_free(out, opened.paths, force=force)
    write_whole(out, contact_sheet(opened).encode(), remedy="Name another file")
    typer.echo(f"wrote {out}")


def _see_free(page: Path, pictures: Sequence[Path], *, force: bool) -> None:
    """See that the page takes the place of no picture, and of another file only if told to.

    Raises:
        PictureSetError: It would.
    """
    from tpvqa.errors import PictureSetError
    from tpvqa.files import open_plain, resolved
    from tpvqa_household.images.sheet import HEAD

    if resolved(page) in map(resolved, pictures):
        raise PictureSetError(f"{page} is a part of the set, and would be lost; name another file")
    if force or not os.path.lexists(page):
        return
    if page.is_dir():
        raise PictureSetError(f"{page} is a folder; name the file to write")
    with suppress(OSError), os.fdopen(open_plain(page, os.O_RDONLY, follow=True), "rb") as file:
        if file.read(len(HEAD)) == HEAD.encode():
            return
    raise PictureSetError(
        f"{page} is there, and is no page with pictures; name another file, or write over it with "
        "--force"
    )


@dataset.command()
def score(
    vlm: Annotated[str, typer.Option(help="Who answers, e.g. embedded or openai:MODEL.")] = (
        "embedded"
    ),
    pictures: Folder = None,
    base_url: Annotated[str | None, typer.Option(help="Address of an OpenAI-like server.")] = None,
    every_wording: Annotated[
        bool, typer.Option("--every-wording", help="Ask in all wordings, not one.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Ask a VLM about every fact and action on every picture, and count what is right.

    Known and held-out meshes apart; by way of asking, predicate, object and action: accuracy,
    false positive and negative rate, AUROC, calibration error, hard negatives, and how often
    "cannot see" is said rightly.
    """
    from tpvqa.vlm.making import make_vlm
    from tpvqa_household.images.manifest import load_pictures
    from tpvqa_household.training import scoring
    from tpvqa_household.training.asking import Asking
    from tpvqa_household.training.picture_cases import picture_cases
    from tpvqa_household.training.recipe import Recipe

    opened = load_pictures(pictures)
    opened.check()
    asking = Asking.about(Recipe.read().task)
    asked, _ = make_vlm(vlm, {} if base_url is None else {"base_url": base_url})
    cases = picture_cases(opened)
    rows = list(scoring.score(asked, cases, asking, every_wording=every_wording))
    if as_json:
        typer.echo(json.dumps({"vlm": asked.name, **scoring.as_json(rows, asking)}, indent=2))
    else:
        typer.echo(f"{asked.name}\n\n{scoring.report(rows, asking)}")


def _say_gaps(gaps: list[str]) -> None:
    if not gaps:
        return
    for gap in gaps:
        typer.echo(f"  {gap}", err=True)
    typer.echo(
        f"{len(gaps)} gaps. `tpvqa dataset build --out FOLDER` makes what is missing", err=True
    )
    raise typer.Exit(1)
