"""What is learnt from, and what is held back: by picture, so that none is in both parts."""

import math
from collections.abc import Sequence

from tpvqa.chance import chance
from tpvqa.errors import TrainingError
from tpvqa.training.example import Example


def split(
    examples: Sequence[Example], share: float, *, seed: int
) -> tuple[list[Example], list[Example]]:
    """Hold a share of the pictures back, with all that is asked about them.

    Args:
        examples: All.
        share: Of the pictures; at least one is held back, and one learnt from.
        seed: Decides which.

    Returns:
        What to learn from, and what is held back.

    Raises:
        TrainingError: There are fewer than two pictures.
    """
    pictures = sorted({each.picture for each in examples})
    if len(pictures) < 2:
        raise TrainingError(
            f"{len(pictures)} labelled pictures are too few: some are learnt from, and others are "
            "held back to see what was learnt. Label more of them"
        )
    chance(seed, 0, "held back of training").shuffle(pictures)
    back = set(pictures[: min(max(1, math.ceil(share * len(pictures))), len(pictures) - 1)])
    return (
        [each for each in examples if each.picture not in back],
        [each for each in examples if each.picture in back],
    )
