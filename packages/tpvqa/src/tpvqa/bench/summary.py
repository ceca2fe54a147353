"""The rows of a cell as one row of the table."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from statistics import fmean
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.statistics import Paired, paired, wilson
from tpvqa.events.events import BELIEVED

REFERENCE = "tpvqa"
"""The monitor that all others are compared with, where nothing else is said."""


@dataclass(frozen=True)
class Summary:
    """One cell of a bench. Counts are means over episodes.

    Attributes:
        condition: As in `Cell`.
        ci_low: Of the 95% Wilson interval.
        ci_high: Of the 95% Wilson interval.
        wasted: Actions that could do nothing.
        recovery_rate: Completed episodes among those in which an action failed; None for none.
        ended_before_first_action: Episodes without any action.
        errors: Episodes that the program could not run to their end; not completed.
        wrongly_done: Episodes that ended believing that the goal holds where it did not.
        endings: How episodes ended, most frequent first.
        against: Comparison with the reference on the same episodes; None for itself.
    """

    task: str
    monitor: str
    vlm: str
    world: str
    condition: str
    episodes: int
    completed: int
    completion_rate: float
    ci_low: float
    ci_high: float
    questions: float
    looks: float
    actions: float
    repeats: float
    replans: float
    wasted: float
    seconds: float
    recovery_rate: float | None
    ended_before_first_action: int
    errors: int
    wrongly_done: int
    endings: Mapping[str, int]
    against: Paired | None = None

    def flat(self) -> dict[str, Any]:
        """As one row of plain values."""
        row = asdict(self)
        row.pop("against")
        row["endings"] = ", ".join(f"{name} {count}" for name, count in self.endings.items())
        row["difference"] = None if self.against is None else self.against.difference
        row["mcnemar_p"] = None if self.against is None else self.against.p
        return row


def summarise(cell: Cell, rows: Sequence[EpisodeRow], reference: Sequence[EpisodeRow]) -> Summary:
    """Figures of a cell.

    Args:
        cell: Which.
        rows: Its episodes, in order.
        reference: Episodes of the monitor to compare with, of a cell that is the same otherwise;
            empty for that monitor itself.
    """
    completed = sum(row.completed for row in rows)
    interval = wilson(completed, len(rows))
    failed = [row for row in rows if row.failures]
    return Summary(
        task=cell.task,
        monitor=cell.monitor,
        vlm=cell.vlm,
        world=cell.world,
        condition=cell.condition,
        episodes=len(rows),
        completed=completed,
        completion_rate=interval.rate,
        ci_low=interval.low,
        ci_high=interval.high,
        questions=fmean(row.questions for row in rows),
        looks=fmean(row.looks for row in rows),
        actions=fmean(row.actions for row in rows),
        repeats=fmean(row.repeats for row in rows),
        replans=fmean(row.replans for row in rows),
        wasted=fmean(row.wasted for row in rows),
        seconds=fmean(row.seconds for row in rows),
        recovery_rate=fmean(row.completed for row in failed) if failed else None,
        ended_before_first_action=sum(not row.actions and not row.error for row in rows),
        errors=sum(bool(row.error) for row in rows),
        wrongly_done=sum(row.ending == BELIEVED for row in rows),
        endings=dict(Counter(row.ending for row in rows).most_common()),
        against=_against(rows, reference),
    )


def _against(rows: Sequence[EpisodeRow], reference: Sequence[EpisodeRow]) -> Paired | None:
    other = {row.episode: row.completed for row in reference}
    both = [(row.completed, other[row.episode]) for row in rows if row.episode in other]
    return paired([a for a, _ in both], [b for _, b in both]) if both else None


def summaries(
    rows: Mapping[Cell, Sequence[EpisodeRow]], reference: str = REFERENCE
) -> list[Summary]:
    """Figures of all cells that have episodes, beside those of a reference monitor."""
    found = []
    for cell, own in rows.items():
        if own:
            beside = replace(cell, monitor=reference)
            others = [] if cell.monitor == reference else rows.get(beside, [])
            found.append(summarise(cell, own, others))
    return found


def plain_rows(found: Sequence[Summary], reference: str = REFERENCE) -> list[dict[str, Any]]:
    """One row of plain values for every cell, as `--json` prints them."""
    rows = []
    for each in found:
        row = asdict(each)
        against = row.pop("against")
        row["endings"] = dict(each.endings)
        if against is not None:
            row[f"against_{reference}"] = against
        rows.append(row)
    return rows
