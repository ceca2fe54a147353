"""PDDL text, as far as it is changed for planners."""

import re

_COMMENT = re.compile(r";[^\n\r]*")


def uncommented(text: str) -> str:
    """A text without its comments."""
    return _COMMENT.sub("", text)


def end_of(text: str, begin: int) -> int:
    """Where the bracket that begins somewhere ends, in a text without comments."""
    depth = 0
    for place in range(begin, len(text)):
        depth += (text[place] == "(") - (text[place] == ")")
        if not depth:
            return place + 1
    return len(text)
