"""What taught questions are answered from: the frozen branch, on a picture and on nine parts of it.

Small things fill more of a part than of the whole, and which part shows a thing tells where it is.
"""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.limits import Seen

ACROSS = 3
"""Parts in a row and in a column; each is half as wide and high as the picture."""
WIDE = 1280
"""Features of the branch."""
TEXTURE = 112
SIZE = WIDE * (1 + ACROSS**2)
"""Features of a picture with its parts."""
KIND = WIDE + TEXTURE
"""What tells kinds of pictures apart."""


class Sees(Protocol):
    """Runs the frozen branch (`Sessions`)."""

    def see(self, pixels: NDArray[np.uint8]) -> Seen:
        """What it makes of a picture of any size."""


def glimpsed(branch: Sees, pixels: NDArray[np.uint8]) -> tuple[Floats, Floats]:
    """What the branch makes of a picture, height × width × 3.

    Returns:
        `SIZE` features, the whole picture's first and then those of its parts, row by row; and the
        `KIND` features of the whole that tell kinds of pictures apart.
    """
    whole = branch.see(pixels)
    parts = [branch.see(part).features for part in _parts(pixels)]
    features = np.concatenate([whole.features, *parts]).astype(np.float32)
    return features, np.concatenate([whole.features, whole.texture]).astype(np.float32)


def _parts(pixels: NDArray[np.uint8]) -> list[NDArray[np.uint8]]:
    height, width = pixels.shape[:2]
    tall, broad = max(1, height // 2), max(1, width // 2)
    tops = np.linspace(0, height - tall, ACROSS).astype(int).tolist()
    lefts = np.linspace(0, width - broad, ACROSS).astype(int).tolist()
    return [
        np.ascontiguousarray(pixels[top : top + tall, left : left + broad])
        for top in tops
        for left in lefts
    ]
