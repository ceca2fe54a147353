"""Stored inputs and outputs, by which the shipped graphs are checked without torch."""

import json
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray
from PIL import Image
from torch import Tensor

from tpvqa_household.embedded.sessions import Sessions
from tpvqa_household.embedded.weights import Weights
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.network import Network, normalise
from tpvqa_household.training.wordings import wordings

_PICTURES = 4


def write_reference(
    network: Network, asking: Asking, pictures: Pictures, weights: Path, folder: Path | None
) -> float:
    """Compare the exported graphs with torch, and store what torch says.

    Args:
        network: The network as exported.
        asking: What can be asked.
        pictures: Some are taken from here.
        weights: The exported folder.
        folder: Where pictures (PNG) and torch's probabilities go; None to store nothing.

    Returns:
        The largest difference between probabilities.
    """
    found = Weights.read(weights)
    sessions = Sessions(found, threads=1)
    texts = [next(iter(wordings(subject))).text for subject in asking.subjects]
    rows = np.zeros((len(texts), asking.lexicon.longest), np.int64)
    for i, text in enumerate(texts):
        tokens = found.lexicon.tokens(text)
        assert isinstance(tokens, tuple), text
        rows[i, : len(tokens)] = tokens
    worst = 0.0
    cases: list[dict[str, object]] = []
    for number in np.linspace(0, len(pictures) - 1, _PICTURES).astype(int):
        pixels = pictures.pixels(np.array([number]))[0]
        expected = _chances(logits(network, pixels, rows), found.temperature)
        ours = torch.from_numpy(sessions.answer(sessions.encode(pixels), rows))
        worst = max(worst, float((_chances(ours, found.temperature) - expected).abs().max()))
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            name = f"{len(cases)}.png"
            Image.fromarray(pixels).save(folder / name, optimize=True)
            chances = [[round(float(x), 6) for x in row] for row in expected]
            cases.append({"picture": name, "chances": chances})
    if folder is not None:
        data = {"questions": texts, "cases": cases}
        (folder / "reference.json").write_text(json.dumps(data) + "\n", encoding="utf-8")
    return worst


def logits(network: Network, pixels: NDArray[np.uint8], tokens: NDArray[np.int64]) -> Tensor:
    """What torch answers to questions about one picture, without reduced precision."""
    with torch.no_grad():
        picture = normalise(torch.from_numpy(np.array(pixels))[None].permute(0, 3, 1, 2))
        out: Tensor = network(picture, torch.from_numpy(tokens)[None])[0]
    return out


def _chances(out: torch.Tensor, temperature: float) -> torch.Tensor:
    return (out.double() / temperature).softmax(-1)
