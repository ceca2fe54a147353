"""`tpvqa`: the commands and how their errors reach the user."""

import sys
from typing import Annotated, Any

import typer

from tpvqa.cli import bench, calibrate, plan, questions, run
from tpvqa.cli.plugged import PluggedGroup
from tpvqa.errors import TpvqaError


class _Interrupted(Exception):  # noqa: N818 — Ctrl-C, not an error
    """Ctrl-C, in a form that Typer leaves alone: it would end the process without a word."""


class _Commands(PluggedGroup):
    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise _Interrupted from None


app = typer.Typer(
    name="tpvqa",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    cls=_Commands,
)


def _version(wanted: bool) -> None:
    if wanted:
        from tpvqa import __version__

        typer.echo(f"tpvqa {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    *,
    version: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Print the version."),
    ] = False,
) -> None:
    """Visually grounded task planning: plan, look, act, check, repeat, replan."""


plan.register(app)
questions.register(app)
run.register(app)
calibrate.register(app)
bench.register(app)


def main() -> None:
    """Run the command line.

    A `TpvqaError` becomes one clear message and exit code 2; Ctrl-C becomes "interrupted" and
    exit code 130.
    """
    try:
        app()
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except (_Interrupted, KeyboardInterrupt):
        print("interrupted", file=sys.stderr)
        sys.exit(130)
