"""How the errors of a VLM repeat and last, from answers to the same words beside the truth."""

from collections.abc import Callable, Iterable
from itertools import groupby
from typing import NamedTuple

import numpy as np

from tpvqa.belief.answers.information import Floats
from tpvqa.belief.answers.kinds import KINDS, RECORDED
from tpvqa.belief.answers.lasting import SHARES, STAYS, fresh_rate, own_rate
from tpvqa.belief.calibrating.beta import Beta
from tpvqa.belief.calibrating.calibration import AnswerRates
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.belief.calibrating.runs import ANSWERS
from tpvqa.vlm.answer import Reply

STRENGTH = 4
"""Pairs that the default counts for: weak, as a few dozen pairs come together in a few trials."""
UNSURE = 0.02
"""That how errors last in other trials is not how they did in these."""
LEAST = 1e-12
"""The scene's own answer is as probable at least: what is rounded away would come back negative,
and grow with each answer that contradicts it."""
_RHO = np.array([0.005, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
_SHARE, _STAYS = SHARES[:, None, None], STAYS[:, None, None]
_BY_VIEW = _RHO[None, :, None], _RHO[None, None, :]


class Repeats(NamedTuple):
    """What was learnt.

    Attributes:
        lasting: Probability of each of `lasting.KINDS`.
        rho: How often a further look repeats the last answer, of the same view and of another.
        pairs: Pairs of answers that they were learnt from, likewise.
    """

    lasting: tuple[float, ...]
    rho: tuple[float, float]
    pairs: tuple[int, int]


def fit_repeats(
    rows: Iterable[LabelledAnswer],
    rates: Callable[[LabelledAnswer], AnswerRates],
    *,
    same_view: float,
    other_view: float,
) -> Repeats:
    """Weigh every way in which errors can last and repeat by how probable the answers are.

    Args:
        rows: Yes, no and what else was said; those of a trial in the order of asking.
        rates: The rates of an answer's group.
        same_view: Mode of the prior of ρ for the same view.
        other_view: The same for another view.
    """

    def of_words(row: LabelledAnswer) -> tuple[str, str, str]:
        return row.trial, row.part, row.text

    total = np.log(np.array(RECORDED))[:, None, None]
    for mode, rho in zip((same_view, other_view), _BY_VIEW, strict=True):
        total = total + STRENGTH * (mode * np.log(rho) + (1 - mode) * np.log1p(-rho))
    pairs = [0.0, 0.0]
    for _, same in groupby(sorted(rows, key=of_words), of_words):
        answers = [row for row in same if row.reply in ANSWERS]
        if len(answers) > 1:
            total = total + _probable(answers, rates, pairs)
    joint = np.exp(total - total.max())
    joint /= joint.sum()
    kinds = (1 - UNSURE) * joint.sum(axis=(1, 2)) + UNSURE * np.array(RECORDED)
    found = [float(joint.sum(axis=axes) @ _RHO) for axes in ((0, 2), (0, 1))]
    modes = (same_view, other_view)
    known = [round(f, 3) if n else mode for f, n, mode in zip(found, pairs, modes, strict=True)]
    return Repeats(
        tuple((kinds / kinds.sum()).round(4).tolist()),
        (known[0], known[1]),
        (round(pairs[0]), round(pairs[1])),
    )


def _probable(
    answers: list[LabelledAnswer],
    rates: Callable[[LabelledAnswer], AnswerRates],
    pairs: list[float],
) -> Floats:
    """Log probability of all answers to the same words in a trial; shape (kinds, ρ, ρ)."""
    found = np.zeros((len(KINDS), len(_RHO), len(_RHO)))
    yes, new = np.zeros((len(KINDS), 1, 1)), np.ones((len(KINDS), 1, 1))
    last: LabelledAnswer | None = None
    number = yeses = 0
    for row in answers:
        if last is not None and row.look == last.look:
            continue
        known = rates(row)
        rate = known.yes_if_true if row.truth else known.yes_if_false
        said, repeats = row.reply is Reply.YES, np.zeros((1, 1, 1))
        if last is not None:
            other = row.view != last.view
            if row.truth != last.truth:
                yes = _STAYS * (1 - yes - new)
            else:
                pairs[other] += row.weight
                repeats = _BY_VIEW[other]
            if row.truth != last.truth or row.scene != last.scene or other:
                number = yeses = 0
                yes = yes if row.truth != last.truth else _STAYS * yes
                new = _STAYS * new + 1 - _STAYS
        rated = np.full(len(KINDS), rate)
        first = own_rate(rated)[:, None, None]
        afresh = fresh_rate(rated, np.array(float(number)), np.array(float(yeses)))[:, None, None]
        own = np.clip(yes + new * first, LEAST, 1 - LEAST)
        own, fresh = (own, afresh) if said else (1 - own, 1 - afresh)
        drawn = _SHARE * own + (1 - _SHARE) * fresh
        again = repeats if last is not None and row.reply is last.reply else 0.0
        here = again + (1 - repeats) * drawn
        found = found + row.weight * np.log(here)
        own = own * (_SHARE + (1 - _SHARE) * fresh) / drawn
        number, yeses = number + 1, yeses + said
        yes, new, last = own if said else 1 - own, np.zeros((1, 1, 1)), row
    return found


def learn_repeats(
    repeats: Beta,
    true: float,
    said: tuple[float, float],
    unchanged: tuple[float, float],
    same: float,
) -> None:
    """Learn from one more answer how often answers repeat.

    Args:
        repeats: What is known of ρ.
        true: Probability, before the answer, that yes is right.
        said: Probability of this reply, not repeated, where yes is right and where no is.
        unchanged: Probability that the fact was the same at the last answer, likewise.
        same: 1 where it is the last reply again, else 0.
    """
    still = (true * unchanged[0], (1 - true) * unchanged[1])
    changed = (true * (1 - unchanged[0]), (1 - true) * (1 - unchanged[1]))
    yes = repeats.mean * same * sum(still)
    no = (1 - repeats.mean) * (still[0] * said[0] + still[1] * said[1])
    total = yes + no + changed[0] * said[0] + changed[1] * said[1]
    if total > 0:
        repeats.learn(yes / total, no / total)
