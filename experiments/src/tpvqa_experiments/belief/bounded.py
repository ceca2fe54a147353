"""How trials would have ended where a risk is stated, from those in which none was.

Who states a risk does the same until the trial ends (`tests/bench/test_stated_risk.py`), and may
then say "done" or not, by how probable the goal is. So no trial has to be run again: where "done"
may be said is learnt on one half of a cell's trials and judged on the other, and the other way
round.
"""

from collections.abc import Sequence

from tpvqa.belief.calibrating.risk import RiskBound, least_trials
from tpvqa.bench.row import EpisodeRow
from tpvqa.bench.stated_risk import learnt


def bounded(rows: Sequence[EpisodeRow], risk: float) -> list[EpisodeRow]:
    """The trials of a cell as they would have ended.

    Args:
        rows: Of one cell of the belief monitor that states no risk.
        risk: What is stated.

    Returns:
        All of them, those of even episodes first; none where either half is too small to learn
        such a risk from, a trial failed, or one does not say how probable its goal was.
    """
    even, odd = ([row for row in rows if row.episode % 2 == rest] for rest in (0, 1))
    untold = any(row.error or (row.believed_goal and row.goal is None) for row in rows)
    if untold or min(len(even), len(odd)) < least_trials(risk):
        return []
    return [
        _under(learnt(others).bound(risk), row)
        for own, others in ((even, odd), (odd, even))
        for row in own
    ]


def _under(bound: RiskBound, row: EpisodeRow) -> EpisodeRow:
    if not row.believed_goal or bound.allows(row.goal or 0.0):
        return row
    return row.model_copy(update={"believed_goal": False, "completed": False, "because": "gave up"})
