"""The table of the bench on ViPlan's problems, with what was published beside it."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from statistics import fmean
from typing import Any

from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Interval, wilson
from tpvqa_experiments.belief.markdown import rate, table
from tpvqa_experiments.viplan.group import Group
from tpvqa_experiments.viplan.published import Published

CHECKS = ("precondition", "effect")


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One group of the bench. Counts are means over episodes.

    Attributes:
        group: What it is of.
        episodes: How many there are.
        completion: Share in which the goal held in truth at the end, as ViPlan counts.
        known: Share in which the trial ended believing so, besides.
        mistaken: Share that ended in "done" with the goal false.
        ended: Share in which no action was so much as checked: there was no plan, or an empty one.
        questions: Asked.
        actions: Done, those that were refused included.
        seconds: Of an episode.
        errors: Episodes that the program could not run to their end.
        published: What came of the published runs; None where there are none.
    """

    group: Group
    episodes: int
    completion: Interval
    known: float
    mistaken: float
    ended: Interval
    questions: float
    actions: float
    seconds: float
    errors: int
    published: Published | None

    @property
    def recorded(self) -> Interval | None:
        """The published completion rate."""
        told = self.published
        return None if told is None else wilson(told.reached, told.episodes)

    @property
    def recorded_ended(self) -> Interval | None:
        """The published share of episodes without any action to be checked."""
        told = self.published
        return None if told is None else wilson(told.ended, told.episodes)

    def flat(self) -> dict[str, Any]:
        """As one row of plain values."""
        row = asdict(self.group)
        row |= {"episodes": self.episodes, "completion_rate": self.completion.rate}
        row |= {"ci_low": self.completion.low, "ci_high": self.completion.high}
        row |= {"known": self.known, "believed_done_and_was_not": self.mistaken}
        row |= {"ended_before_first_action": self.ended.rate}
        row |= {"questions": self.questions, "actions": self.actions, "seconds": self.seconds}
        row |= {"errors": self.errors}
        row |= _flat("recorded_completion_rate", self.recorded)
        row |= _flat("recorded_ended_before_first_action", self.recorded_ended)
        if self.group.compared:
            row["as_recorded"] = lies_in(self.completion, self.recorded)
            row["ended_as_recorded"] = lies_in(self.ended, self.recorded_ended)
        return row


def _flat(name: str, told: Interval | None) -> dict[str, float | None]:
    if told is None:
        return {name: None}
    return {name: told.rate, f"{name}_low": told.low, f"{name}_high": told.high}


def lies_in(ours: Interval, recorded: Interval | None) -> bool | None:
    """Whether our rate and the recorded one are the same as far as 25 episodes can tell: one of
    them lies in the other's 95% interval. None where nothing was recorded."""
    if recorded is None:
        return None
    return recorded.low <= ours.rate <= recorded.high or ours.low <= recorded.rate <= ours.high


def line(group: Group, rows: Sequence[EpisodeRow], published: Published | None) -> Line:
    """The figures of a group.

    Args:
        group: Which.
        rows: Its episodes, at least one.
        published: What came of the published runs.
    """
    count = len(rows)
    return Line(
        group=group,
        episodes=count,
        completion=wilson(sum(row.reached for row in rows), count),
        known=sum(row.completed for row in rows) / count,
        mistaken=sum(row.believed_goal and not row.reached for row in rows) / count,
        ended=wilson(sum(not row.first_plan for row in rows), count),
        questions=fmean(row.questions for row in rows),
        actions=fmean(row.actions for row in rows),
        seconds=fmean(row.seconds for row in rows),
        errors=sum(bool(row.error) for row in rows),
        published=published,
    )


def markdown(lines: Sequence[Line]) -> str:
    """The table, what it comes to by monitor, and how often it came out as recorded."""
    names = (
        *("environment", "setting", "split", "model", "monitor", "limit", "episodes"),
        *("completed", "95% interval", "recorded", "ended before an action", "recorded "),
        *("questions", "actions", "done and was not", "seconds"),
    )
    found = [
        (
            *map(str, asdict(each.group).values()),
            str(each.episodes),
            rate(each.completion.rate),
            f"{rate(each.completion.low)}–{rate(each.completion.high)}",
            _beside(each, each.completion, each.recorded),
            rate(each.ended.rate),
            _beside(each, each.ended, each.recorded_ended),
            f"{each.questions:.0f}",
            f"{each.actions:.1f}",
            rate(each.mistaken),
            f"{each.seconds:.2f}",
        )
        for each in lines
    ]
    parts = ["# ViPlan's problems, measured\n", _means(lines), _agreement(lines)]
    return "\n".join([*filter(None, parts), table(names, found)])


def _beside(each: Line, ours: Interval, recorded: Interval | None) -> str:
    if recorded is None:
        return ""
    differs = each.group.compared and not lies_in(ours, recorded)
    return rate(recorded.rate) + (" **differs**" if differs else "")


def _means(lines: Sequence[Line]) -> str:
    """Means over models and splits, for every monitor."""
    groups: dict[tuple[str, ...], list[Line]] = {}
    for each in lines:
        of = each.group
        groups.setdefault((of.environment, of.setting, of.monitor, of.limit), []).append(each)
    names = ("environment", "setting", "monitor", "limit", "cells", "completed, mean", "least")
    found = [
        (
            *map(str, key),
            str(len(own)),
            rate(fmean(each.completion.rate for each in own)),
            rate(min(each.completion.rate for each in own)),
            rate(fmean(each.ended.rate for each in own)),
            f"{fmean(each.questions for each in own):.0f}",
        )
        for key, own in groups.items()
    ]
    return table((*names, "ended before an action", "questions"), found)


def _agreement(lines: Sequence[Line]) -> str:
    """In how many cells it came out as recorded."""
    told = [each for each in lines if each.group.compared and each.published is not None]
    if not told:
        return ""
    done = sum(bool(lies_in(each.completion, each.recorded)) for each in told)
    ended = sum(bool(lies_in(each.ended, each.recorded_ended)) for each in told)
    return (
        f"As recorded, one rate in the other's 95% interval: completion in {done} of {len(told)} "
        f"cells, episodes that ended before an action in {ended} of {len(told)}.\n"
    )
