"""Every way in which some blocks can stand in some columns."""

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, permutations
from math import comb, factorial

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import BenchError

MOST = 200_000
"""Arrangements that are weighed at most; six blocks in four columns have 60,480."""
Places = NDArray[np.int8]


@dataclass(frozen=True, slots=True, order=True)
class Shape:
    """How many blocks and columns a scene has."""

    blocks: int
    columns: int

    @property
    def arrangements(self) -> int:
        """How many there are."""
        return factorial(self.blocks) * comb(self.blocks + self.columns - 1, self.columns - 1)


@dataclass(frozen=True, slots=True)
class Arrangements:
    """All arrangements of a shape, a row each.

    Attributes:
        column: The column in which each block stands; (arrangements, blocks).
        height: How many blocks are below each; (arrangements, blocks).
        stack: How many blocks each column has; (arrangements, columns).
    """

    column: Places
    height: Places
    stack: Places

    def place(self, column: Places, height: Places) -> int:
        """The row of the arrangement in which blocks stand so; -1 where there is none."""
        (found,) = np.nonzero(
            (self.column == column).all(axis=1) & (self.height == height).all(axis=1)
        )
        return int(found[0]) if len(found) else -1

    def log_prior(self) -> NDArray[np.float64]:
        """How likely each is beforehand, where every block was put into a column at random.

        A set of blocks in one column then has one order of all that are possible, so tall
        stacks are as rare as they are in problems that were generated so.
        """
        orders = np.cumsum(np.log(np.maximum(np.arange(self.stack.max() + 1), 1.0)))
        found = -orders[self.stack].sum(axis=1)
        return np.asarray(found - np.logaddexp.reduce(found))


@lru_cache(maxsize=8)
def arrangements(shape: Shape) -> Arrangements:
    """All arrangements, in an order of their own.

    Raises:
        BenchError: There are more than `MOST`.
    """
    if shape.arrangements > MOST:
        raise BenchError(
            f"{shape.blocks} blocks in {shape.columns} columns can stand in {shape.arrangements:,} "
            f"ways, and at most {MOST:,} are weighed one by one; leave such scenes out"
        )
    orders = np.array(list(permutations(range(shape.blocks))), dtype=np.int64)
    found: list[tuple[Places, Places, Places]] = []
    for bars in combinations(range(shape.blocks + shape.columns - 1), shape.columns - 1):
        edges = np.array((-1, *bars, shape.blocks + shape.columns - 1))
        stack = (np.diff(edges) - 1).astype(np.int8)
        column = np.repeat(np.arange(shape.columns, dtype=np.int8), stack)
        height = np.concatenate([np.arange(tall, dtype=np.int8) for tall in stack])
        # Row by row, the block that an order names first stands in the first place.
        where = np.argsort(orders, axis=1)
        found.append(
            (column[where], height[where], np.broadcast_to(stack, (len(orders), shape.columns)))
        )
    columns, heights, stacks = zip(*found, strict=True)
    return Arrangements(np.concatenate(columns), np.concatenate(heights), np.concatenate(stacks))
