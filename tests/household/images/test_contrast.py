"""What stands out in a picture, and what a person would overlook."""

import math

import numpy as np
import pytest

from tpvqa_household.images.contrast import DISTINCT, distinctness


def thing(side: int) -> np.ndarray:
    mask = np.zeros((64, 64), bool)
    mask[20 : 20 + side, 20 : 20 + side] = True
    return mask


def painted(mask: np.ndarray, colour: int, ground: int = 120) -> np.ndarray:
    pixels = np.full((64, 64, 3), ground, np.uint8)
    pixels[mask] = colour
    return pixels


def test_a_thing_of_the_colour_of_its_ground_does_not_stand_out() -> None:
    mask = thing(12)
    assert distinctness(painted(mask, 120), mask) == 0
    assert distinctness(painted(mask, 200), mask) > DISTINCT


def test_the_smaller_a_thing_the_more_contrast_it_needs() -> None:
    small, large = thing(4), thing(20)
    assert distinctness(painted(small, 140), small) < DISTINCT
    assert distinctness(painted(large, 140), large) > DISTINCT


def test_a_pattern_that_has_the_colour_of_a_thing_hides_it() -> None:
    mask = thing(8)
    pixels = painted(mask, 200)
    pattern = np.indices((64, 64)).sum(0) // 4 % 2 == 0
    pixels[pattern & ~mask] = 200
    assert distinctness(pixels, mask) < DISTINCT < distinctness(painted(mask, 200), mask)


@pytest.mark.parametrize("filled", [True, False])
def test_what_fills_the_picture_or_is_not_there_needs_no_contrast(filled: bool) -> None:
    mask = np.full((64, 64), filled)
    assert distinctness(painted(mask, 120), mask) == math.inf
