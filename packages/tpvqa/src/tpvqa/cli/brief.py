"""A decision's reason in one line of a terminal: its numbers first, the rest where it fits."""

import re

_LEFT_OUT = (r", which [^;]* needs(?=;|$)", r" after (?:an?|two|three|\d+) [^;]*?(?=;|$)")
"""What rests on a fact, and what was answered about it: told elsewhere in the same lines."""
MORE = "…"


def brief(reason: str, room: int) -> str:
    """A reason in so many columns.

    >>> brief("cup in hand 0.10 → 0.02 after a no, which drink (step 4) needs; back to step 2", 50)
    'cup in hand 0.10 → 0.02 after a no; back to step 2'
    >>> brief("cup in hand 0.10 → 0.02 after a no, which drink (step 4) needs; back to step 2", 30)
    'cup in hand 0.10 → 0.02; …'

    Args:
        reason: As it is logged: parts with semicolons between them, those that decided it first.
        room: Columns.
    """
    for pattern in _LEFT_OUT:
        if len(reason) <= room:
            return reason
        reason = re.sub(pattern, "", reason)
    if len(reason) <= room:
        return reason
    said, *rest = reason.split("; ")
    for part in rest:
        if len(f"{said}; {part}; {MORE}") > room:
            return _cut(f"{said}; {MORE}", room)
        said = f"{said}; {part}"
    return _cut(said, room)


def _cut(said: str, room: int) -> str:
    """At a space, where even the first part is too long."""
    if len(said) <= room:
        return said
    return said[: room - len(MORE)].rpartition(" ")[0].rstrip(" ;,") + f" {MORE}"
