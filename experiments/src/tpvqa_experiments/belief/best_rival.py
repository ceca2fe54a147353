"""The best rival of a cell, chosen on other trials than those that it is judged on."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from tpvqa.bench.row import EpisodeRow

ENOUGH = 0.2
"""Of the trials of the rival that ran most, what another needs to be chosen."""


@dataclass(frozen=True, slots=True)
class BestRival:
    """Who was best, and its trials.

    Attributes:
        names: Who was chosen by odd trials, and by even ones where that is another.
        rows: Trials of who was chosen without them, in order.
    """

    names: tuple[str, ...]
    rows: tuple[EpisodeRow, ...]

    def __str__(self) -> str:
        return " / ".join(self.names)


def best_rival(rivals: Mapping[str, Sequence[EpisodeRow]]) -> BestRival | None:
    """Choose by every other trial who is judged on the rest, and the other way round.

    The best of many on the same trials has been lucky in them, too. Who completes most is chosen,
    where that is the same with fewer questions; not who ran less than `ENOUGH` of the trials of
    who ran most, as that would be luck.

    Args:
        rivals: The trials of every rival.

    Returns:
        None where no rival ran trials of both kinds.
    """
    names, rows = [], []
    for rest in (0, 1):
        halves = {
            name: ([row for row in own if row.episode % 2 != rest], judged)
            for name, own in rivals.items()
            if (judged := [row for row in own if row.episode % 2 == rest])
        }
        most = max((len(half[0]) for half in halves.values()), default=0)
        if not most:
            return None
        able = {name: half for name, half in halves.items() if len(half[0]) >= ENOUGH * most}
        chosen = max(able, key=lambda name: _merit(able[name][0]))
        names.append(chosen)
        rows += able[chosen][1]
    rows.sort(key=lambda row: row.episode)
    return BestRival(tuple(dict.fromkeys(names)), tuple(rows))


def _merit(rows: Sequence[EpisodeRow]) -> tuple[float, float]:
    return fmean(row.completed for row in rows), -fmean(row.questions for row in rows)
