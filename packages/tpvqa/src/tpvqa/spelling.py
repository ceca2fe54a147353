"""What others wrote, shown as it is spelled: nothing that a terminal, page or spreadsheet obeys.

A terminal obeys control sequences, which move its cursor and paste; a page turns letters round
where it is told to; a spreadsheet computes what begins as a formula does.
"""

import unicodedata
from collections.abc import Mapping

LONGEST = 2_000
"""Characters of one text that are shown."""
_INVISIBLE = frozenset({"Cc", "Cf", "Cs", "Co", "Zl", "Zp"})
"""Control and format characters (bidirectional ones among them), line and paragraph separators."""
_JOINERS = frozenset("\u200c\u200d")
"""Which words of some languages need."""
_FORMULA = ("=", "+", "-", "@")
"""How a formula begins, in one spreadsheet or another."""


def spelled(text: str, *, lines: bool = False) -> str:
    """Text whose invisible characters are shown as escapes.

    Args:
        text: What somebody else wrote.
        lines: Whether line ends stay.

    >>> spelled("Is it \\x1b[31mred?")
    'Is it \\\\x1b[31mred?'
    """
    if text.isprintable():
        return text
    return "".join(each if lines and each == "\n" else _visible(each) for each in text)


def plain(text: object, *, longest: int = LONGEST, lines: bool = False) -> str:
    """As `spelled`, for a line of a terminal, within bounds.

    Args:
        text: What somebody else wrote.
        longest: Characters at most.
        lines: Whether line ends stay; lines after the first are indented then, so that none can
            pass for one of tpvqa's own.
    """
    said = str(text)
    cut = len(said) > longest
    said = spelled(said[:longest], lines=lines).replace("\n", "\n  ")
    return f"{said}…" if cut else said


def plain_row(row: Mapping[str, object]) -> dict[str, object]:
    """A row of a table that is written as text: its texts as `spelled`, none cut, and before what
    would begin a formula the apostrophe that spreadsheets take for the begin of a text.

    >>> plain_row({"answer": "=1+1", "p": -0.5})
    {'answer': "'=1+1", 'p': -0.5}
    """
    return {
        name: _no_formula(spelled(value)) if isinstance(value, str) else value
        for name, value in row.items()
    }


def _no_formula(text: str) -> str:
    return f"'{text}" if text.lstrip().startswith(_FORMULA) else text


def _visible(character: str) -> str:
    if unicodedata.category(character) not in _INVISIBLE or character in _JOINERS:
        return character
    return character.encode("unicode_escape").decode()
