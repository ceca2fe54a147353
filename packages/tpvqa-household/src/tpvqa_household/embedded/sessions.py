"""The two halves of the network in onnxruntime: picture → map, map and questions → logits."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa_household.embedded.weights import HEAD, IMAGE, Weights

Floats = NDArray[np.float32]


class Sessions:
    """Runs a network on the CPU. Safe to use from several threads.

    Args:
        weights: The network.
        threads: How many cores one run may use.
    """

    def __init__(self, weights: Weights, *, threads: int):
        import onnxruntime

        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads
        options.inter_op_num_threads = 1
        options.log_severity_level = 3
        options.add_session_config_entry("session.intra_op.allow_spinning", "0")

        def load(name: str) -> Any:
            return onnxruntime.InferenceSession(
                str(weights.folder / name), options, providers=["CPUExecutionProvider"]
            )

        self._image, self._head = load(IMAGE), load(HEAD)
        self._side = weights.side

    def encode(self, pixels: NDArray[np.uint8]) -> Floats:
        """A picture of any size, height × width × 3, to its map of features.

        The whole picture is squeezed into a square: nothing at its edges is lost.
        """
        if pixels.shape[:2] != (self._side, self._side):
            size = (self._side, self._side)
            resized = Image.fromarray(pixels).resize(size, Image.Resampling.BICUBIC, reducing_gap=3)
            pixels = np.asarray(resized)
        maps: Floats = self._image.run(None, {"pixels": pixels[None]})[0]
        return maps

    def answer(self, maps: Floats, tokens: NDArray[np.int64]) -> Floats:
        """Logits (yes, no, cannot see) of questions, n × words, about an encoded picture."""
        logits: Floats = self._head.run(None, {"maps": maps, "tokens": tokens})[0]
        return logits
