"""How each fact of a scene looks in each arrangement: what its answer may depend on.

A VLM is not asked about a picture's pixels here but about geometry: it says that one block is on
another where both share a column, that a block is in the column beside its own, that a block is
clear which has one above it. So of every fact it is worked out how far it is from being true and
what stands around.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from tpvqa_experiments.scenes.arrangements import Arrangements, Shape, arrangements
from tpvqa_experiments.scenes.recorded import facts

Situation = tuple[int, ...]
Whole = NDArray[np.int64]


@dataclass(frozen=True, slots=True)
class Look:
    """One fact in all arrangements.

    Attributes:
        predicate: Its predicate.
        first: The block that it is about.
        second: The other block or the column; 0 for `clear`.
        situations: The situations that it can be in; what their numbers are, `features` says.
        of: The place in `situations` for every arrangement.
    """

    predicate: str
    first: int
    second: int
    situations: tuple[Situation, ...]
    of: NDArray[np.int16]


@lru_cache(maxsize=8)
def looks(shape: Shape) -> tuple[Look, ...]:
    """Every fact of a shape, in the order of `recorded.facts`."""
    every = arrangements(shape)
    make = {"on": _on, "incolumn": _incolumn, "clear": _clear}
    return tuple(
        _look(name, first, second, make[name](every, first, second))
        for name, first, second in facts(shape)
    )


def holds(predicate: str, seen: Situation) -> bool:
    """Whether a fact is true in a situation."""
    if predicate == "on":
        aside, upper, lower, *_ = seen
        return aside == 0 and upper == lower + 1
    if predicate == "incolumn":
        own, asked, *_ = seen
        return own == asked
    return seen[0] == 0


def _look(name: str, first: int, second: int, seen: list[Whole]) -> Look:
    found, of = np.unique(np.stack(seen, axis=1), axis=0, return_inverse=True)
    situations = tuple(tuple(map(int, row)) for row in found)
    return Look(name, first, second, situations, of.reshape(-1).astype(np.int16))


def _on(every: Arrangements, upper: int, lower: int) -> list[Whole]:
    """How many columns and levels apart, at which height, and whether something is on either."""
    column, height = _whole(every.column), _whole(every.height)
    return [
        column[:, upper] - column[:, lower],
        height[:, upper],
        height[:, lower],
        np.minimum(_above(every, upper), 1),
        np.minimum(_above(every, lower), 1),
    ]


def _incolumn(every: Arrangements, block: int, asked: int) -> list[Whole]:
    """The block's column and the one asked about, empty ones to its left, how much stands there,
    and how high the block does."""
    own = _whole(every.column)[:, block]
    empty = np.cumsum(every.stack == 0, axis=1)
    return [
        own,
        np.full(len(own), asked),
        np.take_along_axis(empty, own[:, None], axis=1)[:, 0],
        np.minimum(_whole(every.stack)[:, asked], 2),
        np.minimum(_whole(every.height)[:, block], 2),
    ]


def _clear(every: Arrangements, block: int, _: int) -> list[Whole]:
    """How many blocks are above, how high the block is, and whether its neighbours reach over
    it."""
    column, height = _whole(every.column)[:, block], _whole(every.height)[:, block]
    walled = np.pad(_whole(every.stack), ((0, 0), (1, 1)))
    beside = [np.take_along_axis(walled, column[:, None] + k, axis=1)[:, 0] for k in (0, 2)]
    over = [(tall > height + 1).astype(np.int64) for tall in beside]
    return [_above(every, block), height, *over]


def _above(every: Arrangements, block: int) -> Whole:
    column = _whole(every.column)[:, [block]]
    tall = np.take_along_axis(_whole(every.stack), column, axis=1)[:, 0]
    return np.asarray(tall - 1 - every.height[:, block])


def _whole(values: NDArray[np.int8]) -> Whole:
    return values.astype(np.int64)
