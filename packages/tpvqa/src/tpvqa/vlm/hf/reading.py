"""From probabilities to answers."""

import math
from collections.abc import Sequence

from tpvqa.vlm.answer import Reply
from tpvqa.vlm.hf.family import Asked, Family
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.yes_no import YesNoMass

MOST_LEFT = 0.5
"""Probability of neither yes nor no, beyond which an answer is *unknown*."""
_LEAST = 1e-12
_DIGITS = 4
_MOST_ODDS = 30.0


def read(family: Family, asked: Sequence[Asked]) -> list[Reading]:
    """Ask a batch of questions."""
    import torch

    with torch.no_grad():
        logs = family.log_masses(asked).double().cpu().tolist()
    readings = [reading_of(_mass(*pair), family.source) for pair in logs]
    for number, reading in enumerate(readings):
        if reading.leftover is not None and reading.leftover > MOST_LEFT:
            readings[number] = family.at_length(asked[number]) or reading
    return readings


def reading_of(mass: YesNoMass, source: str) -> Reading:
    """What so much probability says; *unknown* where most is left over, or both are alike."""
    p_yes = mass.p_yes
    if p_yes is None or mass.leftover > MOST_LEFT:
        said = f"P(yes) {mass.yes:.3g}, P(no) {mass.no:.3g}: mostly neither"
        return Reading(Reply.UNKNOWN, source, said, leftover=round(mass.leftover, _DIGITS))
    reply = Reply.YES if p_yes > 0.5 else Reply.NO if p_yes < 0.5 else Reply.UNKNOWN
    return Reading(reply, source, str(reply), p_yes=p_yes, leftover=round(mass.leftover, _DIGITS))


def together(views: Sequence[Reading]) -> Reading:
    """The answer from views that were asked about one by one: those that tell, by their mean
    log-odds."""
    told = [each for each in views if each.p_yes is not None]
    if len(views) == 1 or not told:
        return views[0]
    odds = [
        math.log(_inside(p) / (1 - _inside(p))) for each in told if (p := each.p_yes) is not None
    ]
    p_yes = 1 / (1 + math.exp(-sum(odds) / len(odds)))
    leftover = sum(each.leftover or 0.0 for each in told) / len(told)
    return reading_of(
        YesNoMass(p_yes * (1 - leftover), (1 - p_yes) * (1 - leftover)), told[0].source
    )


def _inside(p: float) -> float:
    return min(max(p, _LEAST), 1 - _LEAST)


def _mass(log_yes: float, log_no: float) -> YesNoMass:
    """What is certain of two probabilities; nothing where they are no numbers.

    The last digits of a sum depend on where in memory its terms lie. They are left out, so that a
    trial is the same again.
    """
    if math.isnan(log_yes) or math.isnan(log_no) or max(log_yes, log_no) == -math.inf:
        return YesNoMass(0.0, 0.0)
    told = round(min(1.0, math.exp(log_yes) + math.exp(log_no)), _DIGITS)
    odds = round(min(max(log_yes - log_no, -_MOST_ODDS), _MOST_ODDS), _DIGITS)
    share = 1 / (1 + math.exp(-odds))
    return YesNoMass(told * share, told * (1 - share))
