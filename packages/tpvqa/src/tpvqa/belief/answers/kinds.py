"""The kinds of errors that are told apart, by how they last, and how probable they are at first."""

from typing import NamedTuple


class Kind(NamedTuple):
    """How errors may last.

    Attributes:
        share: The lasting share s.
        stays: Probability that a misreading, or that there is none, goes on when the scene has
            changed.
        coin: Whether an answer drawn afresh is a coin's.
    """

    share: float
    stays: float
    coin: bool = False


KINDS = (
    Kind(0.0, 0.0),
    *(Kind(share, stays) for share in (0.35, 0.6, 0.8, 0.97) for stays in (0.0, 0.9)),
    Kind(0.9, 0.9, coin=True),
    Kind(0.9, 0.99, coin=True),
)
"""What is told apart."""
FRESH = (1.0, *(0.0 for _ in KINDS[1:]))
"""How probable each is where errors are known not to last."""
RECORDED = (0.34, 0.05, 0.05, 0.07, 0.06, 0.12, 0.11, 0.07, 0.07, 0.03, 0.03)
"""How probable each is before any answer of a VLM was labelled: for two thirds as with those of
ViPlan (a lasting share of about .8 and .98, of which .77 and .55 stay), shared out widely; the rest
for one that answers anew at every look."""
UNKNOWN = tuple(
    0.8 if not kind.share else 0.2 * weight / (1 - RECORDED[0])
    for kind, weight in zip(KINDS, RECORDED, strict=True)
)
"""How probable each is taken to be of a VLM of which nothing is known. Less than the recordings
say: else a few answers about one thing could hardly speak against what is believed of it."""
