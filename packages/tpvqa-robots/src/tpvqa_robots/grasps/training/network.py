"""GG-CNN's layers as published, in torch: 62 thousand weights."""

import torch
from torch import Tensor, nn
from torch.nn import functional

FILTERS = (32, 16, 8, 8, 16, 32)
KERNELS = (9, 5, 3, 3, 5, 9)
STRIDES = (3, 2, 2, 2, 2, 3)
PADS = (3, 2, 1, 1, 2, 3)


class GgCnn(nn.Module):
    """One depth image → quality, cosine and sine of twice the angle, width.

    Its sides are multiples of 12 pixels, the same for image and maps.
    """

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        before = 1
        for number, (filters, kernel, stride, pad) in enumerate(
            zip(FILTERS, KERNELS, STRIDES, PADS, strict=True)
        ):
            shrinks = number < len(FILTERS) // 2
            layers.append(
                nn.Conv2d(before, filters, kernel, stride, pad)
                if shrinks
                else nn.ConvTranspose2d(before, filters, kernel, stride, pad, output_padding=1)
            )
            layers.append(nn.ReLU())
            before = filters
        self.trunk = nn.Sequential(*layers)
        self.heads = nn.ModuleList(nn.Conv2d(before, 1, 2) for _ in range(4))
        for part in self.modules():
            if isinstance(part, nn.Conv2d | nn.ConvTranspose2d):
                nn.init.xavier_uniform_(part.weight)

    def forward(self, depth: Tensor) -> tuple[Tensor, ...]:
        """Batch × 1 × height × width → four of the same shape."""
        seen = self.trunk(depth)
        return tuple(head(seen) for head in self.heads)


def loss_of(said: tuple[Tensor, ...], wanted: Tensor) -> Tensor:
    """Squared errors of the four maps, as published, summed over the maps."""
    parts = [functional.mse_loss(map_[:, 0], wanted[:, i]) for i, map_ in enumerate(said)]
    return torch.stack(parts).sum()
