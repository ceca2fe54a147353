"""How completion depends on the limits: from one run under the widest of them."""

from collections.abc import Mapping, Sequence

from tpvqa.bench.row import EpisodeRow

TIGHTER: Mapping[str, tuple[int, ...]] = {
    "actions": (8, 12, 16, 20, 30, 40, 60),
    "repeats": (0, 1, 2, 3, 5, 10),
    "replans": (0, 1, 2, 3, 5, 10),
}
"""The limits that are tried."""


def sensitivity(rows: Sequence[EpisodeRow]) -> dict[str, dict[int, float]]:
    """Completion rate under each tighter limit, the others as they were.

    A limit only ends a trial early. So an episode is completed under a tighter one exactly if it
    was completed without ever passing it.
    """
    reached = {
        "actions": [row.actions for row in rows],
        "repeats": [row.longest_repeat for row in rows],
        "replans": [row.replans for row in rows],
    }
    return {
        name: {
            limit: sum(
                row.completed and used <= limit
                for row, used in zip(rows, reached[name], strict=True)
            )
            / len(rows)
            for limit in tried
        }
        for name, tried in TIGHTER.items()
    }
