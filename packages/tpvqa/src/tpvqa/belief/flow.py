"""Choosing by a minimum-cost flow: exact and fast where the groups have two sides.

Things on one side and places for one thing each on the other, say: every member lies in one group
of each side, so that choosing is an assignment, and a choice is a flow of one unit from thing to
place.
"""

import numpy as np
from numpy.typing import NDArray

from tpvqa.belief.incidence import Flags, Incidence, Numbers, connected
from tpvqa.errors import MissingExtraError

STEPS = 1_000_000
"""A flow costs whole numbers: so many to one unit of log odds."""

_LARGEST = 2**40


def sides(incidence: Incidence) -> Flags | None:
    """For each group its side, so that no member lies in two groups of one side.

    Returns:
        None where there are no such sides, or a member lies in more than two groups.
    """
    groups = len(incidence.exactly)
    degree = np.bincount(incidence.member, minlength=incidence.size)
    if np.any(degree > 2):
        return None
    order = np.argsort(incidence.member, kind="stable")
    one, other = incidence.group[order][(degree == 2)[incidence.member[order]]].reshape(-1, 2).T
    # In the double cover every group is there once for each side it could be on.
    ends = np.concatenate([one, one + groups]), np.concatenate([other + groups, other])
    links = np.repeat(np.arange(2 * len(one)), 2)
    label = connected(2 * groups, links, np.stack(ends, axis=1).ravel())
    if np.any(label[:groups] == label[groups:]):
        return None
    return label[:groups] > label[groups:]


def flow_choice(incidence: Incidence, weights: NDArray[np.float64], side: Flags) -> Numbers | None:
    """The members whose weights have the greatest sum, at most one of each group.

    Weights are rounded to a millionth (more coarsely where one of them is a million).

    Args:
        incidence: The groups.
        weights: What choosing each member is worth.
        side: The side of each group, see `sides`.

    Returns:
        The chosen members, ascending; None where no choice satisfies all groups.

    Raises:
        MissingExtraError: OR-Tools is not installed.
    """
    try:
        from ortools.graph.python import min_cost_flow
    except ImportError as error:
        raise MissingExtraError(
            "ortools", "belief", "Making many entangled facts consistent"
        ) from error
    groups = len(incidence.exactly)
    source, sink = groups, groups + 1
    tail = np.full(incidence.size, source)
    head = np.full(incidence.size, sink)
    left = ~side[incidence.group]
    tail[incidence.member[left]] = incidence.group[left]
    head[incidence.member[~left]] = incidence.group[~left]
    starts, ends = np.flatnonzero(~side), np.flatnonzero(side)
    steps = min(STEPS, _LARGEST / max(1.0, float(np.abs(weights).max(initial=0.0))))
    cost = -np.round(weights * steps).astype(np.int64)
    # What must flow through a group is put in behind its door and taken out before it.
    supply = np.zeros(groups + 2, dtype=np.int64)
    supply[:groups][incidence.exactly] = np.where(side, -1, 1)[incidence.exactly]
    supply[source] = -np.count_nonzero(incidence.exactly & ~side)
    supply[sink] = np.count_nonzero(incidence.exactly & side)
    flow = min_cost_flow.SimpleMinCostFlow()
    doors = np.concatenate([starts, ends])
    arcs = flow.add_arcs_with_capacity_and_unit_cost(
        np.concatenate([tail, np.full(len(starts), source), ends, [sink]]),
        np.concatenate([head, starts, np.full(len(ends), sink), [source]]),
        np.concatenate(
            [np.ones(incidence.size, dtype=np.int64), ~incidence.exactly[doors], [incidence.size]]
        ),
        np.concatenate([cost, np.zeros(len(doors) + 1, dtype=np.int64)]),
    )
    flow.set_nodes_supplies(np.arange(groups + 2), supply)
    if flow.solve() != flow.OPTIMAL:
        return None
    return np.flatnonzero(flow.flows(arcs[: incidence.size]))
