"""P(yes) from samples, for servers that give no probabilities of tokens."""

from collections.abc import Sequence

from tpvqa.vlm.answer import Reply
from tpvqa.vlm.reading import Reading

SMOOTHING = 0.5
"""Added to either count (Jeffreys' prior), so that no number of samples is taken for certainty."""


def frequency(samples: Sequence[Reading], wanted: int) -> Reading:
    """One reading of several samples: P(yes) = (yes + ½) / (yes + no + 1).

    Args:
        samples: Those that came; what is neither yes nor no counts as left over.
        wanted: How many were asked for.
    """
    yes = sum(each.reply is Reply.YES for each in samples)
    no = sum(each.reply is Reply.NO for each in samples)
    other = max(wanted, len(samples)) - yes - no
    said = f"{yes} yes, {no} no, {other} neither, of {max(wanted, len(samples))} samples"
    if yes + no == 0:
        why = next((each.text for each in samples), "none came")
        return Reading(Reply.UNKNOWN, "samples", f"{said}: {why}", leftover=1.0)
    leftover = other / (yes + no + other)
    if yes == no or leftover > 0.5:
        return Reading(Reply.UNKNOWN, "samples", said, leftover=leftover)
    p_yes = (yes + SMOOTHING) / (yes + no + 2 * SMOOTHING)
    reply = Reply.YES if yes > no else Reply.NO
    return Reading(reply, "samples", said, p_yes=p_yes, leftover=leftover)
