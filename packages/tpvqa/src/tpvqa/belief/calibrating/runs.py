"""Which answers say something new: of repeated looks at an unchanged fact only the first do."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.vlm.answer import Reply

ANSWERS = (Reply.YES, Reply.NO)


@dataclass(frozen=True, slots=True)
class Placed:
    """An answer in its run: the answers of a trial to the same words about an unchanged fact.

    Attributes:
        row: The answer.
        first: Whether it is the first of its run.
        first_answer: Whether it is the first yes or no of its run.
        last: The yes or no of an earlier look in its run; None where there is none, or where this
            is the same picture again.
    """

    row: LabelledAnswer
    first: bool
    first_answer: bool
    last: LabelledAnswer | None


@dataclass(slots=True)
class _Run:
    truth: bool
    look: int
    said: LabelledAnswer | None = None


def runs(rows: Iterable[LabelledAnswer]) -> Iterator[Placed]:
    """Place answers in their runs; rows of a trial stand in the order of asking."""
    open_runs: dict[tuple[str, str, str], _Run] = {}
    for row in rows:
        key = (row.trial, row.part, row.text)
        run = open_runs.get(key)
        first = run is None or run.truth != row.truth
        if run is None or first:
            run = open_runs[key] = _Run(row.truth, row.look)
        new_look = row.look != run.look
        answers = row.reply in ANSWERS
        yield Placed(
            row,
            first=first,
            first_answer=answers and run.said is None,
            last=run.said if answers and new_look else None,
        )
        run.look = row.look
        if answers:
            run.said = row
