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
        undone: What undoing leads to, with shares; what is missing to one leaves it as it is.
        rate: How probable that is.
        more: What it costs besides.

    Returns:
        Shares, joint states, and what each costs besides.
    """
    falls = [(share * rate * each, other, 0.0) for each, other in undone] if rate else []
    left = share - sum(each for each, _, _ in falls)
    return [(left, number, more), *falls]
