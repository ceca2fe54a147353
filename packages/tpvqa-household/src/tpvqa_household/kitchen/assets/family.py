"""Families: ways of making variants of a kind of thing. The library is a list of them."""

from collections.abc import Callable
from dataclasses import dataclass

from numpy.random import Generator

from tpvqa_household.kitchen.assets.model import Model


@dataclass(frozen=True, slots=True)
class Family:
    """A way of making things of one kind, with its own range of shapes.

    Attributes:
        kind: The kind of thing.
        name: Unique among all families.
        make: Draws a variant; a function of the generator alone.
        held_out: True if training never sees it.
        weight: How often `draw` takes it, relative to the kind's other families.
        fixed: How many of its variants `models` lists.
    """

    kind: str
    name: str
    make: Callable[[Generator], Model]
    held_out: bool = False
    weight: float = 1.0
    fixed: int = 2
