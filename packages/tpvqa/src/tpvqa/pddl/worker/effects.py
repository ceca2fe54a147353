"""Effects that no action can have, and those that the translator cannot take apart."""

from typing import Any

from tpvqa.errors import shown
from tpvqa.pddl.worker.blocks import blocks, said
from tpvqa.pddl.worker.lisp import Block, line_of
from tpvqa.pddl.worker.reading_error import ReadingError


def check_equality(task: Any) -> None:
    """Nothing makes two things the same one: the translator would take it for a predicate.

    Raises:
        ReadingError: An effect or a rule would.
    """
    for action in task.actions:
        for effect in action.effects:
            if effect.literal.predicate == "=":
                raise ReadingError(
                    f"an effect of the action {shown(action.name)} is an equality, "
                    f"{said(['=', *effect.literal.args])}, and which thing is which never changes; "
                    "expected it in conditions only: leave it out, or say by a predicate what "
                    "changes",
                    "domain",
                    line_of(list(effect.literal.args)) or line_of(action.name),
                )
    for axiom in task.axioms:
        if axiom.name == "=":
            raise ReadingError(
                "a rule derives an equality, and which thing is which never changes; expected a "
                "predicate of another name in (:derived …)",
                "domain",
                line_of(axiom.name),
            )


def misplaced_forall(effect: object) -> tuple[str, int | None] | None:
    """What to write instead of a `forall` of several effects, or beside others, within a `when`,
    with its line; None where there is none."""
    for block in blocks(effect):
        if block[:1] == ["when"] and len(block) == 3:
            inner: list[Block] = [each for each in blocks(block[2]) if each[:1] == ["forall"]]
            if inner and len(inner[0]) > 1:
                things, condition = said(inner[0][1])[1:-1], said(block[1])[1:-1]
                return (
                    "Fast Downward does not read a 'forall' beside other effects, or with several, "
                    f"within a 'when'; write it outside, once for each effect: (forall {things} "
                    f"(when {condition} …))",
                    inner[0].line,
                )
    return None
