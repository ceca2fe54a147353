"""What an answer to a fact in a situation may depend on, and how much at most.

Each feature has a group; a group's width is the standard deviation of its weight's prior, in log
odds of a yes. What is not in the recordings has weight 0, so it counts as what is nearest to it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from tpvqa_experiments.scenes.arrangements import Shape
from tpvqa_experiments.scenes.situations import Look, Situation, holds

WIDTHS = {"truth": 3.0, "apart": 1.0, "place": 0.7, "around": 0.5, "size": 0.3, "colour": 0.3}
"""Of what all VLMs have in common."""
OWN_WIDTHS = {**WIDTHS, "truth": 1.5}
"""Of how one VLM differs from all."""
Feature = tuple[object, ...]
Rows = NDArray[np.int64]


@dataclass(slots=True)
class Vocabulary:
    """Every feature that was met, with a place each."""

    places: dict[Feature, int] = field(default_factory=dict)

    def rows(self, look: Look, shape: Shape, blocks: tuple[str, ...]) -> Rows:
        """The features of a fact in each of its situations; (situations, features)."""
        letters = [blocks[look.first]]
        if look.predicate == "on":
            letters.append(blocks[look.second])
        every = [
            [
                self.places.setdefault((*each, look.predicate), len(self.places))
                for each in features(look.predicate, seen, shape, letters)
            ]
            for seen in look.situations
        ]
        return np.array(every, np.int64)

    def widths(self, of: dict[str, float]) -> NDArray[np.float64]:
        """The width of every feature's group."""
        return np.array([of[str(feature[0])] for feature in self.places], float)


def features(
    predicate: str, seen: Situation, shape: Shape, letters: list[str]
) -> Iterator[Feature]:
    """The features of a fact in a situation: as many for every situation of a predicate."""
    true = holds(predicate, seen)
    yield "truth", true
    if predicate == "on":
        yield from _on(seen, shape, true)
        yield "colour", true, "second", letters[1]
        yield "colour", true, *letters
    elif predicate == "incolumn":
        yield from _incolumn(seen, shape, true)
    else:
        yield from _clear(seen, shape, true)
    yield "colour", true, "first", letters[0]


def _on(seen: Situation, shape: Shape, true: bool) -> Iterator[Feature]:
    aside, upper, lower, covered, covers = seen
    rise = upper - lower
    near, far = _within(aside, 1), _within(aside, 2)
    if aside == 0:
        yield "apart", "above", _within(rise, 3)
        yield "place", "above", _within(rise, 2), min(upper, lower)
        yield "around", "above", _within(rise, 2), covered, covers
        yield "around", "above", _within(rise, 2), covered
        yield "size", "above", _within(rise, 1), true, shape
    else:
        yield "apart", "beside", far, _within(rise, 1)
        yield "place", "beside", near, _within(rise, 3)
        yield "around", "beside", near, min(upper, 2), min(lower, 2), covers
        yield "around", "beside", near, covered, covers, "tops"
        yield "size", "beside", far, shape


def _incolumn(seen: Situation, shape: Shape, true: bool) -> Iterator[Feature]:
    own, asked, empty, stack, height = seen
    aside = asked - own
    counted = asked - (own - empty)  # as if empty columns did not count
    yield "apart", _within(aside, 3)
    yield "place", own, asked
    yield "place", own, asked, shape
    yield "around", "empty", _within(aside, 2), min(empty, 2)
    yield "around", "counted", _within(counted, 3), true
    yield "around", "stack", _within(aside, 2), stack
    yield "around", "height", _within(aside, 2), height
    yield "size", _within(aside, 1), shape


def _clear(seen: Situation, shape: Shape, true: bool) -> Iterator[Feature]:
    above, height, left, right = seen
    yield "apart", min(above, 2)
    yield "place", min(above, 2), min(height, 2)
    yield "around", true, left, right
    yield "size", min(above, 1), shape
    yield "size", min(above, 1), min(height, 1), shape


def _within(value: int, most: int) -> int:
    return max(-most, min(most, value))
