"""From labelled answers to a calibration."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import zip_longest

from tpvqa.belief.calibrating.calibration import AnswerRates, Calibration, Group
from tpvqa.belief.calibrating.counts import shrunk
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.belief.calibrating.platt import WHOLE, Key, fit_curves
from tpvqa.belief.calibrating.repeats import fit_repeats
from tpvqa.belief.calibrating.runs import ANSWERS, Placed, runs
from tpvqa.errors import CalibrationError


def fit(rows: Iterable[LabelledAnswer], vlm: str, *, chosen_looks: bool = True) -> Calibration:
    """Learn what the answers of a VLM are worth.

    A monitor looks again where an answer did not please it, so its repeated errors would count
    again and again. Of looks that were chosen so, rates and curves are learnt from the first
    answers alone: the first to the same words since the fact last changed. How much the further
    ones repeat them gives ρ.

    Args:
        rows: Answers beside the truth; those of a trial in the order of asking.
        vlm: Whose answers they are.
        chosen_looks: Whether looks were repeated because of earlier answers, as monitors do; False
            for pictures that were all asked about.

    Raises:
        CalibrationError: There is no answer among them.
        MissingExtraError: scikit-learn is needed and not installed.
    """
    placed = list(runs(rows))
    every, answers = telling(placed, chosen_looks=chosen_looks)
    if not answers:
        raise CalibrationError(
            f"There is no yes or no of {vlm} among {len(placed)} answers to learn from: "
            "give more episodes, pictures or trials"
        )
    default = Calibration.default(vlm)
    with_p = [row for row in answers if row.p_yes is not None]
    curves = fit_curves(with_p) if with_p else None

    def rates(key: Key) -> AnswerRates:
        """Shrunk towards the rest of the way, and that towards the rest of all: in the rates of a
        group no answer counts twice."""
        found = default.whole.rates
        nested = list(dict.fromkeys((WHOLE, (key[0], None), key)))
        for outer, inner in zip_longest(nested, nested[1:]):
            ring = [row for row in every if _between(row, outer, inner)]
            found = shrunk(ring, [row for row in answers if _between(row, outer, inner)], found)
        return _never_swapped(found)

    def group(key: Key) -> Group:
        return Group(
            way=key[0],
            predicate=key[1],
            rows=round(sum(row.weight for row in every if _belongs(row, key))),
            rates=rates(key),
            curve=None if curves is None else curves.of(key),
        )

    found = Calibration(
        vlm=vlm,
        rows=round(sum(each.row.weight for each in placed)),
        groups=tuple(map(group, sorted({(row.way, row.predicate) for row in every}))),
        ways=tuple(group((way, None)) for way in sorted({row.way for row in every})),
        whole=group(WHOLE),
        repeat_same_view=default.repeat_same_view,
        repeat_other_view=default.repeat_other_view,
        notices=() if curves is None else curves.notices,
    )
    repeats = fit_repeats(
        (each.row for each in placed),
        lambda row: found.group_of(row.way, row.predicate).rates,
        same_view=default.repeat_same_view,
        other_view=default.repeat_other_view,
    )
    return found.model_copy(
        update={
            "repeat_same_view": repeats.rho[0],
            "repeat_other_view": repeats.rho[1],
            "pairs_same_view": repeats.pairs[0],
            "pairs_other_view": repeats.pairs[1],
            "lasting": repeats.lasting,
        }
    )


def telling(
    placed: Sequence[Placed], *, chosen_looks: bool
) -> tuple[list[LabelledAnswer], list[LabelledAnswer]]:
    """The answers that rates and curves are learnt from.

    Returns:
        Answers and abstentions, and answers alone.
    """
    if chosen_looks:
        return [each.row for each in placed if each.first], [
            each.row for each in placed if each.first_answer
        ]
    every = [each.row for each in placed]
    return every, [row for row in every if row.reply in ANSWERS]


def _never_swapped(rates: AnswerRates) -> AnswerRates:
    """Rates by which a yes never speaks for no, as with the curves."""
    if rates.yes_if_true >= rates.yes_if_false:
        return rates
    middle = (rates.yes_if_true + rates.yes_if_false) / 2
    return replace(rates, yes_if_true=middle, yes_if_false=middle)


def _between(row: LabelledAnswer, outer: Key, inner: Key | None) -> bool:
    return _belongs(row, outer) and (inner is None or not _belongs(row, inner))


def _belongs(row: LabelledAnswer, key: Key) -> bool:
    return key[0] in (None, row.way) and key[1] in (None, row.predicate)
