"""What files, logs and servers say, made fit for a terminal: the one place through which it goes.

A terminal obeys what it is sent: control sequences move the cursor, change the title, paste. Text
that others wrote is shown as it is spelled instead, and in bounds.
"""

import sys
from contextlib import suppress
from typing import TYPE_CHECKING

from tpvqa.spelling import LONGEST, plain

if TYPE_CHECKING:
    from rich.text import Text

LONGEST_ERROR = 20_000
_STANDING_IN = {ord("["): "\ue000", ord("\\"): "\ue001"}
"""Of a private use, which `plain` lets nobody else use."""
_STOOD_FOR = {ord(there): chr(here) for here, there in _STANDING_IN.items()}


def marked(text: object, *, longest: int = LONGEST) -> str:
    """As `plain`, for markup that `rendered` takes: there it is text and nothing else."""
    return plain(text, longest=longest).translate(_STANDING_IN)


def rendered(markup: str) -> "Text":
    """Markup as rich prints it, with what `marked` hid from it."""
    from rich.text import Text

    text = Text.from_markup(markup, emoji=False)
    text.plain = text.plain.translate(_STOOD_FOR)  # as long as before, so styles stay in place
    return text


def cell(text: object) -> "Text":
    """As `plain`, for a table of rich, which would read a string as markup."""
    from rich.text import Text

    return Text(plain(text))


def tell(text: object, *, error: bool = False) -> None:
    """Print a line that holds what somebody else wrote.

    Args:
        text: The line.
        error: Whether it goes to standard error.
    """
    said = plain(text, longest=LONGEST_ERROR, lines=True)
    if not error:
        print(said)
    elif sys.stderr is not None:  # of None, `print` would make standard output
        with suppress(OSError):  # a note that nobody takes stops nothing
            print(said, file=sys.stderr)
