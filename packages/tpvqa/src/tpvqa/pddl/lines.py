"""The lines of a text, as editors count them."""

import re

_END = re.compile(r"\r\n|\r|\n")


def lines_of(text: str) -> list[str]:
    """The lines of a text.

    `str.splitlines` ends a line also at form feeds and other marks that stand in comments.
    """
    return _END.split(text)
