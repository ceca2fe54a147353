"""What is learnt from, and what is held back: by picture and group, so that none is in both."""

import math
from collections.abc import Sequence

from tpvqa.chance import chance
from tpvqa.errors import TrainingError
from tpvqa.training.example import Example, together


def split(
    examples: Sequence[Example], share: float, *, seed: int
) -> tuple[list[Example], list[Example]]:
    """Hold a share of the pictures back, with all that is asked about them.

    Pictures of one group stay together.

    Args:
        examples: All.
        share: Of the groups, and pictures by themselves; at least one is held back, and one learnt
            from.
        seed: Decides which.

    Returns:
        What to learn from, and what is held back.

    Raises:
        TrainingError: There are fewer than two pictures, or groups of them.
    """
    of = together(examples)
    groups = sorted(set(of.values()))
    if len(groups) < 2:
        alike = " of one group" if len(of) > 1 else ""
        raise TrainingError(
            f"{len(of)} labelled pictures{alike} are too few: some are learnt from, and others are "
            "held back to see what was learnt. Label more of them"
        )
    chance(seed, 0, "held back of training").shuffle(groups)
    back = set(groups[: min(max(1, math.ceil(share * len(groups))), len(groups) - 1)])
    return (
        [each for each in examples if of[each.picture] not in back],
        [each for each in examples if of[each.picture] in back],
    )
