"""Metrics of other things than the cost of a plan, which no planner here goes by."""

from collections.abc import Collection

from tpvqa.pddl.arithmetic import ARITHMETIC
from tpvqa.pddl.worker.blocks import blocks, said, sections
from tpvqa.pddl.worker.lisp import Block
from tpvqa.pddl.worker.reading_error import ReadingError


def passed_over(problem: Block, functions: Collection[str]) -> str | None:
    """Take a metric out that speaks of anything but the cost of a plan.

    Args:
        problem: The problem; changed.
        functions: The names of the domain's functions.

    Returns:
        The metric as it is written; None where there is none, or one that is gone by.

    Raises:
        ReadingError: It is no metric.
    """
    for section in sections(problem, ":metric"):
        inner = [word for block in blocks(section) for word in block]
        if "total-cost" in inner or len(section) < 3:
            continue
        if section[1] not in ("minimize", "maximize") or len(section) > 3:
            raise ReadingError(
                f"{said(section)} is not known; expected (:metric minimize (total-cost)), another "
                "number to minimize or maximize, or none for any plan",
                "problem",
                section.line,
            )
        for block in blocks(section[2]):
            if not block or str(block[0]) not in {*functions, *ARITHMETIC, "total-time"}:
                raise ReadingError(
                    f"{said(section)}: {said(block)} is no number; expected a function of the "
                    "domain, such as (total-cost)",
                    "problem",
                    section.line,
                )
        problem[:] = [part for part in problem if part is not section]
        return said(section)
    return None
