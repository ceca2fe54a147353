"""Export a trained network for onnxruntime: `python -m tpvqa_household.training.export --help`.

Weights are stored as 16-bit floats. They are rounded before the export, so that what runs is what
torch computes with the rounded weights; the export checks that on real pictures.
"""

import argparse
import hashlib
import json
import sys
from collections.abc import Sequence
from pathlib import Path

import torch
from torch import Tensor, nn

from tpvqa.errors import TpvqaError
from tpvqa_household.embedded.weights import DESCRIPTION, HEAD, IMAGE, SHIPPED
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.calibrate import temperature
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.graphs import written
from tpvqa_household.training.memory import keep_memory
from tpvqa_household.training.network import SIDE, ImageEncoder, Network, QuestionHead, normalise
from tpvqa_household.training.reference import write_reference

_TOLERANCE = 1e-3


class _Image(nn.Module):
    """The image encoder from raw pixels, as a camera gives them."""

    def __init__(self, encoder: ImageEncoder):
        super().__init__()
        self.encoder = encoder

    def forward(self, pixels: Tensor) -> Tensor:
        out: Tensor = self.encoder(normalise(pixels.permute(0, 3, 1, 2)))
        return out


def rounded(network: Network) -> Network:
    """The same network with weights that 16-bit floats can hold."""
    with torch.no_grad():
        for parameter in network.parameters():
            parameter.copy_(parameter.half().float())
    return network.eval()


def export(network: Network, folder: Path, *, longest: int) -> None:
    """Write the two graphs of a `rounded` network.

    Args:
        network: What to export.
        folder: Where to.
        longest: Words of a question, padding included.
    """
    folder.mkdir(parents=True, exist_ok=True)
    pixels = torch.zeros(1, SIDE, SIDE, 3, dtype=torch.uint8)
    tokens = torch.ones(2, longest, dtype=torch.long)
    image = _Image(network.image).eval()
    with torch.no_grad():
        maps = image(pixels)
    written(image, (pixels,), folder / IMAGE, ["pixels"], ["maps"], {})
    head: QuestionHead = network.head
    several = {"tokens": {0: "questions"}, "logits": {0: "questions"}}
    written(head, (maps, tokens), folder / HEAD, ["maps", "tokens"], ["logits"], several)


def describe(
    folder: Path, asking: Asking, *, temperature: float, trained: dict[str, object]
) -> None:
    """Write what the runtime must know beside the graphs."""
    data = {
        "side": SIDE,
        "temperature": round(temperature, 4),
        "sha256": {
            name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in (IMAGE, HEAD)
        },
        "trained": trained,
        "lexicon": asking.lexicon.to_json(),
    }
    text = json.dumps(data, indent=1) + "\n"
    (folder / DESCRIPTION).write_text(text, encoding="utf-8")


def load(checkpoint: Path, asking: Asking) -> tuple[Network, dict[str, object]]:
    """The averaged network of a checkpoint, and how it was trained.

    Raises:
        TpvqaError: It cannot be read, or knows other words.
    """
    try:
        data = torch.load(checkpoint, map_location="cpu")
    except OSError as error:
        raise TpvqaError(f"{checkpoint} cannot be read: {error.strerror}.") from None
    recipe, words = data["recipe"], len(asking.lexicon.vocabulary)
    network = Network(words, width=recipe["width"], frozen=recipe["frozen_blocks"])
    try:
        network.load_state_dict(data["average"])
    except RuntimeError:
        raise TpvqaError(f"{checkpoint} was trained on other questions; train it again.") from None
    return network, {"recipe": recipe, "progress": data["progress"]}


def main(arguments: Sequence[str] | None = None) -> int:
    """Export, calibrate and check."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.export",
        description=(__doc__ or "").splitlines()[0],
    )
    parser.add_argument("checkpoint", type=Path, help="that `train` wrote")
    parser.add_argument("pictures", type=Path, help="the folder that `render` filled")
    parser.add_argument("--out", type=Path, default=SHIPPED)
    parser.add_argument("--reference", type=Path, default=None, help="where test cases go")
    chosen = parser.parse_args(arguments)
    keep_memory()
    try:
        data = torch.load(chosen.checkpoint, map_location="cpu")["recipe"]
        asking = Asking.about(data["task"])
        network, trained = load(chosen.checkpoint, asking)
        rounded(network)
        above = range(data["validation_from"], 1_000_000)
        held_out = Pictures(chosen.pictures, "train", asking.subjects, asking.actions, seeds=above)
        if not held_out.refresh():
            raise TpvqaError(f"{chosen.pictures} has no kitchens to calibrate on: render some.")
        export(network, chosen.out, longest=asking.lexicon.longest)
        found = temperature(network, asking, held_out)
        describe(chosen.out, asking, temperature=found, trained=trained)
        worst = write_reference(network, asking, held_out, chosen.out, chosen.reference)
        print(f"temperature {found:.3f}, largest difference to torch {worst:.1e}")
        if worst > _TOLERANCE:
            raise TpvqaError(f"onnxruntime differs from torch by {worst:.1e} > {_TOLERANCE}.")
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
