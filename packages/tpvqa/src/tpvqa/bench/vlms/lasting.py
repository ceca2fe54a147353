"""What share of a VLM's errors lasts: the same again about another picture of the same scene.

An answer is, with probability s, the scene's own draw, and else drawn afresh, so that two answers
to a question about one scene correlate by s² (docs/vlms.md). Here that correlation is measured: of
what an answer says beyond the rate of yes for its predicate and truth, as in the table of recorded
models there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from tpvqa.bench.vlms.asking import Row
from tpvqa.vlm import Reply

LEAST = 6
"""Clusters, below which there is no interval: of fewer a bootstrap is too sure."""
SAMPLES = 1000
"""Of a bootstrap."""


@dataclass(frozen=True, slots=True)
class Lasting:
    """The lasting share s, and what it rests on.

    Attributes:
        share: Of the answers about other pictures of the scene; None without any pair of them, or
            where nothing varies.
        low: Of its 95% interval over clusters; None where there are too few.
        high: The same.
        pairs: Pairs of answers that it rests on.
        same_picture: The same of answers about the very same picture, asked again.
        same_picture_pairs: Pairs that this rests on.
    """

    share: float | None
    low: float | None
    high: float | None
    pairs: int
    same_picture: float | None
    same_picture_pairs: int


@dataclass
class _Sums:
    """Of a cluster: products of pairs, and squares, of other pictures and of the same."""

    other: float = 0.0
    of_other: float = 0.0
    same: float = 0.0
    of_same: float = 0.0


def lasting_errors(rows: Sequence[Row], *, seed: int = 0) -> Lasting:
    """Measure how far errors last.

    Args:
        rows: Answers of one VLM; abstentions do not count.
        seed: Decides the draws of the interval.
    """
    once = {(row.look, row.question, row.repeat): row for row in rows}
    answered = [row for row in once.values() if row.reply in (Reply.YES, Reply.NO)]
    rates: dict[tuple[str, str, bool], list[float]] = {}
    for row in answered:
        rates.setdefault(_stratum(row), []).append(row.reply is Reply.YES)
    means = {stratum: float(np.mean(said)) for stratum, said in rates.items()}
    groups: dict[tuple[str, str, str, bool], dict[str, list[float]]] = {}
    for row in answered:
        beyond = (row.reply is Reply.YES) - means[_stratum(row)]
        group = groups.setdefault((row.cluster, row.scene, row.question, row.truth), {})
        group.setdefault(row.look, []).append(beyond)
    sums: dict[str, _Sums] = {}
    pairs = same_pairs = 0
    for (cluster, *_), group in groups.items():
        more, same = _add(sums.setdefault(cluster, _Sums()), list(group.values()))
        pairs, same_pairs = pairs + more, same_pairs + same
    every = list(sums.values())
    other = np.array([(each.other, each.of_other) for each in every]).reshape(-1, 2)
    alike = np.array([(each.same, each.of_same) for each in every]).reshape(-1, 2)
    share = _share(other.sum(0))
    low = high = None
    if share is not None and len(every) >= LEAST:
        draws = np.random.default_rng(seed)
        drawn = draws.integers(0, len(every), (SAMPLES, len(every)))
        found = [s for s in map(_share, other[drawn].sum(1)) if s is not None]
        low, high = map(float, np.percentile(found, (2.5, 97.5)))
    return Lasting(share, low, high, pairs, _share(alike.sum(0)), same_pairs)


def _stratum(row: Row) -> tuple[str, str, bool]:
    return row.wording, row.predicate, row.truth


def _add(sums: _Sums, looks: list[list[float]]) -> tuple[int, int]:
    """Add the answers to one question about one scene, by look; gives the numbers of pairs."""
    totals = np.array([sum(look) for look in looks])
    squares = np.array([sum(x * x for x in look) for look in looks])
    counts = np.array([len(look) for look in looks])
    size = int(counts.sum())
    pairs = size * size - int((counts**2).sum())
    if pairs:  # each group counts for as many answers as it has
        sums.other += float(totals.sum() ** 2 - (totals**2).sum()) * size / pairs
        sums.of_other += float(squares.sum())
    again = int((counts * (counts - 1)).sum())
    if again:
        repeated = counts > 1
        sums.same += float((totals**2 - squares)[repeated].sum()) * (
            int(counts[repeated].sum()) / again
        )
        sums.of_same += float(squares[repeated].sum())
    return pairs // 2, again // 2


def _share(products: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> float | None:
    product, square = products
    return None if square <= 0 else float(np.sqrt(np.clip(product / square, 0, 1)))
