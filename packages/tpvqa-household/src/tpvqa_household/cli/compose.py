"""`tpvqa dataset compose`: photos, variations and pictures from prompts, as the paper had them."""

import json
import sys
from collections import Counter
from collections.abc import Sequence
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from tpvqa_household.images.sources.compose import Composed
    from tpvqa_household.images.sources.photos import Shelf
    from tpvqa_household.images.sources.plan import Wanted


class TaskName(StrEnum):
    """The tasks that pictures are made for."""

    CLEAN_DISHES = "clean_dishes"
    SERVE_BREAKFAST = "serve_breakfast"
    EAT_APPLE = "eat_apple"


def compose(
    out: Annotated[Path, typer.Option(help="Folder to make the set in, or to go on in.")],
    photos: Annotated[
        Path | None,
        typer.Option(help="Folder of your photos, in <action>/<success|failure>/."),
    ] = None,
    photo_labels: Annotated[
        Path | None,
        typer.Option(help="Their labels as CSV: file, task, action, outcome, facts."),
    ] = None,
    variations: Annotated[
        str, typer.Option(help="openai:MODEL, diffusers:MODEL, rerender or none.")
    ] = "rerender",
    prompts: Annotated[str, typer.Option(help="openai:MODEL, diffusers:MODEL or none.")] = "none",
    prompt_files: Annotated[
        Path | None, typer.Option(help="Folder of prompts of your own: TASK.yaml, style.yaml.")
    ] = None,
    shares: Annotated[
        str, typer.Option(help="Percent photos, variations, from prompts.")
    ] = "20,60,20",
    count: Annotated[
        int,
        typer.Option("--per-outcome", min=1, max=10_000, help="Pictures of each action's outcome."),
    ] = 10,
    task: Annotated[
        list[TaskName] | None, typer.Option(help="Only this task; may be repeated.")
    ] = None,
    fill: Annotated[
        bool,
        typer.Option(help="Add rendered pictures of what else the tasks can come to."),
    ] = True,
    base_url: Annotated[
        str | None, typer.Option(help="openai: address of a server of your own.")
    ] = None,
    price: Annotated[
        float | None,
        typer.Option(min=0, max=10_000, help="openai: dollars a picture, to say what it costs."),
    ] = None,
    per_minute: Annotated[
        float | None, typer.Option(min=0.01, help="openai: requests a minute, at most.")
    ] = None,
    size: Annotated[str | None, typer.Option(help="openai: what to ask for, 1024x1024.")] = None,
    strength: Annotated[
        float, typer.Option(min=0.01, max=1, help="diffusers: how much a variation changes.")
    ] = 0.45,
    steps: Annotated[int | None, typer.Option(min=1, help="diffusers: denoising steps.")] = None,
    seed: Annotated[int, typer.Option(help="Decides what is drawn.")] = 0,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Say what is missing and would be done; do nothing.")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Send requests without asking.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Compose a set from photos, variations of photos, and pictures from prompts.

    Rendered pictures stand in for what is not there, and are called so. A composition that was
    stopped, by Ctrl-C too, goes on where it was; no picture is asked for twice. Pictures that you
    move into the folder `rejected` of the set are replaced by others. Exit code 1: a picture was
    refused.
    """
    from tpvqa.errors import PhotosError, PictureSetError
    from tpvqa_household.images.manifest import load_pictures
    from tpvqa_household.images.recipe import jobs
    from tpvqa_household.images.shipped_tasks import all_reachable
    from tpvqa_household.images.sources import compose as making
    from tpvqa_household.images.sources.choice import Options, generator
    from tpvqa_household.images.sources.labels import labels
    from tpvqa_household.images.sources.photos import read_photos, stock
    from tpvqa_household.images.sources.plan import Ingredients, plan
    from tpvqa_household.images.sources.prompts import read_prompts
    from tpvqa_household.images.sources.rerender import jobs_by_visible
    from tpvqa_household.images.sources.shares import Shares

    split = Shares.parse(shares)
    if photo_labels is not None and photos is None:
        raise PhotosError("--photo-labels needs --photos, the folder that its files lie in")
    every = all_reachable()
    chosen = [one for one in every if task is None or one.task in task]
    wanted_labels = labels(chosen)
    # A photo of a task that is not chosen is no fault of the photo.
    own = [] if photos is None else read_photos(photos, labels(every), table=photo_labels)
    own = [photo for photo in own if photo.label in wanted_labels]
    options = Options(base_url, price, per_minute, size, strength, steps)
    by_visible = jobs_by_visible(jobs(every))
    varier = generator(variations, options, by_visible, from_prompts=False)
    # One generator for both keeps one distance between requests, and one model in memory.
    prompted = (
        varier
        if prompts == variations != "rerender"
        else generator(prompts, options, by_visible, from_prompts=True)
    )
    generators = list({id(one): one for one in (varier, prompted) if one is not None}.values())
    try:
        ingredients = Ingredients(
            wanted_labels,
            own,
            load_pictures(),
            read_prompts(wanted_labels, prompt_files),
            varier,
            prompted,
        )
        wanted = plan(
            ingredients,
            shares=split,
            count=count,
            seed=seed,
            rejected=making.rejected(out),
            tasks=chosen if fill else (),
        )
        shelves = stock(own, wanted_labels, wanted=split.of(count)[0])
        pending = making.pending(wanted, out)
        before: dict[str, Any] = {
            "folder": str(out),
            "photos": [_shelf(shelf) for shelf in shelves],
            "pictures": len(wanted),
            "origins": dict(Counter(one.kind for one in wanted)),
            "pending": len(pending),
            "requests": _requests(pending),
        }
        if not as_json:
            _say_before(shelves, wanted, pending)
        if dry_run:
            if as_json:
                typer.echo(json.dumps(before, indent=2))
            return
        if any(entry["pictures"] for entry in before["requests"]) and not yes:
            if as_json or not sys.stdin.isatty():
                raise PictureSetError(
                    f"{_say_requests(pending)}. Nobody can be asked here whether to send them: "
                    "write --yes, or --dry-run to see more"
                )
            if not typer.confirm("Send them?"):
                raise typer.Exit(1)
        composed = _with_progress(wanted, out, every, shown=not as_json)
    finally:
        for made in generators:
            made.close()
    after = _after(composed, sum(one.requests for one in generators))
    if as_json:
        typer.echo(json.dumps({**before, **after}, indent=2))
    else:
        _say_after(out, after)
    if composed.refused:
        raise typer.Exit(1)


def _shelf(shelf: "Shelf") -> dict[str, Any]:
    return {
        **shelf.label.shows.model_dump(),
        "photos": shelf.photos,
        "wanted": shelf.wanted,
        "missing": shelf.missing,
    }


def _requests(pending: Sequence["Wanted"]) -> list[dict[str, Any]]:
    """What servers would be asked for, by generator."""
    found: dict[tuple[str, float | None], int] = Counter()
    for one in pending:
        if one.generator is not None and one.generator.remote:
            found[one.generator.name, one.generator.price] += 1
    return [
        {"generator": name, "pictures": n, "dollars": None if price is None else price * n}
        for (name, price), n in found.items()
    ]


def _say_requests(pending: Sequence["Wanted"]) -> str:
    parts = []
    for entry in _requests(pending):
        cost = "cost not known, --price says it"
        if entry["dollars"] is not None:
            cost = f"about ${entry['dollars']:.2f}"
        parts.append(f"{entry['pictures']} requests to {entry['generator']} ({cost})")
    return " and ".join(parts)


def _say_before(
    shelves: Sequence["Shelf"], wanted: Sequence["Wanted"], pending: Sequence["Wanted"]
) -> None:
    lines: dict[object, Counter[str]] = {}
    for one in wanted:
        if one.label is not None:
            lines.setdefault(one.label.shows, Counter())[one.kind] += 1
    typer.echo("photos that there are, and what each outcome is composed of:")
    for shelf in shelves:
        shows = shelf.label.shows
        parts = ", ".join(f"{n} {kind}" for kind, n in lines.get(shows, Counter()).items())
        lack = f"{shelf.missing} missing" if shelf.missing else ""
        typer.echo(
            f"  {shows.task:16} {shows.action:27} {shows.outcome:8} {shelf.photos:3} photos "
            f"{lack:11} {parts}"
        )
    others = sum(one.label is None for one in wanted)
    if others:
        typer.echo(f"  and {others} rendered pictures of what else the tasks can come to")
    typer.echo(f"{len(wanted)} pictures, {len(wanted) - len(pending)} of them are there")
    if said := _say_requests(pending):
        typer.echo(said)


def _with_progress(
    wanted: Sequence["Wanted"], out: Path, tasks: Sequence[Any], *, shown: bool
) -> "Composed":
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    from tpvqa_household.images.sources.compose import compose as make

    columns = ("pictures", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, disable=not shown) as bar:
        row = bar.add_task("", total=len(wanted))
        return make(
            wanted,
            out,
            tasks,
            progress=lambda done, total: bar.update(row, completed=done, total=total),
        )


def _after(composed: "Composed", sent: int) -> dict[str, Any]:
    pictures = () if composed.manifest is None else composed.manifest.pictures
    labelled = [picture for picture in pictures if picture.origin.got_for is not None]
    kinds = Counter(picture.origin.kind for picture in labelled)
    costs = [picture.origin.cost for picture in pictures if picture.origin.cost]
    return {
        "made": composed.made,
        "of_actions": dict(kinds),
        "percent": {kind: round(100 * n / len(labelled), 1) for kind, n in kinds.items()},
        "requests_sent": sent,
        "asked_for": composed.asked,
        "dollars_of_all": sum(costs),
        "refused": composed.refused,
    }


def _say_after(out: Path, after: dict[str, Any]) -> None:
    parts = ", ".join(
        f"{n} {kind} ({after['percent'][kind]:g}%)" for kind, n in after["of_actions"].items()
    )
    typer.echo(f"{out}: {after['made']} pictures made now. Of the actions: {parts}")
    if after["requests_sent"]:
        typer.echo(f"{after['requests_sent']} requests were sent for {after['asked_for']} pictures")
    if after["dollars_of_all"]:
        typer.echo(f"all pictures of the set cost ${after['dollars_of_all']:.2f}")
    for line in after["refused"]:
        typer.echo(f"  {line}", err=True)
    if after["refused"]:
        typer.echo(
            f"{len(after['refused'])} pictures were refused. Change their prompts "
            "(--prompt-files) or photos, and give the same command again",
            err=True,
        )
    typer.echo(f"look through it: tpvqa dataset show --pictures {out}")
