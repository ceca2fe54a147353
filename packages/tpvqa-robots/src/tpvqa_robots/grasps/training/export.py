"""Write what was taught as ONNX: `python -m tpvqa_robots.grasps.training.export RUN`.

Needs torch and onnx. The package's own network is overwritten where no other file is named.
"""

import argparse
from pathlib import Path

import torch

from tpvqa_robots.grasps.above import SIDE
from tpvqa_robots.grasps.training.network import GgCnn

HERE = Path(__file__).parents[1] / "weights" / "ggcnn.onnx"
NAMES = ("quality", "cosine", "sine", "width")


def export(run: Path, file: Path = HERE) -> None:
    """Write a network as ONNX.

    Args:
        run: Where `train` left it.
        file: Where it goes.
    """
    net = GgCnn()
    net.load_state_dict(torch.load(run / "ggcnn.pt", weights_only=True))
    net.eval()
    torch.onnx.export(
        net,
        (torch.zeros(1, 1, SIDE, SIDE),),
        str(file),
        input_names=["depth"],
        output_names=list(NAMES),
        opset_version=17,
        dynamo=False,
    )


def main() -> None:
    """The command."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("run", type=Path)
    words.add_argument("file", type=Path, nargs="?", default=HERE)
    said = words.parse_args()
    export(said.run, said.file)


if __name__ == "__main__":
    main()
