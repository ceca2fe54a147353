"""How often a further look only repeats the last answer, from answers at repeated looks."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from tpvqa.belief.calibration import AnswerRates
from tpvqa.belief.labelled_answer import LabelledAnswer
from tpvqa.belief.runs import Placed
from tpvqa.vlm.answer import Reply

STRENGTH = 4
"""Pairs that the default counts for: weak, as a few dozen pairs come together in a few trials."""


class Repeats(NamedTuple):
    """ρ, and how many pairs of answers it was learnt from."""

    rho: float
    pairs: int


def fit_repeats(
    placed: Iterable[Placed],
    rates: Callable[[LabelledAnswer], AnswerRates],
    *,
    same_view: float,
    other_view: float,
) -> tuple[Repeats, Repeats]:
    """ρ of the same and of another view, by maximum likelihood under a Beta prior.

    P(the last answer again) = ρ + (1 - ρ) P(answer | truth), P(the other one) = (1 - ρ) P(answer |
    truth), over consecutive answers of a run at different looks.

    Args:
        placed: Answers in their runs.
        rates: The rates of an answer's group.
        same_view: Mode of the prior of ρ for the same view.
        other_view: The same for another view.

    Returns:
        ρ of the same view, and ρ of another.
    """
    pairs: dict[bool, list[tuple[bool, float]]] = {True: [], False: []}
    for each in placed:
        row, last = each.row, each.last
        if last is not None:
            pairs[last.view == row.view].append((last.reply is row.reply, _fresh(row, rates(row))))
    return (
        Repeats(_mode(pairs[True], same_view), len(pairs[True])),
        Repeats(_mode(pairs[False], other_view), len(pairs[False])),
    )


def _fresh(row: LabelledAnswer, rates: AnswerRates) -> float:
    """P(answer | truth) of an answer that is drawn afresh."""
    yes = rates.yes_if_true if row.truth else rates.yes_if_false
    return yes if row.reply is Reply.YES else 1 - yes


def _mode(pairs: list[tuple[bool, float]], prior: float) -> float:
    if not pairs:
        return prior
    rho = np.linspace(0, 1, 1001)[1:-1]
    total = STRENGTH * (prior * np.log(rho) + (1 - prior) * np.log1p(-rho))
    for same, fresh in pairs:
        total += np.log(rho + (1 - rho) * fresh) if same else np.log1p(-rho)
    return round(float(rho[np.argmax(total)]), 3)
