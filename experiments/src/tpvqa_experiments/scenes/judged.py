"""One scene, judged: whether the state that is put first is the true one, and how sure that was."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tpvqa.vlm.metrics import calibration_error
from tpvqa_experiments.scenes.recorded import Scene
from tpvqa_experiments.scenes.ridge import Array

HELD = 0.95
"""How much of the belief a set of states holds."""


@dataclass(frozen=True, slots=True)
class Reading:
    """What is believed of a scene, beside its truth.

    Attributes:
        right: Whether the state that is put first is the true one.
        sure: The probability of that state.
        states: How many states hold `HELD` of the belief together, the most probable first.
        within: Whether the true one is among them.
    """

    right: bool
    sure: float
    states: int
    within: bool

    @classmethod
    def of(cls, log_belief: Array, truth: int) -> "Reading":
        """Judge a belief by the true state."""
        belief = np.exp(log_belief)
        order = np.argsort(-belief, kind="stable")
        # The last one makes it whole where rounding leaves less than all.
        states = min(int(np.searchsorted(np.cumsum(belief[order]), HELD)) + 1, len(order))
        return cls(
            bool(order[0] == truth),
            float(belief[order[0]]),
            states,
            bool(np.any(order[:states] == truth)),
        )


@dataclass(frozen=True, slots=True)
class Judged:
    """One scene as it was answered, as the naive rival reads it, and as the belief does."""

    scene: Scene
    naive: Reading
    belief: Reading


def reliability(readings: Sequence[Reading]) -> float:
    """Expected calibration error of the probability of the state that is put first."""
    sure, right = arrays(readings)
    return calibration_error(sure, right) or 0.0


def arrays(readings: Sequence[Reading]) -> tuple[Array, NDArray[np.bool_]]:
    """How sure each was, and whether it was right."""
    return (
        np.array([each.sure for each in readings], float),
        np.array([each.right for each in readings], bool),
    )
