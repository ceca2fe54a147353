"""After which events of a trial it is killed in tests: going on takes as long as the trial did."""

from collections.abc import Sequence


def moments(kinds: Sequence[str], *, spread: int) -> list[int]:
    """Numbers of events after which a trial is cut off.

    Every two kinds that follow each other are parted where they first do so, and `spread` further
    cuts lie evenly over the trial.

    Args:
        kinds: Of all events of the trial, in their order.
        spread: How many more cuts.
    """
    parted: dict[tuple[str, str], int] = {}
    for cut in range(1, len(kinds)):
        parted.setdefault((kinds[cut - 1], kinds[cut]), cut)
    step = max(1, len(kinds) // spread)
    return sorted({*parted.values(), *range(1, len(kinds), step)})
