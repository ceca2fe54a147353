"""How often each reply comes, from counts."""

from collections.abc import Iterable, Sequence

from tpvqa.belief.calibrating.calibration import AnswerRates
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.belief.calibrating.runs import ANSWERS
from tpvqa.vlm.answer import Reply

PSEUDO = 15
"""What the wider group counts for in a narrower one, in answers. As many answers know a rate of
0.85 to ±0.09, about as far as the rates of one VLM's predicates lie apart: a group of fewer answers
is better told by the wider one, a group of more by itself."""


def shrunk(
    every: Sequence[LabelledAnswer], answers: Sequence[LabelledAnswer], wider: AnswerRates
) -> AnswerRates:
    """The rates of some answers, shrunk towards those of a wider group.

    Args:
        every: Answers and abstentions, for the rates of abstaining.
        answers: Answers, for the rates of yes.
        wider: The rates of the wider group.
    """
    return AnswerRates(
        yes_if_true=_share(
            ((row, row.reply is Reply.YES) for row in answers if row.truth), wider.yes_if_true
        ),
        yes_if_false=_share(
            ((row, row.reply is Reply.YES) for row in answers if not row.truth),
            wider.yes_if_false,
        ),
        abstain_if_true=_share(
            ((row, row.reply not in ANSWERS) for row in every if row.truth), wider.abstain_if_true
        ),
        abstain_if_false=_share(
            ((row, row.reply not in ANSWERS) for row in every if not row.truth),
            wider.abstain_if_false,
        ),
    )


def _share(cases: Iterable[tuple[LabelledAnswer, bool]], wider: float) -> float:
    hits = total = 0.0
    for row, hit in cases:
        total += row.weight
        hits += row.weight * hit
    return (hits + PSEUDO * wider) / (total + PSEUDO)
