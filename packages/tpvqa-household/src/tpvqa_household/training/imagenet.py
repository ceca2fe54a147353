"""What ImageNet taught the backbone, kept as it is: the branch that real photographs go through.

Fine-tuning on rendered kitchens lost what the backbone knew of real things. Here nothing is
trained: EfficientNet-lite0 with its head and its 1,000 classes, from raw pixels to three vectors.
"""

from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812
from numpy.typing import NDArray
from torch import Tensor, nn

from tpvqa_household.training.backbone import CHANNELS, imagenet_weights, pretrained
from tpvqa_household.training.network import SIDE, normalise

CLASSES: dict[str, tuple[int, ...]] = {
    "fridge": (760,),  # refrigerator
    "sink": (534, 804, 896),  # dishwasher, soap dispenser, washbasin
    "tv": (548, 598, 664, 782, 851),  # entertainment center, theater, monitor, screen, television
    "table": (526, 532, 736),  # desk, dining table, pool table
    "knife": (499, 623),  # cleaver, letter opener
    "apple": (948,),  # Granny Smith
    "bread": (415, 930, 931),  # bakery, French loaf, bagel
    "plate": (659, 809, 923),  # mixing bowl, soup bowl, plate
}
"""Classes of ImageNet that speak for a thing, by their numbers."""
WIDE = 1280
"""Channels of the backbone's head."""


@dataclass(frozen=True)
class Seen:
    """What the branch makes of pictures.

    Attributes:
        features: n × 1280, the square roots of the head's mean channels.
        classes: n × 2 for each of `CLASSES`, in order: log probability of its classes in the whole
            picture, and in the place of 7 × 7 that speaks most for them.
        texture: n × 112, mean channels at 1/16 of the picture's side.
    """

    features: NDArray[np.float32]
    classes: NDArray[np.float32]
    texture: NDArray[np.float32]


class ImageNetBranch(nn.Module):
    """Raw pixels, 1 × 224 × 224 × 3, to the vectors of `Seen`; nothing of it is trained.

    Raises:
        MissingExtraError: The packages with the weights are not installed.
    """

    def __init__(self) -> None:
        super().__init__()
        self.backbone = pretrained(frozen=16)
        weights = imagenet_weights()
        self.head = nn.Conv2d(CHANNELS[-1], WIDE, 1)
        scale = weights["_bn1.weight"] / torch.sqrt(weights["_bn1.running_var"] + 1e-3)
        self.head.weight.data = weights["_conv_head.weight"] * scale[:, None, None, None]
        self.head.bias = nn.Parameter(
            weights["_bn1.bias"] - weights["_bn1.running_mean"] * scale, requires_grad=False
        )
        self.classify = nn.Linear(WIDE, 1000)
        self.classify.weight.data = weights["_fc.weight"]
        self.classify.bias.data = weights["_fc.bias"]
        for parameter in self.parameters():
            parameter.requires_grad_(False)
        self.eval()

    def forward(self, pixels: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Features, classes and texture of pictures of bytes, n × 224 × 224 × 3."""
        maps = self.backbone(normalise(pixels.permute(0, 3, 1, 2)))
        places = F.relu6(self.head(maps[-1])).flatten(2).transpose(1, 2)
        mean = places.mean(1)
        # In one product: as two, the graph would hold the classes' weights twice.
        classes = F.log_softmax(self.classify(torch.cat([mean[:, None], places], 1)), -1)
        whole, locally = classes[:, 0], classes[:, 1:].amax(1)
        pairs = [
            torch.logsumexp(of[:, list(numbers)], -1)
            for numbers in CLASSES.values()
            for of in (whole, locally)
        ]
        return mean.sqrt(), torch.stack(pairs, -1), maps[2].mean((2, 3))

    def rounded(self) -> "ImageNetBranch":
        """Itself, with weights that 16-bit floats can hold."""
        for parameter in self.parameters():
            parameter.copy_(parameter.half().float())
        return self

    def see(self, pixels: NDArray[np.uint8], *, batch: int = 16) -> Seen:
        """The vectors of pictures, n × 224 × 224 × 3."""
        assert pixels.shape[1:] == (SIDE, SIDE, 3), pixels.shape
        batches = [pixels[first : first + batch] for first in range(0, len(pixels), batch)]
        with torch.no_grad():
            parts = [self(torch.from_numpy(np.array(each))) for each in batches]
        vectors = [torch.cat(each).numpy() for each in zip(*parts, strict=True)]
        return Seen(*vectors)
