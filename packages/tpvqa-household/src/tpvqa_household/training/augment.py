"""Pictures made worse and other, so that the network meets more cameras than the renderer's.

What matters most for better rendered pictures: noise, compression, blur, brightness and colour.
"""

from collections.abc import Callable
from io import BytesIO

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812
from numpy.typing import NDArray
from PIL import Image
from torch import Tensor

from tpvqa_household.training.network import normalise

_NOISE = torch.from_numpy(np.random.default_rng(0).standard_normal((3, 512, 512), dtype=np.float32))
"""Noise to cut from: drawing it anew takes longer than all else here."""


def compressed(pixels: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """A picture after JPEG compression."""
    buffer = BytesIO()
    Image.fromarray(pixels).save(buffer, "JPEG", quality=quality)
    with Image.open(buffer) as picture:
        return np.asarray(picture)


def _curves(rng: np.random.Generator) -> NDArray[np.float32]:
    """Brightness curves of the three channels: gamma, exposure, white balance, film-like bend."""
    x = np.linspace(0, 1, 256)
    x = x ** rng.uniform(0.65, 1.45)
    bend = rng.uniform(-0.4, 0.6)
    x = x + bend * (x * x * (3 - 2 * x) - x)
    gains = rng.uniform(0.75, 1.4) * rng.uniform(0.86, 1.14, 3)
    return (x[None] * gains[:, None] + rng.uniform(-0.04, 0.08)).astype(np.float32)


def augmented(pixels: NDArray[np.uint8], rng: np.random.Generator) -> Tensor:
    """Random variations of pictures, normalised for the network.

    Args:
        pixels: B × H × W × 3.
        rng: All chance comes from here.

    Returns:
        B × 3 × H × W.
    """
    batch, height, width = pixels.shape[:3]
    toned = np.empty((batch, 3, height, width), np.float32)
    for i, picture in enumerate(pixels):
        if rng.random() < 0.3:
            picture = compressed(np.ascontiguousarray(picture), int(rng.integers(25, 96)))
        curves = _curves(rng) if rng.random() < 0.85 else None
        for c in range(3):
            channel = picture[..., c]
            toned[i, c] = channel / np.float32(255) if curves is None else curves[c][channel]
    x = torch.from_numpy(toned).contiguous(memory_format=torch.channels_last)

    def draw(low: float, high: float, *shape: int) -> Tensor:
        return torch.from_numpy(rng.uniform(low, high, shape).astype(np.float32))

    x = _placed(x, draw)
    contrast, saturation = draw(0.7, 1.3, batch, 1, 1, 1), draw(0.4, 1.4, batch, 1, 1, 1)
    grey = x.mean(1, keepdim=True)
    x = grey + (x - grey) * saturation
    mean = x.mean((1, 2, 3), keepdim=True)
    x = mean + (x - mean) * contrast
    # Soft light and shade across the picture.
    shade = F.interpolate(draw(-0.3, 0.3, batch, 1, 4, 4), (height, width), mode="bilinear")
    x = x * (1 + shade * (draw(0, 1, batch, 1, 1, 1) < 0.5))
    for i in np.flatnonzero(rng.random(batch) < 0.3).tolist():
        x[i : i + 1] = _blurred(x[i : i + 1], rng)
    strength = draw(0, 0.05, batch, 1, 1, 1) * (draw(0, 1, batch, 1, 1, 1) < 0.6)
    for i in np.flatnonzero(strength.numpy().ravel()).tolist():
        top, left = rng.integers(0, len(_NOISE[0]) - np.array([height, width])).tolist()
        x[i] += _NOISE[:, top : top + height, left : left + width] * strength[i]
    x = normalise(x.clamp_(0, 1).mul_(255))
    return x.contiguous(memory_format=torch.channels_last)


def _placed(x: Tensor, draw: Callable[..., Tensor]) -> Tensor:
    """Shifted, scaled, squeezed and mirrored a little: no question names left or right."""
    batch = len(x)
    scale, squeeze = draw(0.9, 1.05, batch), draw(-0.06, 0.06, batch)
    mirrored = (draw(0, 1, batch) < 0.5).float() * 2 - 1
    turn = draw(-0.05, 0.05, batch)
    grid = torch.zeros(batch, 2, 3)
    grid[:, 0, 0], grid[:, 0, 1] = scale * (1 + squeeze) * mirrored, -turn
    grid[:, 1, 0], grid[:, 1, 1] = turn * mirrored, scale * (1 - squeeze)
    grid[:, :, 2] = draw(-0.05, 0.05, batch, 2)
    return F.grid_sample(
        x,
        F.affine_grid(grid, list(x.shape), align_corners=False),
        padding_mode="reflection",
        align_corners=False,
    )


def _blurred(x: Tensor, rng: np.random.Generator) -> Tensor:
    """Out of focus, or from a camera with fewer pixels."""
    if rng.random() < 0.5:
        return F.avg_pool2d(F.pad(x, (1, 1, 1, 1), mode="replicate"), 3, 1)
    side = x.shape[-1]
    small = F.interpolate(x, size=int(rng.integers(side * 2 // 5, side)), mode="area")
    return F.interpolate(small, size=side, mode="bilinear", align_corners=False)
