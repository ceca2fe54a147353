"""The network in onnxruntime: picture → map, map and questions → logits; the frozen branch."""

import os
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from tpvqa_household.embedded.likeness import Floats
from tpvqa_household.embedded.limits import Seen
from tpvqa_household.embedded.weights import FROZEN, HEAD, IMAGE, Weights


class Sessions:
    """Runs a network on the CPU. Safe to use from several threads.

    Args:
        weights: The network.
        threads: How many cores one run may use.
    """

    def __init__(self, weights: Weights, *, threads: int):
        # Read as it is imported: else it keeps a number of the device, and reports to its maker.
        os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
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

        self._load = load
        self._image, self._head = load(IMAGE), load(HEAD)
        self._side = weights.side

    @cached_property
    def _frozen(self) -> Any:
        """Loaded with the first picture that is not known."""
        return self._load(FROZEN)

    def encode(self, pixels: NDArray[np.uint8]) -> Floats:
        """A picture of any size, height × width × 3, to its map of features.

        The whole picture is squeezed into a square: nothing at its edges is lost.
        """
        maps: Floats = self._image.run(None, {"pixels": self._square(pixels)[None]})[0]
        return maps

    def see(self, pixels: NDArray[np.uint8]) -> Seen:
        """What the frozen branch makes of a picture of any size, squeezed in the same way."""
        features, classes, texture = self._frozen.run(None, {"pixels": self._square(pixels)[None]})
        return Seen(features[0], classes[0], texture[0])

    def _square(self, pixels: NDArray[np.uint8]) -> NDArray[np.uint8]:
        size = (self._side, self._side)
        if pixels.shape[:2] == size:
            return pixels
        resized = Image.fromarray(pixels).resize(size, Image.Resampling.BICUBIC, reducing_gap=3)
        return np.asarray(resized)

    def answer(self, maps: Floats, tokens: NDArray[np.int64]) -> Floats:
        """Logits (yes, no, cannot see) of questions, n × words, about an encoded picture."""
        logits: Floats = self._head.run(None, {"maps": maps, "tokens": tokens})[0]
        return logits
