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


class _Pair(NamedTuple):
    """Two answers in a row: whether they are the same, P(the later one | truth) of one that is
    drawn afresh, and how many pairs it counts for."""

    same: bool
    fresh: float
    weight: float


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
    pairs: dict[bool, list[_Pair]] = {True: [], False: []}
    for each in placed:
        row, last = each.row, each.last
        if last is not None:
            pair = _Pair(last.reply is row.reply, _fresh(row, rates(row)), row.weight)
            pairs[last.view == row.view].append(pair)
    return (
        Repeats(_mode(pairs[True], same_view), _count(pairs[True])),
        Repeats(_mode(pairs[False], other_view), _count(pairs[False])),
    )


def _fresh(row: LabelledAnswer, rates: AnswerRates) -> float:
    """P(answer | truth) of an answer that is drawn afresh."""
    yes = rates.yes_if_true if row.truth else rates.yes_if_false
    return yes if row.reply is Reply.YES else 1 - yes


def _count(pairs: list[_Pair]) -> int:
    return round(sum(pair.weight for pair in pairs))


def _mode(pairs: list[_Pair], prior: float) -> float:
    if not pairs:
        return prior
    rho = np.linspace(0, 1, 1001)[1:-1]
    total = STRENGTH * (prior * np.log(rho) + (1 - prior) * np.log1p(-rho))
    for same, fresh, weight in pairs:
        total += weight * (np.log(rho + (1 - rho) * fresh) if same else np.log1p(-rho))
    return round(float(rho[np.argmax(total)]), 3)
