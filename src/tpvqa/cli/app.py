"""`tpvqa`: the commands and how their errors reach the user."""

import sys

import typer

from tpvqa.cli import dataset, plan, questions, run
from tpvqa.errors import TpvqaError

app = typer.Typer(
    name="tpvqa",
    help="Visually grounded task planning: plan, look, act, check, repeat, replan.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)
plan.register(app)
questions.register(app)
run.register(app)
dataset.register(app)


def main() -> None:
    """Run the command line; a `TpvqaError` becomes one clear message and exit code 2."""
    try:
        app()
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        sys.exit(130)
