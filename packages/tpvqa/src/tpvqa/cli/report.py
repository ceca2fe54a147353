"""`tpvqa report`."""

from pathlib import Path
from typing import Annotated

import typer

from tpvqa.cli.saying import tell


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command()(report)


def report(
    episode: Annotated[Path, typer.Argument(help="Folder of an episode.")],
    *,
    out: Annotated[
        Path | None, typer.Option(help="File to write; by default report.html in the episode.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Write over a file that is there and is no report.")
    ] = False,
) -> None:
    """Write one self-contained HTML page about an episode."""
    from tpvqa.episodes.report import write_report

    tell(write_report(episode, out, force=force))
