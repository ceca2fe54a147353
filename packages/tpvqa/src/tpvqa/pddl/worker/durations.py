"""How long actions last: the durations of a domain, and what its problem says of time."""

from collections.abc import Collection
from typing import Any

from tpvqa.pddl.arithmetic import is_number
from tpvqa.pddl.worker.blocks import said, sections
from tpvqa.pddl.worker.functions import Functions
from tpvqa.pddl.worker.lisp import Block, line_of
from tpvqa.pddl.worker.reading_error import ReadingError

_BOUNDS = {"=": (0, 1), ">=": (0,), "<=": (1,)}


def duration_of(
    name: str, written: Block, functions: Functions, known: Collection[str]
) -> tuple[Any, Any]:
    """The least and the greatest duration of an action, as `Functions.expression` gives them.

    Args:
        name: The action.
        written: What stands after `:duration`.
        functions: The functions that it may speak of.
        known: The variables and objects that it may speak of.

    Raises:
        ReadingError: It says something else.
    """
    bounds: list[Any] = [None, None]
    for part in written[1:] if written[:1] == ["and"] else [written]:
        if isinstance(part, Block) and part[:2] == ["at", "start"] and len(part) == 3:
            part = part[2]
        given = part if isinstance(part, Block) and len(part) == 3 else Block(written.line)
        if given[1:2] != ["?duration"] or str(given[0]) not in _BOUNDS:
            raise ReadingError(
                f"{said(part)} does not say how long {name} lasts; expected "
                "(= ?duration …), (>= ?duration …) or (<= ?duration …)",
                "domain",
                line_of(part),
            )
        for which in _BOUNDS[str(given[0])]:
            bounds[which] = functions.expression(given[2], known, "domain")
    if None in bounds:
        side = "least" if bounds[0] is None else "most"
        raise ReadingError(
            f"{name} says not how long it lasts at {side}; expected (= ?duration …), or "
            "both (>= ?duration …) and (<= ?duration …)",
            "domain",
            written.line,
        )
    return bounds[0], bounds[1]


def check_facts(problem: Block) -> None:
    """See that no fact of the initial state comes later.

    Raises:
        ReadingError: One does.
    """
    for section in sections(problem, ":init"):
        for fact in section[1:]:
            if isinstance(fact, Block) and _is_timed(fact):
                raise ReadingError(
                    f"{said(fact)} is a timed initial literal, which is not known; bring it about "
                    "by a durative action of that duration",
                    "problem",
                    fact.line,
                )


def _is_timed(fact: Block) -> bool:
    """Whether it is `(at NUMBER LITERAL)`."""
    if fact[:1] != ["at"] or len(fact) != 3 or not isinstance(fact[2], Block):
        return False
    return isinstance(fact[1], str) and is_number(fact[1])


def quickest(problem: Block) -> bool:
    """Whether the quickest plan is asked for; that is taken out."""
    for section in sections(problem, ":metric"):
        if section[1:] in (["minimize", ["total-time"]], ["minimize", "total-time"]):
            problem[:] = [part for part in problem if part is not section]
            return True
    return False
