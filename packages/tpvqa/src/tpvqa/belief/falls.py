"""What comes of a joint state where something achieved may be undone."""

from collections.abc import Iterable


def fallen(
    share: float,
    number: int,
    undone: Iterable[tuple[float, int]],
    rate: float,
    more: float = 0.0,
) -> list[tuple[float, int, float]]:
    """What comes of a joint state where something achieved may be undone.

    Args:
        share: Its share of what an action leads to.
        number: Of the joint state.
        undone: What undoing leads to, with shares.
        rate: How probable that is.
        more: What it costs besides.

    Returns:
        Shares, joint states, and what each costs besides.
    """
    falls = [(share * rate * each, other, 0.0) for each, other in undone] if rate else []
    return [(share * (1 - rate) if falls else share, number, more), *falls]
