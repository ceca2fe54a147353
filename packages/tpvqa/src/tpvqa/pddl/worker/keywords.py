"""Keywords that were mistyped: what may have been meant."""

import re
from collections.abc import Iterable

from tpvqa.errors import shown, suggestion

_OF_A_FILE = re.compile(
    r"Expected a non-empty block starting with any of the following words: (.*)"
)
_OF_AN_ACTION = re.compile(r"\w+ tag is expected to be '(:\w+)'")
_ACTIONS = (":parameters", ":precondition", ":effect")


def mistyped(message: str, item: object) -> str | None:
    """What to say of a keyword that the translator does not know.

    Args:
        message: What it says.
        item: What it said that of.

    Returns:
        Something else than the message; None where that is of no keyword.
    """
    if (of_file := _OF_A_FILE.match(message)) and isinstance(item, list) and item:
        return _said(item[0], of_file[1].split(", "))
    if _OF_AN_ACTION.match(message) and isinstance(item, str) and item.startswith(":"):
        return _said(item, _ACTIONS) if item not in _ACTIONS else None
    return None


def _said(word: object, known: Iterable[str]) -> str | None:
    if not isinstance(word, str):
        return None
    return f"{shown(word)} is none of {', '.join(known)}{suggestion(word, known)}".rstrip(".")
