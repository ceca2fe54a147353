"""What all commands of `tpvqa bench` have in common: their bar, Ctrl-C, their end."""

import json
import sys
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.bench.report import Results
    from tpvqa.cli.progress import CountBar

EXIT = (
    "Exit codes: 0 all episodes ran, 1 some failed with an error, 2 bad input, 6 something could "
    "not be written, 130 interrupted."
)


@contextmanager
def bench_bar(out: Path, what: str = "episodes") -> Iterator["CountBar"]:
    """A bar while a bench runs; Ctrl-C leaves what is finished, and says so.

    Args:
        out: The bench's folder.
        what: What is counted.
    """
    from tpvqa.cli.progress import CountBar

    with CountBar(what) as bar:
        try:
            yield bar
        except KeyboardInterrupt:
            print(
                f"interrupted; what is finished lies in {out}. The same command goes on there.",
                file=sys.stderr,
            )
            raise typer.Exit(130) from None


def finish(results: "Results", out: Path, *, as_json: bool) -> None:
    """Print what was found, and end with 1 where an episode failed with an error."""
    from tpvqa.bench.summary import plain_rows
    from tpvqa.cli.bench_tables import print_results

    if as_json:
        print(json.dumps(plain_rows(results.summaries, results.reference), indent=1))
    else:
        print_results(results)
        tell(f"tables, figures and report: {out}/report.html")
    if results.beside:
        tell(
            f"note: {results.beside:,} of the finished episodes in {out} are in no table now: they "
            "are of other tasks, monitors, VLMs, worlds or conditions, or beyond --episodes. Name "
            "them all in one command: what is finished runs no second time",
            error=True,
        )
    if results.errors:
        first = next(row for rows in results.rows.values() for row in rows if row.error)
        tell(
            f"note: {results.errors} episodes failed with an error, the first (episode "
            f"{first.episode} of {first.cell}): {first.error.strip()}",
            error=True,
        )
        raise typer.Exit(1)


def listed(text: str) -> tuple[str, ...]:
    """What a text with commas names, each once."""
    return tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))


def listed_of(text: str, known: Collection[str], what: str) -> tuple[str, ...]:
    """The same of names that are known.

    Raises:
        UnknownNameError: One is not; `what` it would be is said.
    """
    from tpvqa.errors import UnknownNameError

    for name in listed(text):
        if name not in known:
            raise UnknownNameError(what, name, known)
    return listed(text)
