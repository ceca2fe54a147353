"""How fast a robot learns that its VLM is worse than it was told."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from math import log, sqrt
from statistics import fmean, stdev

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa_experiments.belief.parts import BELIEF, CHAIN, KNOWING, LEARNING, SYMBOLIC, WRONG_VLM
from tpvqa_experiments.belief.resampling import Estimate, Z, difference
from tpvqa_experiments.belief.results import BeliefResults

WITHIN = 20
"""Episodes after which it must have been learned."""
BLOCK = 5
"""Episodes of all robots that are looked at together."""
LOST = 0.03
"""Completion that may be lost by what is wrongly believed."""
RIGHT_TRUST = log(0.7 / 0.3) / log(0.9 / 0.1)
"""What the answers are worth of what they were said to be: the ratio of their log odds."""


@dataclass(frozen=True, slots=True)
class Block:
    """Some successive episodes of all robots.

    Attributes:
        first: The first of them, from 0.
        learning: Completion rate of robots that have to learn.
        knowing: Completion rate of robots that were told.
        trust: Mean trust at their end, of robots that have to learn.
        difference: Completion of those who learn less that of the others.
        episodes: How many there are of those who learn, and of the others.
        trust_margin: Half the 95% interval of the mean trust.
    """

    first: int
    learning: float
    knowing: float
    trust: float
    difference: Estimate
    episodes: tuple[int, int]
    trust_margin: float


def blocks(results: BeliefResults, task: str, size: int = BLOCK) -> list[Block]:
    """What robots do by how many episodes they have behind them; empty where none were run."""
    found = []
    learning, knowing = both(results, task)
    for first in range(0, CHAIN, size):
        own, other = (_within(rows, first, first + size) for rows in (learning, knowing))
        if not own or not other:
            continue
        last = [row.trust for row in own if row.trust is not None]
        found.append(
            Block(
                first,
                fmean(row.completed for row in own),
                fmean(row.completed for row in other),
                fmean(last) if last else 1.0,
                difference(own, other),
                (len(own), len(other)),
                _margin(own),
            )
        )
    return found


def after_learning(results: BeliefResults, task: str) -> Estimate | None:
    """The difference from the last episode on by which it must have been learned."""
    own, other = (_within(rows, WITHIN, CHAIN) for rows in both(results, task))
    return difference(own, other) if own and other else None


def episodes_until_learned(found: Sequence[Block]) -> int | None:
    """The first episode from which on no block is further behind than may be; None for none."""
    behind = [block.first for block in found if block.difference.value < -LOST]
    if not behind:
        return 0
    after = max(behind) + BLOCK
    return after if after < CHAIN else None


def both(results: BeliefResults, task: str) -> tuple[Sequence[EpisodeRow], Sequence[EpisodeRow]]:
    """The episodes of robots that have to learn, and of those who were told."""
    learning, knowing = (
        results.of(Cell(task, BELIEF, WRONG_VLM, SYMBOLIC, condition))
        for condition in (LEARNING, KNOWING)
    )
    return learning, knowing


def _margin(rows: Sequence[EpisodeRow]) -> float:
    """Of the mean trust. A robot's episodes hang together, so that each robot counts once."""
    by_robot: dict[int, list[float]] = defaultdict(list)
    for row in rows:
        if row.trust is not None:
            by_robot[row.episode // CHAIN].append(row.trust)
    means = [fmean(each) for each in by_robot.values()]
    return Z * stdev(means) / sqrt(len(means)) if len(means) > 1 else 0.0


def _within(rows: Sequence[EpisodeRow], first: int, end: int) -> list[EpisodeRow]:
    return [row for row in rows if first <= row.episode % CHAIN < end]
