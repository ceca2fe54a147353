"""`tpvqa`: the commands and how their errors reach the user."""

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from itertools import pairwise
from typing import Annotated, Any, NoReturn

import typer

from tpvqa.cli import (
    bench,
    cache,
    calibrate,
    check,
    label,
    plan,
    questions,
    report,
    risk,
    run,
    serve_vlm,
    train,
    vlm,
)
from tpvqa.cli.plugged import PluggedGroup
from tpvqa.cli.saying import tell
from tpvqa.cli.streams import (
    all_printed,
    check_output,
    end_notes,
    give_up,
    print_anything,
    take_no_size_of_nothing,
)
from tpvqa.errors import TpvqaError, WriteError, cut

NOT_WRITTEN = 6
"""Exit code: the disk is full, say. What was written before is whole."""


_FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS, errno.EIO, errno.EPIPE)


class _Interrupted(Exception):  # noqa: N818 — Ctrl-C, not an error
    """Ctrl-C, in a form that Typer leaves alone: it would end the process without a word."""


class _NobodyReads(Exception):  # noqa: N818
    """A pipe whose reader is gone, in such a form, too: Typer would say "not reached", code 1."""


class _Commands(PluggedGroup):
    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt:
            raise _Interrupted from None
        except BrokenPipeError as error:
            raise _NobodyReads from error


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
check.register(app)
run.register(app)
report.register(app)
label.register(app)
calibrate.register(app)
risk.register(app)
serve_vlm.register(app)
train.register(app)
bench.register(app)
cache.register(app)
vlm.register(app)


def _check_names(arguments: Sequence[str]) -> None:
    """See that all that was typed, and where, is text: what is not could not be kept in a log. And
    that nothing is written into this folder because a variable of a script was empty.

    Raises:
        TpvqaError: It is not.
    """
    try:
        here = os.getcwd()
    except OSError:
        raise TpvqaError("The folder that you are in is gone. Go to another.") from None
    for before, argument in pairwise(("", *arguments)):
        if argument == "--out=" or (before == "--out" and not argument):
            raise TpvqaError(
                "--out is empty, and would write here. Name a folder, or a file where one is "
                "written; this folder is named by a full stop."
            )
    for what, name in (("folder that you are in", here), *(("argument", a) for a in arguments)):
        try:
            name.encode()
        except UnicodeEncodeError:
            said = name.encode(errors="surrogateescape").decode(errors="backslashreplace")
            raise TpvqaError(
                f"The {what}, '{cut(said)}', is not UTF-8 text. Rename the file or the folder."
            ) from None


def main() -> None:
    """Run the command line.

    A `TpvqaError` becomes one clear message and exit code 2, or 6 where something could
    not be written; Ctrl-C, or SIGTERM, becomes "interrupted" and exit code 130.
    """
    print_anything()
    take_no_size_of_nothing()
    try:
        _main()
    finally:
        end_notes()


def _main() -> None:
    try:
        try:
            check_output(sys.argv[1:])
            _check_names(sys.argv[1:])
            app()
        except SystemExit:  # how a command ends
            all_printed()
            raise
        finally:
            with suppress(BrokenPipeError):
                all_printed()
    except (OSError, _NobodyReads) as error:
        _not_printed(error if isinstance(error, OSError) else BrokenPipeError(errno.EPIPE, ""))
    except TpvqaError as error:
        tell(f"error: {error}", error=True)
        sys.exit(NOT_WRITTEN if isinstance(error, WriteError) else 2)
    except (_Interrupted, KeyboardInterrupt):
        tell("interrupted", error=True)
        sys.exit(130)


def _not_printed(error: OSError) -> NoReturn:
    if error.errno == errno.ENAMETOOLONG:
        tell(f"error: the path '{cut(error.filename)}' is too long", error=True)
        sys.exit(2)
    if error.errno not in _FULL:
        raise error
    give_up(sys.stdout)
    why = os.strerror(error.errno)
    tell(f"error: standard output or a file cannot be written ({why})", error=True)
    sys.exit(NOT_WRITTEN)
