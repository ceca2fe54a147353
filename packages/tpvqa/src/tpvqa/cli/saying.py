"""What files, logs and servers say, made fit for a terminal: the one place through which it goes.

A terminal obeys what it is sent: control sequences move the cursor, change the title, paste. Text
that others wrote is shown as it is spelled instead, and in bounds.
"""

import sys
import unicodedata
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rich.text import Text

LONGEST = 2_000
"""Characters of one text that are shown."""
LONGEST_ERROR = 20_000
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Co", "Zl", "Zp"})
"""Control and format characters (bidirectional ones among them), line and paragraph separators."""
_STANDING_IN = {ord("["): "\ue000", ord("\\"): "\ue001"}
"""Of a private use, which `plain` lets nobody else use."""
_STOOD_FOR = {ord(there): chr(here) for here, there in _STANDING_IN.items()}
_JOINERS = frozenset("\u200c\u200d")
"""Which words of some languages need."""


def plain(text: object, *, longest: int = LONGEST, lines: bool = False) -> str:
    """Text without anything that a terminal would obey.

    Args:
        text: What somebody else wrote.
        longest: Characters at most.
        lines: Whether line ends stay; lines after the first are indented then, so that none can
            pass for one of tpvqa's own.

    >>> plain("Is it \\x1b[31mred?")
    'Is it \\\\x1b[31mred?'
    """
    said = str(text)
    cut = len(said) > longest
    said = said[:longest]
    if not said.isprintable():
        said = "".join(map(_visible, said)) if not lines else _lines(said)
    return f"{said}…" if cut else said


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


def plain_row(row: "Mapping[str, object]") -> dict[str, object]:
    """A row of a table that is written as text: its texts as `plain`, none cut."""
    return {
        name: plain(value, longest=len(value)) if isinstance(value, str) else value
        for name, value in row.items()
    }


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


def _lines(text: str) -> str:
    return "\n  ".join("".join(map(_visible, line)) for line in text.split("\n"))


def _visible(character: str) -> str:
    if unicodedata.category(character) not in _INVISIBLE or character in _JOINERS:
        return character
    return character.encode("unicode_escape").decode()
