"""Grasps that a network finds: GG-CNN in its published form.

Morrison, Corke and Leitner 2018, Closing the Loop for Robotic Grasping: A Real-time, Generative
Grasp Synthesis Approach. A fully convolutional network gives for each pixel of a depth image how
good a grasp there is, its angle as sine and cosine of twice it, and its width. The weights are this
project's own; docs/grasp-card.md says what taught them.
"""

import os
from functools import cache
from importlib import resources
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tpvqa.errors import MissingExtraError
from tpvqa_robots import DISTRIBUTION
from tpvqa_robots.grasps.above import (
    PIXEL,
    SIDE,
    depth_image,
    from_above,
    mask_from_above,
    top_of,
)
from tpvqa_robots.grasps.grasp import DEEP, LOWEST, Grasp

OPENING = 0.085
"""Of the hand: widths are learnt as shares of it, metres."""
SMOOTH = 2.0
"""Standard deviation of the blur over the maps, as published, pixels."""
EVERY = 3
"""Of so many pixels along a side one is a place to grasp."""


class Maps(NamedTuple):
    """What the network says of each pixel, blurred.

    Attributes:
        quality: From 0 to 1, `SIDE` × `SIDE`.
        angle: Of the direction in which the fingers close, radians from the map's rows.
        width: Metres.
    """

    quality: NDArray[np.float64]
    angle: NDArray[np.float64]
    width: NDArray[np.float64]


def ggcnn(
    points: NDArray[np.float64],
    thing: NDArray[np.bool_],
    *,
    centre: tuple[float, float],
    table: float,
) -> list[Grasp]:
    """Grasps of a thing, the best first.

    Args:
        points: What the camera saw, n × 3, metres from the arm's foot.
        thing: Which of them are of the thing.
        centre: The thing's middle, x and y.
        table: Height of the table's top above the floor, metres.

    Raises:
        MissingExtraError: onnxruntime is not installed.
    """
    heights = from_above(points, centre, table)
    maps = maps_of(heights)
    own = mask_from_above(points[thing], centre)
    grid = np.zeros_like(own)
    grid[EVERY // 2 :: EVERY, EVERY // 2 :: EVERY] = True
    rows, columns = np.nonzero(own & grid)
    order = np.argsort(-maps.quality[rows, columns], kind="stable")
    found = []
    for row, column in zip(rows[order], columns[order], strict=True):
        x, y = (np.array([row, column]) + 0.5 - SIDE / 2) * PIXEL + np.array(centre)
        found.append(
            Grasp(
                float(x),
                float(y),
                table + max(LOWEST, top_of(heights, int(row), int(column)) - DEEP),
                float(maps.angle[row, column]),
                float(maps.width[row, column]),
                float(np.clip(maps.quality[row, column], 0, 1)),
            )
        )
    return found


def maps_of(heights: NDArray[np.float64]) -> Maps:
    """What the network says of a map of heights.

    Args:
        heights: Of `above.from_above`, metres above the table.

    Raises:
        MissingExtraError: onnxruntime is not installed.
    """
    said = _session().run(None, {"depth": depth_image(heights)})
    quality, cosine, sine, width = (blurred(part[0, 0].astype(np.float64)) for part in said)
    return Maps(quality, np.arctan2(sine, cosine) / 2, np.clip(width, 0, 1) * OPENING)


def blurred(image: NDArray[np.float64], spread: float = SMOOTH) -> NDArray[np.float64]:
    """An image under a Gaussian of some standard deviation, pixels."""
    half = int(3 * spread)
    kernel = np.exp(-0.5 * (np.arange(-half, half + 1) / spread) ** 2)
    kernel /= kernel.sum()
    for axis in (0, 1):
        wide = np.pad(image, [(half, half) if a == axis else (0, 0) for a in (0, 1)], mode="edge")
        n = image.shape[axis]
        parts = (np.take(wide, range(i, i + n), axis) * k for i, k in enumerate(kernel))
        image = np.sum(list(parts), axis=0)
    return image


@cache
def _session() -> Any:
    if find_spec("onnxruntime") is None:
        raise MissingExtraError(
            "onnxruntime", "grasps", "The network of grasps", distribution=DISTRIBUTION
        )
    # Read as it is imported: else it keeps a number of the device, and reports to its maker.
    os.environ.setdefault("ORT_DISABLE_TELEMETRY", "1")
    import onnxruntime

    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = 1
    data = (resources.files("tpvqa_robots.grasps") / "weights" / "ggcnn.onnx").read_bytes()
    return onnxruntime.InferenceSession(data, options, providers=["CPUExecutionProvider"])
