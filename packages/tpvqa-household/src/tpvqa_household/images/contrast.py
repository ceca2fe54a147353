"""How well a thing stands out from what is around it in a picture."""

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageFilter

from tpvqa_household.kitchen.household import ITEMS

if TYPE_CHECKING:
    from tpvqa_household.kitchen.scene import KitchenScene

AROUND = 9
"""Width of the box, pixels, that grows a thing by its surroundings."""
DISTINCT = 0.85
"""Of things that stand out less, a person looking at the shipped pictures is not sure."""
DIRTY = 1.0
"""Of dirt that stands out less, as the rim of a stain beside a loaf does, neither."""


def distinctness(pixels: NDArray[np.uint8], mask: NDArray[np.bool_]) -> float:
    """How well a thing stands out; as in signal detection, the smaller the more contrast it needs.

    Its contrast is the mean distance of its colours from the nearest of those that are common
    around it: a grey knife is faint on grey, and on a pattern that has its grey. That, times the
    square root of its pixels.

    Args:
        pixels: Height × width × 3.
        mask: Which pixels show the thing.
    """
    grown = Image.fromarray(mask.astype(np.uint8) * 255).filter(ImageFilter.MaxFilter(AROUND))
    ring = (np.asarray(grown) > 0) & ~mask
    if not mask.any() or not ring.any():
        return math.inf
    thing = pixels[mask].astype(np.float64) / 255
    around = pixels[ring].astype(np.float64) / 255
    common = np.quantile(around, [0.1, 0.5, 0.9], axis=0)
    distances = np.sqrt(((thing[:, None] - common[None]) ** 2).mean(-1)).min(1)
    return float(distances.mean()) * math.sqrt(mask.sum())


def overlooked(scene: "KitchenScene", pixels: NDArray[np.uint8]) -> list[str]:
    """What is in view, dirt too, and a person would overlook in a picture of a scene."""
    side = scene.size
    if len(pixels) != side:
        pixels = np.asarray(Image.fromarray(pixels).resize((side, side), Image.Resampling.LANCZOS))
    wanted = {**dict.fromkeys(ITEMS, DISTINCT), "dirt": DIRTY}
    masks = {thing: scene.mask(thing) for thing in wanted}
    return [
        thing
        for thing, mask in masks.items()
        if mask.any() and distinctness(pixels, mask) < wanted[thing]
    ]
