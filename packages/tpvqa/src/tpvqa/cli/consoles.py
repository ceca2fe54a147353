"""What prints colours, tables and trials. Rich's own console ends the program with code 1, which
here says that a goal was not reached, where the reader of a pipe is gone."""

import errno
import sys
from typing import NoReturn

from rich.console import Console

from tpvqa.cli.streams import give_up


class ResultConsole(Console):
    """A console for what was asked for.

    Raises:
        BrokenPipeError: Nobody reads it any more.
    """

    def on_broken_pipe(self) -> NoReturn:
        raise BrokenPipeError(errno.EPIPE, "nobody reads on")


class PatientConsole(Console):
    """A console for what goes on without a reader, in silence."""

    def on_broken_pipe(self) -> None:
        self.quiet = True
        give_up(sys.stderr if self.stderr else sys.stdout)
