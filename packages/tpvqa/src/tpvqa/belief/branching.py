"""Choosing by branch and bound: exact, for what is small."""

from collections.abc import Iterator, Sequence


class TooManyBranches(Exception):  # noqa: N818
    """The limit of branches came before the proof."""


def best_choice(
    weights: Sequence[float],
    groups: Sequence[tuple[Sequence[int], bool]],
    *,
    limit: int,
) -> list[int] | None:
    """The members whose weights have the greatest sum, at most one of each group.

    Where it pays to choose in every group for itself bounds what can be had; branches differ in one
    member, whose choice contradicts another.

    Args:
        weights: What choosing each member is worth.
        groups: The members of each group, and whether one must be chosen.
        limit: How many branches to look into.

    Returns:
        The chosen members, ascending; None where no choice satisfies all groups.

    Raises:
        TooManyBranches: The limit came before the proof.
    """
    conflicts = [0] * len(weights)
    needing = []
    for members, exactly in groups:
        mask = sum(1 << member for member in members)
        if exactly:
            needing.append(mask)
        for member in members:
            conflicts[member] |= mask & ~(1 << member)
    homes = _homes(weights, groups)
    best: tuple[float, int] | None = None
    stack = [((1 << len(weights)) - 1, 0)]
    for _ in range(limit):
        if not stack:
            break
        free, chosen = stack.pop()
        bound, picks = 0.0, 0
        for order, mask, must in homes:
            held = chosen & mask
            pick = (
                held.bit_length() - 1
                if held
                else next((member for member in order if free >> member & 1), -1)
            )
            if pick >= 0 and (must or held or weights[pick] > 0):
                bound += weights[pick]
                picks |= 1 << pick
            elif must:
                break
        else:
            if best is not None and bound <= best[0]:
                continue
            branch = _in_question(picks, free, conflicts, needing, weights)
            if branch is None:
                best = (bound, picks)
            elif branch >= 0:
                one = 1 << branch
                stack.append((free & ~one, chosen))
                stack.append((free & ~conflicts[branch], chosen | one))
    if stack:
        raise TooManyBranches
    if best is None:
        return None
    return list(_members(best[1]))


def _homes(
    weights: Sequence[float], groups: Sequence[tuple[Sequence[int], bool]]
) -> list[tuple[list[int], int, bool]]:
    """Disjoint parts of groups that cover all members: best first, as bits, and whether one must
    be chosen there."""
    homes = []
    left = set(range(len(weights)))
    ranked = sorted(range(len(groups)), key=lambda g: (not groups[g][1], -len(groups[g][0]), g))
    whole = [(groups[g][0], groups[g][1]) for g in ranked]
    for members, exactly in (*whole, *(((member,), False) for member in range(len(weights)))):
        inside = left.intersection(members)
        if not inside:
            continue
        left -= inside
        order = sorted(inside, key=lambda member: (-weights[member], member))
        must = exactly and len(inside) == len(members)
        homes.append((order, sum(1 << member for member in inside), must))
    return homes


def _in_question(
    picks: int,
    free: int,
    conflicts: Sequence[int],
    needing: Sequence[int],
    weights: Sequence[float],
) -> int | None:
    """A member whose choice is in question; None where all is well, -1 where nothing can be."""
    for member in _members(picks):
        if conflicts[member] & picks:
            return member
    for mask in needing:
        if not mask & picks:
            candidates = _members(mask & free)
            return max(candidates, key=lambda member: (weights[member], -member), default=-1)
    return None


def _members(mask: int) -> Iterator[int]:
    while mask:
        yield (mask & -mask).bit_length() - 1
        mask &= mask - 1
