"""P(yes) before and after a calibration, on answers that the calibration was not learnt from."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import blake2b

from tpvqa.belief.calibrating.counts import PSEUDO
from tpvqa.belief.calibrating.fitting import fit, telling
from tpvqa.belief.calibrating.labelled_answer import LabelledAnswer
from tpvqa.belief.calibrating.runs import runs
from tpvqa.errors import CalibrationError
from tpvqa.vlm.answer import Reply


@dataclass(frozen=True, slots=True)
class HeldOut:
    """An answer, and how probable it makes that yes is right.

    Attributes:
        row: The answer.
        before: The VLM's P(yes); where it gave none, 1 for yes and 0 for no: its word.
        after: The probability by a calibration learnt from other trials, with the share of
            questions of its kind to which yes was right there; None where there are no others.
    """

    row: LabelledAnswer
    before: float
    after: float | None


def held_out(
    rows: Iterable[LabelledAnswer], vlm: str, *, chosen_looks: bool = True
) -> list[HeldOut]:
    """Judge every answer by what the other half of the trials taught.

    Args:
        rows: As for `fit`.
        vlm: Whose answers they are.
        chosen_looks: As for `fit`; only answers that a calibration is learnt from are judged.
    """
    halves: tuple[list[LabelledAnswer], list[LabelledAnswer]] = ([], [])
    every = list(rows)
    names = sorted({row.trial for row in every}, key=_shuffled)
    half_of = {name: number % 2 for number, name in enumerate(names)}
    for row in every:
        halves[half_of[row.trial]].append(row)
    found = []
    for judged, learnt in (halves, halves[::-1]):
        _, answers = telling(list(runs(judged)), chosen_looks=chosen_looks)
        after = _probabilities(answers, learnt, vlm, chosen_looks=chosen_looks)
        found += [HeldOut(row, _word(row), p) for row, p in zip(answers, after, strict=True)]
    return found


def _shuffled(trial: str) -> bytes:
    """An order of trials that has nothing to do with their names."""
    return blake2b(trial.encode(), digest_size=8).digest()


def _word(row: LabelledAnswer) -> float:
    return float(row.reply is Reply.YES) if row.p_yes is None else row.p_yes


def _probabilities(
    judged: Sequence[LabelledAnswer],
    learnt: Sequence[LabelledAnswer],
    vlm: str,
    *,
    chosen_looks: bool,
) -> list[float] | list[None]:
    try:
        calibration = fit(learnt, vlm, chosen_looks=chosen_looks)
    except CalibrationError:
        return [None] * len(judged)
    _, answers = telling(list(runs(learnt)), chosen_looks=chosen_looks)
    overall = (sum(row.truth for row in answers) + 1) / (len(answers) + 2)
    counts: dict[tuple[str, str], list[bool]] = {}
    for row in answers:
        counts.setdefault((row.way, row.predicate), []).append(row.truth)
    after = []
    for row in judged:
        own = counts.get((row.way, row.predicate), [])
        base = (sum(own) + PSEUDO * overall) / (len(own) + PSEUDO)
        group = calibration.group_of(row.way, row.predicate)
        odds = math.log(base / (1 - base)) + group.log_ratio(row.reply, row.p_yes)
        after.append(1 / (1 + math.exp(-odds)))
    return after
