"""What was measured of one noise and task: ours, and the best rival beside it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import sqrt
from statistics import fmean, stdev, variance

from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import wilson
from tpvqa.events.events import BELIEVED
from tpvqa_experiments.belief.best_rival import BestRival, best_rival
from tpvqa_experiments.belief.lasting import KNOWS, REDOING, Noise, lasting_noises
from tpvqa_experiments.belief.parts import BELIEF, BLIND, FIELD, Extent
from tpvqa_experiments.belief.resampling import Estimate, Z, difference
from tpvqa_experiments.belief.results import BeliefResults

Rows = Sequence[EpisodeRow]


@dataclass(frozen=True)
class UnderNoise:
    """The trials of a task under one noise.

    Attributes:
        noise: Which.
        redo: What comes of doing again what is done: free or risky.
        task: Its name.
        own: Trials of the belief monitor; empty where it was not run.
        rivals: Trials of every rival that was run.
        limit: Trials of ours where it knows how its answers err; empty where that was not run.
    """

    noise: Noise
    redo: str
    task: str
    own: Rows
    rivals: Mapping[str, Rows]
    limit: Rows = ()

    @cached_property
    def best(self) -> BestRival | None:
        """The best rival, chosen on other trials; None where none was run."""
        return best_rival(self.rivals)

    @cached_property
    def best_blind(self) -> BestRival | None:
        """The best of those that never look."""
        return best_rival({name: own for name, own in self.rivals.items() if name in BLIND})

    @cached_property
    def ahead(self) -> Estimate | None:
        """Our completion less that of the best rival, on the trials that both ran."""
        return None if self.best is None else ahead_of(self.own, self.best.rows)

    @cached_property
    def ahead_in_truth(self) -> Estimate | None:
        """The same of trials in whose end the goal holds, whatever was said of it."""
        return None if self.best is None else ahead_of(self.own, self.best.rows, "reached")


def under_noises(
    results: BeliefResults, extent: Extent, noises: Sequence[tuple[Noise, Sequence[str]]] = ()
) -> Iterator[UnderNoise]:
    """Everything that was run under noises whose errors last, in the order of the tables.

    Args:
        results: What was run.
        extent: Which tasks and models.
        noises: Which, each with its tasks; all where none is named.
    """
    for redo in REDOING:
        for noise, tasks in noises or lasting_noises(extent.models, extent.tasks):
            for task in tasks:
                found = {
                    monitor: rows
                    for monitor in (BELIEF, KNOWS[redo], *BLIND, *FIELD)
                    if (rows := results.of(noise.cell(task, monitor, redo)))
                }
                own, limit = found.pop(BELIEF, ()), found.pop(KNOWS[redo], ())
                if own or found.keys() - {*BLIND}:  # blind trials are those of every noise
                    yield UnderNoise(noise, redo, task, own, found, limit)


def completion(rows: Rows) -> Estimate:
    """The share of trials that were completed, with Wilson's interval."""
    return _share([row.completed for row in rows])


def in_truth(rows: Rows) -> Estimate:
    """The share of trials in whose end the goal holds, whatever was said of it."""
    return _share([row.reached for row in rows])


def over_robots(robots: Sequence[Rows]) -> Estimate:
    """The same of robots whose trials hang together: each counts once.

    As in `resampling.interval`, two made-up robots, right in half, keep it from being too sure.

    Args:
        robots: The trials of each.
    """
    means = [fmean(row.completed for row in rows) for rows in robots]
    count, value = len(means), fmean(means)
    spread = variance(means) / count if count > 1 else 0.0
    half = Z * sqrt(spread + 1 / (count + 2) ** 2)
    return Estimate(value, max(value - half, 0.0), min(value + half, 1.0))


def wrong(rows: Rows) -> Estimate:
    """The share of all trials that ended in *done* with the goal false."""
    return _share([row.ending == BELIEVED for row in rows])


def questions(rows: Rows) -> Estimate:
    """Questions of a trial: the mean, with the interval of Student's limit for many trials."""
    values = [float(row.questions) for row in rows]
    half = Z * stdev(values) / sqrt(len(values)) if len(values) > 1 else 0.0
    return Estimate(fmean(values), max(fmean(values) - half, 0.0), fmean(values) + half)


def ahead_of(own: Rows, rival: Rows, name: str = "completed") -> Estimate | None:
    """Our share less a rival's; None where they have no trial in common."""
    if not {row.episode for row in own} & {row.episode for row in rival}:
        return None
    return difference(own, rival, name)


def _share(values: Sequence[bool]) -> Estimate:
    found = wilson(sum(values), len(values))
    return Estimate(found.rate, found.low, found.high)
