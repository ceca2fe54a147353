"""How well a network in training does on pictures it is not trained on."""

import numpy as np
import torch
from numpy.typing import NDArray

from tpvqa_household.training.asking import Asking
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.labels import Label
from tpvqa_household.training.network import Network, normalise
from tpvqa_household.training.wordings import wordings

_MOST = 200
_BATCH = 4


def logits(
    network: Network, asking: Asking, pictures: Pictures, numbers: NDArray[np.int64]
) -> NDArray[np.float32]:
    """Answers to the canonical question of every subject, pictures × subjects × 3."""
    tokens = np.zeros((len(asking.subjects), asking.lexicon.longest), np.int64)
    for i, subject in enumerate(asking.subjects):
        found = asking.lexicon.tokens(next(iter(wordings(subject))).text)
        assert isinstance(found, tuple)
        tokens[i, : len(found)] = found
    rows = []
    with torch.no_grad(), torch.autocast("cpu", torch.bfloat16):
        for first in range(0, len(numbers), _BATCH):
            pixels = torch.from_numpy(pictures.pixels(numbers[first : first + _BATCH]))
            batch = normalise(pixels.permute(0, 3, 1, 2))
            asked = torch.from_numpy(tokens)[None].expand(len(batch), -1, -1)
            rows.append(network(batch, asked).float().numpy())
    return np.concatenate(rows)


def validate(network: Network, asking: Asking, pictures: Pictures) -> dict[str, object]:
    """Balanced accuracy on yes and no, by way of asking and predicate, and cannot-see figures."""
    every = max(1, len(pictures) // _MOST)
    numbers = np.arange(0, len(pictures), every)
    out = logits(network, asking, pictures, numbers)
    labels = pictures.labels[numbers]
    said_yes = out[..., 0] > out[..., 1]
    unseen = np.exp(out[..., 2] - np.logaddexp.reduce(out, axis=-1)) > 0.5
    yes, no = labels == Label.YES, (labels == Label.NO) | (labels == Label.HARD_NO)
    hard, cannot = labels == Label.HARD_NO, labels == Label.CANNOT_SEE

    def rate(hits: NDArray[np.bool_], among: NDArray[np.bool_]) -> float:
        return round(float(hits[among].mean()), 3) if among.any() else -1.0

    result: dict[str, object] = {
        "cannot see, rightly": rate(unseen, cannot),
        "cannot see, wrongly": rate(unseen, yes | no),
        "hard no": rate(~said_yes, hard),
    }
    forms: dict[str, list[int]] = {}
    for i, subject in enumerate(asking.subjects):
        name = subject.name if subject.form == "fact" else subject.form
        forms.setdefault(name, []).append(i)
    for name, columns in forms.items():
        mask = np.zeros(labels.shape[1], bool)
        mask[columns] = True
        result[name] = (rate(said_yes, yes & mask), rate(~said_yes, no & mask))
    return result
