"""A decision's reason in one line of a terminal: its numbers first, the rest where it fits."""

import re

_LEFT_OUT = (
    r", which [^;]* needs(?=;|$)",
    r"(?:, (?:which can be|as what comes before it is) done(?: already)?(?:: [^;]*)?"
    r"|(?<=\)): [^;]*)(?=;|$)",
    r"(?: and)? after (?:an?|two|three|\d+) [^;]*?(?=;|$)",
    r" \(not worth asking\)(?=;|$)",
)
"""What rests on a fact, why an action can be done, what was answered about the fact, and why
nothing was: told elsewhere in the same lines, or of little weight."""
_ENDS = re.compile(r"\bthe goal holds with\b")
"""What a trial is ended for: all else explains it."""
_DOES = re.compile(r"^(?:on|back) to | again$")
"""What is done next."""
MORE = "…"


def brief(reason: str, room: int) -> str:
    """A reason in so many columns; in more only where what a trial is ended for takes them.

    >>> brief("cup in hand 0.10 → 0.02 after a no, which drink (step 4) needs; back to step 2", 50)
    'cup in hand 0.10 → 0.02 after a no; back to step 2'
    >>> brief("cup in hand 0.10 → 0.02 after a no, which drink (step 4) needs; back to step 2", 30)
    '…; back to step 2'
    >>> brief("cup in hand 0.02; tea hot 0.10; no plan is left, and the goal holds with 0.01", 67)
    'cup in hand 0.02; …; no plan is left, and the goal holds with 0.01'

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
    parts = reason.split("; ")
    end = next((at for at, part in enumerate(parts) if _ENDS.search(part)), None)
    if end is not None:
        return _ending(parts[:end], parts[end:], room)
    does = next((at for at, part in enumerate(parts) if _DOES.search(part)), None)
    if does is not None:
        return _doing(parts[:does], parts[does:], room)
    said, *rest = parts
    for part in rest:
        if len(f"{said}; {part}; {MORE}") > room:
            return _cut(f"{said}; {MORE}", room)
        said = f"{said}; {part}"
    return _cut(said, room)


def _ending(before: list[str], ending: list[str], room: int) -> str:
    """What a trial is ended for, behind what speaks for it: the first of that, and what fits; what
    comes behind it follows where it fits, too."""
    end, *behind = ending
    said = _fitting(before[:1], before[1:], [end, *_more(behind)], room)
    return "; ".join(_fitting([*said, end], behind, [], room))


def _doing(before: list[str], doing: list[str], room: int) -> str:
    """What is done next, behind what of its reasons fits."""
    does, *behind = doing
    said = _fitting([], before, [does, *_more(behind)], room)
    return _cut("; ".join(_fitting([*said, does], behind, [], room)), room)


def _fitting(said: list[str], parts: list[str], after: list[str], room: int) -> list[str]:
    """What is said already with as many more parts as leave room for what comes after."""
    for at, part in enumerate(parts, 1):
        if len("; ".join([*said, part, *_more(parts[at:]), *after])) > room:
            return [*said, MORE]
        said = [*said, part]
    return said


def _more(left: list[str]) -> list[str]:
    return [MORE] if left else []


def _cut(said: str, room: int) -> str:
    """At a space, where even the first part is too long."""
    if len(said) <= room:
        return said
    return said[: room - len(MORE)].rpartition(" ")[0].rstrip(" ;,") + f" {MORE}"
