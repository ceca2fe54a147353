"""How sure the network may be: one temperature, fitted on kitchens it was not trained on."""

import numpy as np
from numpy.typing import NDArray

from tpvqa_household.training.asking import Asking
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.labels import Label
from tpvqa_household.training.network import Network
from tpvqa_household.training.validate import logits

_MOST = 100


def temperature(network: Network, asking: Asking, pictures: Pictures) -> float:
    """The temperature under which held-out answers are likeliest, subjects weighing the same."""
    numbers = np.arange(0, len(pictures), max(1, len(pictures) // _MOST))
    out = logits(network, asking, pictures, numbers).astype(np.float64)
    labels = pictures.labels[numbers]
    answers = np.select(
        [labels == Label.YES, labels == Label.CANNOT_SEE, labels == Label.UNCLEAR], [0, 2, -1], 1
    )
    grid = np.exp(np.linspace(np.log(0.4), np.log(3.0), 60))
    return float(min(grid, key=lambda t: _loss(out / t, answers)))


def _loss(out: NDArray[np.float64], answers: NDArray[np.int64]) -> float:
    asked = answers >= 0
    log_p = out - np.logaddexp.reduce(out, axis=-1, keepdims=True)
    right = np.take_along_axis(log_p, np.maximum(answers, 0)[..., None], -1)[..., 0]
    return float(-right[asked].mean())
