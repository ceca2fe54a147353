"""`tpvqa cache`: what a file of recorded answers holds, and taking from it."""

import csv
import json
import re
import sys
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, TextIO

import typer

from tpvqa.cli.outputs import see_unread
from tpvqa.cli.saying import cell, tell
from tpvqa.spelling import plain_row

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from tpvqa.vlm.kept.upkeep import Kept

_EXIT = "Exit codes: 0 done, 2 bad input, 6 could not be written, 130 interrupted."
_DAY = 86_400
_SECONDS = {"h": 3600, "d": _DAY, "w": 7 * _DAY, "m": 30 * _DAY, "y": 365 * _DAY}
_BYTES = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9}
_FORMS: "Mapping[str, Literal['jsonl', 'csv']]" = {"": "jsonl", ".csv": "csv", ".jsonl": "jsonl"}
File = Annotated[Path, typer.Argument(help="File of recorded answers.")]

cache_app = typer.Typer(
    help="Recorded answers: what a file of --cache or --record holds.", no_args_is_help=True
)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    for command in (stats, prune, export):
        cache_app.command(epilog=_EXIT)(command)
    app.add_typer(cache_app, name="cache")


@cache_app.callback()
def _cache() -> None:
    """Recorded answers: what a file of --cache or --record holds."""


def stats(
    file: File,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Count the answers by VLM, and by what is asked about."""
    from tpvqa.vlm.kept.upkeep import stats as counted

    found = counted(file)
    if as_json:
        print(json.dumps(asdict(found), indent=1, allow_nan=False))
        return
    tell(f"{file}: {found.answers:,} answers, {_size(found.bytes)}, schema {found.schema}")
    _print("VLM", found.vlms)
    _print("about", found.kinds)


def _print(title: str, groups: "Sequence[Kept]") -> None:
    from datetime import UTC, datetime

    from rich.table import Table

    from tpvqa.cli.consoles import ResultConsole

    table = Table(box=None)
    numbered = title == "VLM"
    for name in ("number", title, "parameters") if numbered else (title,):
        table.add_column(name)
    for name in ("answers", "questions", "pictures", "yes", "abstained", "s each", "last"):
        table.add_column(name, justify="right", no_wrap=True)
    for each in groups:
        told = json.loads(each.parameters) if each.parameters else {}
        words = ", ".join(f"{name} {value}" for name, value in told.items())
        table.add_row(
            *((str(each.number), cell(each.name), cell(words)) if numbered else (cell(each.name),)),
            f"{each.answers:,}",
            f"{each.asked:,}",
            f"{each.pictures:,}",
            "–" if each.yes is None else f"{each.yes:.2f}",
            f"{each.abstained:.2f}",
            f"{each.seconds / each.answers:.3f}",
            datetime.fromtimestamp(each.last, UTC).strftime("%Y-%m-%d"),
        )
    console = ResultConsole()
    (console if console.is_terminal else ResultConsole(width=120)).print(table)


def prune(
    file: File,
    *,
    model: Annotated[
        str | None, typer.Option(help="A VLM's specification, or its number (see `stats`).")
    ] = None,
    older_than: Annotated[
        str | None, typer.Option(help="Age: 12h, 30d, 8w, 6m (of 30 days) or 1y.")
    ] = None,
    max_size: Annotated[
        str | None, typer.Option(help="Then also the oldest, until the file has 500k, 20M or 1G.")
    ] = None,
    dry_run: Annotated[
        bool, typer.Option("--dry-run", help="Only say how many there are.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
) -> None:
    """Take answers away: of one VLM, old ones, or the oldest beyond a size."""
    from tpvqa.errors import TpvqaError
    from tpvqa.vlm.kept.upkeep import prune as pruned

    if model is None and older_than is None and max_size is None:
        raise TpvqaError("Say what is to go: --model, --older-than or --max-size.")
    if dry_run and max_size is not None:
        raise TpvqaError("--dry-run cannot tell what --max-size would take; leave one out.")
    found = pruned(
        file,
        vlm=model,
        older_than=None if older_than is None else _measure(older_than, "--older-than", _SECONDS),
        most=None if max_size is None else int(_measure(max_size, "--max-size", _BYTES)),
        dry=dry_run,
    )
    if as_json:
        print(json.dumps({**asdict(found), "dry_run": dry_run}))
        return
    would = "would be" if dry_run else "were"
    size = "" if dry_run else f"; {_size(found.before)} before, {_size(found.after)} now"
    tell(f"{found.answers:,} answers {would} taken away, {found.left:,} are left{size}")


def _measure(text: str, option: str, units: "dict[str, int]") -> float:
    from tpvqa.errors import TpvqaError

    match = re.fullmatch(r"([0-9]{1,9}(?:\.[0-9]{1,6})?)([a-z]?)b?", text.strip().lower())
    if match is None or match[2] not in units:
        wanted = ", ".join(f"20{unit}" for unit in units)
        raise TpvqaError(f"{option} {text!r:.40} is not understood; write for example {wanted}")
    return float(match[1]) * units[match[2]]


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1e6 else f"{count / 1e3:.0f} kB"


def export(
    file: File,
    *,
    out: Annotated[Path | None, typer.Option(help="File to write; else standard output.")] = None,
    form: Annotated[
        Literal["jsonl", "csv"] | None,
        typer.Option("--format", help="Default: by the ending of --out, else jsonl."),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Write over the file of --out.")] = False,
) -> None:
    """Write all answers as JSON lines or as CSV."""
    from io import StringIO

    from tpvqa.errors import TpvqaError
    from tpvqa.files import write_whole

    if form is None:
        form = _FORMS["" if out is None else _ending(out)]
    if out is not None:
        see_unread(out, "--out", [file])
    if out is not None and out.exists() and not force:
        raise TpvqaError(f"{out} is there already. Name another file, or write over it: --force")
    if out is None:
        _write(file, form, sys.stdout)
        return
    text = StringIO(newline="")
    count = _write(file, form, text)
    write_whole(out, text.getvalue().encode(), remedy="Name another file with --out")
    tell(f"wrote {count:,} answers to {out}")


def _ending(out: Path) -> str:
    from tpvqa.errors import TpvqaError, shown

    ending = out.suffix.lower()
    if ending not in filter(None, _FORMS):
        raise TpvqaError(
            f"{out}: the ending {shown(ending)} says no format. Write .csv or .jsonl, or name the "
            "format by --format"
        )
    return ending


def _write(file: Path, form: str, stream: TextIO) -> int:
    from tpvqa.vlm.kept.upkeep import COLUMNS, exported

    count = 0
    writer = csv.DictWriter(stream, COLUMNS) if form == "csv" else None
    if writer is not None:
        writer.writeheader()
    for entry in exported(file):
        count += 1
        if writer is not None:
            writer.writerow(plain_row(entry))
        else:
            told = {**entry, "parameters": json.loads(entry["parameters"])}
            stream.write(json.dumps(told, allow_nan=False) + "\n")
    return count
